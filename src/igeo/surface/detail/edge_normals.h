/// Normals of a level set's band beside sharp edges. Internal.
#pragma once

#include <igeo/band/band.h>

#include <cmath>
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

/// Whether S passes within a third of a voxel of a point.
inline bool isNearSurface(const Band& band, const Vec3d& p) {
    constexpr double kOff = 0.35;
    return std::abs(psiAt(band, p)) < kOff;
}

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

}  // namespace igeo
