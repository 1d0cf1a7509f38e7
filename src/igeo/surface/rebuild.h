/// A signed distance made of a volume that is none.
#pragma once

#include <igeo/base/progress.h>
#include <igeo/io/vdb_read.h>

namespace igeo {

/// The signed distance, three voxels to each side, to the surface where a volume's values are
/// `iso`: OpenVDB's tools::levelSetRebuild, through triangles. What the surface encloses is
/// inside, whatever the values there. To be checked as any other (checkLevelSet).
/// @throws Error  BadInput for a value that is not finite, at an inactive voxel as well, and where
///         nothing has that value; Cancelled through `progress`
/// Time O(voxels in leaves).
LoadedGrid rebuilt(const LoadedGrid& volume, double iso, Progress& progress = Progress::none());

}  // namespace igeo
