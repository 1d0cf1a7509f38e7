/// The range of voxel sizes, in the unit of the coordinates.
#pragma once

#include <igeo/base/error.h>

#include <string>

namespace igeo {

/// OpenVDB accepts no transform with voxels of less than 3e-15 cubic units. For voxels above the
/// upper bound, squares of distances overflow single precision.
constexpr double kLeastVoxelSize = 1.5e-5, kLargestVoxelSize = 1e15;

/// @param where  what has the voxels, for the message
/// @param kind   InvalidArgument for a size given by the user
/// @throws Error  `kind` for a voxel size out of that range
void requireVoxelSize(double dx, const std::string& where,
                      Error::Kind kind = Error::Kind::BadInput);

/// The same for data that will be put on voxels, eight or more along its longest side.
/// @throws Error  BadInput for a side, other than 0, for which every voxel size is out of range
void requireExtent(double longestSide, const std::string& where);

/// @throws Error  InvalidArgument for voxels larger than an eighth of the longest side: a band
///         around fewer has no inside
void requireFine(double dx, double longestSide, const std::string& where);

}  // namespace igeo
