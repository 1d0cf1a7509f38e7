/// Volumes from NRRD files. Internal.
#pragma once

#include <igeo/io/voxel_volume.h>

#include <string>

namespace igeo {

/// @param file   .nrrd or .nhdr; a data file that it names is searched for in its folder
/// @param bytes  all of it
/// @throws Error  Io for a data file that cannot be read, and BadInput, as readVolume; values are
///         not checked
VoxelVolume readNrrd(const std::string& file, const std::string& bytes);

}  // namespace igeo
