/// The transforms of grids. Internal.
#pragma once

#include <igeo/base/types.h>
#include <openvdb/openvdb.h>

#include <string>

namespace igeo {

/// World from index as a similarity.
/// @param at  names the grid, at the end of a sentence
/// @throws Error  BadInput for a transform that is none, with what it does instead
Similarity similarityOf(const openvdb::math::Transform& transform, const std::string& at);

}  // namespace igeo
