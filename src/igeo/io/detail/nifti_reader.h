/// Volumes from NIfTI files. Internal.
#pragma once

#include <igeo/io/voxel_volume.h>

#include <string>

namespace igeo {

/// @param file  .nii, .hdr or .img, also .gz; of a pair the other file is read as well
/// @throws Error  Io, and BadInput, as readVolume; values are not checked
VoxelVolume readNifti(const std::string& file);

/// The other file of a pair, the .img to a .hdr and the .hdr to an .img, with or without .gz; empty
/// for .nii.
std::string otherOfPair(const std::string& file);

/// The same from bytes.
/// @param header, data  all of the two files, with or without gzip; data empty: they follow the
///                header in the same file
VoxelVolume niftiFrom(const std::string& file, const std::string& header, const std::string& data);

}  // namespace igeo
