/// Signs of psi that cannot be those of a distance, negative inside. Internal.
#pragma once

#include <openvdb/openvdb.h>

#include <span>
#include <vector>

namespace igeo {

using PsiLeaves = std::span<const openvdb::FloatTree::LeafNodeType* const>;

/// Whether the active voxels that lie farthest out are inside, along all axes.
bool isInsideOut(PsiLeaves leaves);

/// The voxels with the sign of the other side: most of their neighbors differ from them by more
/// than a distance can, and with the other sign no two do. In parallel.
/// @param leaves  those of psi
/// @param dx      voxel size, world units
std::vector<openvdb::Coord> wrongSigns(const openvdb::FloatGrid& psi, PsiLeaves leaves, double dx);

}  // namespace igeo
