/// Distances beyond the band.
#pragma once

#include <igeo/base/progress.h>
#include <igeo/march/field.h>
#include <igeo/surface/level_set.h>

namespace igeo {

/// Gives every active voxel of the level set outside the band the distance at its own foot point,
/// so that the grid covers the whole narrow band (constant along normals).
/// @param distance made by distanceGrid(); world units
/// @throws Error  Cancelled through `progress`
/// Time O(active voxels), in parallel.
void extendDistance(openvdb::FloatGrid& distance, const LevelSet& levelSet, const Field& field,
                    Progress& progress = Progress::none());

}  // namespace igeo
