/// Volumes from NRRD files. Internal.
#pragma once

#include <igeo/io/voxel_volume.h>

#include <string>

namespace igeo {

/// @param file   .nrrd or .nhdr; where it names a file of data, that is looked for in its folder
/// @param bytes  all of it
/// @throws Error  Io for a file of data that cannot be read, and BadInput, as readVolume; the
///         values may be anything
VoxelVolume readNrrd(const std::string& file, const std::string& bytes);

}  // namespace igeo
