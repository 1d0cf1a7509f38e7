/// A signed distance from a volume of other values.
#pragma once

#include <igeo/base/progress.h>
#include <igeo/io/vdb_read.h>

namespace igeo {

/// The signed distance, three voxels to each side, to the surface where a volume's values are
/// `iso`: OpenVDB's tools::levelSetRebuild, through triangles. All that the surface encloses is
/// inside, whatever the values there. The result must pass checkLevelSet as any other.
/// @throws Error  BadInput for a value that is not finite, at active or inactive voxels, and where
///         no value crosses `iso`; Cancelled through `progress`
/// Time O(voxels in leaves).
LoadedGrid rebuilt(const LoadedGrid& volume, double iso, Progress& progress = Progress::none());

}  // namespace igeo
