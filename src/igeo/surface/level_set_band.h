/// Fills a Band from a level set.
#pragma once

#include <igeo/band/band.h>
#include <igeo/base/ball.h>
#include <igeo/base/progress.h>
#include <igeo/surface/level_set.h>

#include <string>
#include <vector>

namespace igeo {

/// Numbers the active voxels with |psi| < h and computes each one's foot point x - psi n and normal
/// n = grad psi / |grad psi| (psiGradient in leaf_block.h: second order where psi is smooth).
/// @param h      half the band's thickness, voxels; at most the level set's half-width
/// @param region leaves that meet none of these balls (index space) are left out, for queries that
/// stay near
///               their seeds; empty: the whole level set
/// @throws Error  InvalidArgument where h is wider than the level set, BadInput for too many voxels
/// Time O(active voxels of the region), in parallel; 24 bytes per node.
Band bandFromLevelSet(const LevelSet& levelSet, double h, const std::vector<Ball>& region = {},
                      Progress& progress = Progress::none());

/// For grids on a band that was made from no grid.
openvdb::math::Transform::Ptr gridTransform(const Similarity& transform);

/// The other way: psi of a band as a level set, for what is made of one (pictures, meshes,
/// engravings). Where much of it is no distance, as in thin parts, a warning says so.
/// @param band    its psi signed, h at least 2 voxels
/// @param closed  whether it has an inside, so that what is not active is known to be within or
///                without
/// @param file, name  for messages and results
/// @throws Error  as gridTransform, and Cancelled through `progress`
LevelSet levelSetFromBand(const Band& band, bool closed, const std::string& file,
                          const std::string& name, Progress& progress = Progress::none());

}  // namespace igeo
