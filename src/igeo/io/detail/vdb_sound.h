/// What is wrong with a grid of a file, beside its values. Internal.
#pragma once

#include <openvdb/Grid.h>

#include <string>

namespace igeo {

/// Refuses a transform without an inverse: places in such a grid are nowhere in the world, or
/// everywhere; and one of voxels so small that OpenVDB makes no affine map of it.
/// @param where  "grid 'psi' of file 'sphere.vdb'"
/// @throws Error  BadInput
void requireInvertible(const openvdb::GridBase& grid, const std::string& where);

/// Drops metadata that only a damaged file has: of types that OpenVDB does not know, or of another
/// type than its name stands for. It would refuse to copy the grid or to write it.
void dropDamagedMetadata(openvdb::GridBase& grid);

}  // namespace igeo
