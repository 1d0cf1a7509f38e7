/// Volumes from FreeSurfer's MGH files. Internal.
#pragma once

#include <igeo/io/voxel_volume.h>

#include <string>

namespace igeo {

/// @param bytes  all of a .mgh or .mgz file, with or without gzip
/// @throws Error  BadInput, as readVolume; values are not checked
VoxelVolume mghFrom(const std::string& file, const std::string& bytes);

}  // namespace igeo
