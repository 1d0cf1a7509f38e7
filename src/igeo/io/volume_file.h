/// Volumes of voxels from files: images of heads, masks, scans.
#pragma once

#include <igeo/io/voxel_volume.h>

#include <string>

namespace igeo {

/// Whether a file is a volume, by its ending in any case: .nii .hdr .img (.gz too), .mgh .mgz .nrrd
/// .nhdr.
bool isVolumeFile(const std::string& file);

/// Reads a volume: NIfTI-1 and NIfTI-2, in one file or as a pair of .hdr and .img, with or without
/// gzip; FreeSurfer's MGH, with gzip (.mgz) or without; and NRRD, raw, gzip or text, with the data
/// in it or in one separate file.
///
/// World positions are those of the file, in its unit, usually the millimeter: of NIfTI by the
/// sform or, if there is none, the qform, with x to the right, y to the front, z up (RAS); of MGH
/// by its directions and center, as scanner RAS too; of NRRD by its directions and origin, in the
/// space that it names, mostly LPS; without directions by its spacings, or its axis mins and maxs
/// and their centers, along x, y and z, with a warning. RAS and LPS are not converted into each
/// other. Scale and intercept of NIfTI are applied.
/// @throws Error  Io where a file cannot be read; BadInput for other kinds of files, damaged or
///         truncated ones, volumes of several frames or channels, values that are not finite (with
///         the voxel), an axis of one voxel and axes that lie in one plane
/// Time O(size). Memory O(size), whatever counts the file announces.
VoxelVolume readVolume(const std::string& file);

}  // namespace igeo
