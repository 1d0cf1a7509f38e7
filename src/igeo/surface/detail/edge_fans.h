/// Nodes of a level set's band that join the faces of a sharp edge. Internal.
#pragma once

#include <igeo/surface/detail/edge_normals.h>

namespace igeo {

/// Around sharp bends the core has nodes up to here from S. So a fan brings only such neighbors
/// with it. Voxels.
constexpr float kBesideFan = 1;

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
