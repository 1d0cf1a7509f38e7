/// Volumes from NRRD files. Internal.
#pragma once

#include <igeo/io/voxel_volume.h>

#include <string>
#include <string_view>

namespace igeo {

/// @param file   .nrrd or .nhdr; a data file that it names is searched for in its folder
/// @param bytes  all of it
/// @throws Error  Io for a data file that cannot be read, and BadInput, as readVolume; values are
///         not checked
VoxelVolume readNrrd(const std::string& file, const std::string& bytes);

/// The data file that a header names; empty: there is none.
/// @param begin  the header, or the first bytes of the file
/// @throws Error  BadInput for other kinds of files
std::string nrrdDataFile(const std::string& file, std::string_view begin);

}  // namespace igeo
