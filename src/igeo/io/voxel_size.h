/// The voxel sizes that grids can have, in the unit of the coordinates.
#pragma once

#include <igeo/base/error.h>

#include <string>

namespace igeo {

/// OpenVDB takes no transform that makes a voxel of less than 3e-15 cubic units; of a larger voxel
/// than this, squares of distances leave single precision.
constexpr double kLeastVoxelSize = 1.5e-5, kLargestVoxelSize = 1e15;

/// @param where  what has the voxels, for the message
/// @param kind   InvalidArgument for a size that was asked for
/// @throws Error  `kind` for a voxel size out of that range
void requireVoxelSize(double dx, const std::string& where,
                      Error::Kind kind = Error::Kind::BadInput);

/// The same for what is to be put on voxels, eight or more along its longest side.
/// @throws Error  BadInput for a side, but 0, on which no voxel size is in that range
void requireExtent(double longestSide, const std::string& where);

/// @throws Error  InvalidArgument for voxels larger than an eighth of the longest side: a band
/// around
///         fewer has no inside
void requireFine(double dx, double longestSide, const std::string& where);

}  // namespace igeo
