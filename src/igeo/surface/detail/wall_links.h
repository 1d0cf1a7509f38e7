/// Links of a level set's band that run through a wall or across a slot. Internal.
#pragma once

#include <igeo/band/band.h>
#include <igeo/surface/level_set.h>

#include <vector>

namespace igeo {

/// Links whose chord, from foot point to foot point, runs through solid or air where the two
/// tangent planes say that S is near.
///
/// Between two points of one crease S lies above the chord (as normals go) or below it, no further
/// than the nearer of the two tangent planes. So from points along the chord the line to S along
/// the mean normal is followed so far: in a wall psi is still of the chord's sign there.
/// @param kinks  nodes at which psi has a kink, by leaf: other links are not looked at
/// Time O(links beside kinks), in parallel.
std::vector<Link> linksThroughWalls(const Band& band, const LevelSet& levelSet,
                                    const std::vector<std::vector<NodeIndex>>& kinks);

}  // namespace igeo
