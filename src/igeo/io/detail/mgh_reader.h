/// Volumes from FreeSurfer's MGH files. Internal.
#pragma once

#include <igeo/io/voxel_volume.h>

#include <string>

namespace igeo {

/// @param bytes  all of a .mgh or .mgz file, as they are: with gzip or without
/// @throws Error  BadInput, as readVolume; the values may be anything
VoxelVolume mghFrom(const std::string& file, const std::string& bytes);

}  // namespace igeo
