/// What a level set is refused for or warned of.
#pragma once

#include <igeo/surface/detail/leaf_block.h>
#include <igeo/surface/level_set.h>
#include <openvdb/openvdb.h>

#include <string>
#include <vector>

namespace igeo {

/// Names file and grid, in brackets, for the end of a message.
std::string where(const LevelSet& s);

std::vector<const LeafBlock::Leaf*> leavesOf(const openvdb::FloatGrid& grid);

/// @throws Error  BadInput: a voxel's index lies beyond +-2^30
void judgeExtent(const LevelSet& s);

/// What the values alone show, before any stencil.
/// @throws Error  BadInput: a value that is not finite, one sign alone, or too narrow a band
void judgeRange(const LevelSet& s);

/// What differences of psi show. Adds warnings.
/// @throws Error  BadInput: no distance, or hollow
void judgeShape(LevelSet& s);

}  // namespace igeo
