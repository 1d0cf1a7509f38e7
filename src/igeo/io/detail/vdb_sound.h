/// Checks of a grid from a file, apart from its values. Internal.
#pragma once

#include <openvdb/Grid.h>

#include <string>

namespace igeo {

/// Refuses a transform without an inverse, in which positions have no voxel, and one with voxels so
/// small that OpenVDB makes no affine map of it.
/// @param where  "grid 'psi' of file 'sphere.vdb'"
/// @throws Error  BadInput
void requireInvertible(const openvdb::GridBase& grid, const std::string& where);

/// Drops metadata of unregistered types, or of a type other than its name requires: it occurs only
/// in damaged files, and OpenVDB would refuse to copy or write the grid with it.
void dropDamagedMetadata(openvdb::GridBase& grid);

}  // namespace igeo
