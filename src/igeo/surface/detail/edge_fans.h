/// Nodes of a level set's band that join the faces of a sharp edge. Internal.
#pragma once

#include <igeo/band/band.h>

#include <optional>
#include <vector>

namespace igeo {

/// The edge in which the foot point of a node lies: unit normals there and of its two faces.
struct FanEdge {
    Vec3f normal, a, b;
};

/// A node that may be of a fan.
struct FanNode {
    NodeIndex node;
    float slope;                    ///< length of the central difference of psi
    std::optional<FanEdge> edge{};  ///< as turnToEdges finds it
};

/// Fans lie this far from S, in voxels. Nearer nodes are of the core, as Band::numberCore has it,
/// or nearly so.
constexpr double kFanBegin = 0.55, kFanEnd = 1.6;
/// A central difference whose length is as far off 1 is not that of a plane or a round edge.
constexpr float kUneven = 0.08f;
/// Around sharp bends the core has nodes up to here from S. So a fan brings only such neighbors
/// with it. Voxels.
constexpr float kBesideFan = 1;

/// Turns the normals of candidates whose nearest point of S is on an edge.
///
/// Beside a second edge as near as two voxels, differences of psi mix both. But the faces that meet
/// in an edge show it: where their planes, at two neighbors whose normals oppose, meet in a line as
/// far from the node as S, and the node is in the fan between their normals, the normal comes from
/// there. The candidate keeps the edge.
/// @param candidates  per leaf
/// @return links of turned nodes from which psi leaves S: they would lead from edge to edge through
///         a wall
/// Time O(candidates), in parallel.
std::vector<Link> turnToEdges(Band& band, std::vector<std::vector<FanNode>>& candidates);

/// Adds nodes to the core of a level set's band, so that fronts pass over edges sharper than a
/// right angle.
///
/// The normals of both faces oppose there, and no front passes from one to the other. On the round
/// side of the edge normals fan out between them; but as the lattice lies, no node of the core may
/// have one of these. A candidate is added, with its neighbors, if it is linked to two of them
/// whose normals a and b oppose, all three have their foot points on psi = 0, and psi stays near 0
/// between these. Half-way between two faces, in a wall or a slot that narrows to its edge, a node
/// has such neighbors too. There |grad psi| is sqrt((1 + a . b) / 2), and in a fan about 1.
/// Where the edge is known (turnToEdges), neighbors on both of its faces are enough.
/// @param candidates  of one leaf, say
/// @param core  nodes that the core takes in (Band::numberCore); one may be there more than once
/// Time O(candidates).
void addFans(const Band& band, const std::vector<FanNode>& candidates,
             std::vector<NodeIndex>& core);

}  // namespace igeo
