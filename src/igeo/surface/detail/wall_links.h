/// Links of a level set's band that pass through a wall or across a slot. Internal.
#pragma once

#include <igeo/band/band.h>
#include <igeo/surface/level_set.h>

#include <vector>

namespace igeo {

/// Links between foot points that psi along their chord separates.
///
/// Two foot points of one crease have tangent planes that meet, and S lies between the chord and
/// the nearer plane: a line from the chord along the mean normal meets S no later than that plane.
/// In a wall, psi on this line is still negative there, and across a slot still positive, whatever
/// the normals of the two foot points.
///
/// Beside hollow edges a normal may lie between those of both faces. Over a crease, the plane of
/// such a normal may hold a chord that cuts the corner before them. There S runs along a chord in
/// the plane of one end, or the link is severed.
/// @param meetings  per leaf the nodes at which |grad psi| shows that sheets meet: a chord through
///                  a wall passes such a voxel, next to both of its nodes
/// Time O(links beside meetings), in parallel.
std::vector<Link> linksThroughWalls(const Band& band, const LevelSet& levelSet,
                                    const std::vector<std::vector<NodeIndex>>& meetings);

}  // namespace igeo
