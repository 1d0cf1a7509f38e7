/// Fills a Band from a level set.
#pragma once

#include <igeo/band.h>
#include <igeo/level_set.h>
#include <igeo/progress.h>

#include <vector>

namespace igeo {

/// A part of space, in index coordinates.
struct Ball {
    Vec3d centre;
    double radius = 0;
};

/// Numbers the active voxels with |psi| < h and computes each one's foot point x - psi n and normal
/// n = grad psi / |grad psi| (psiGradient in leaf_block.h: second order where psi is smooth).
/// @param h      half the band's thickness, voxels; at most the level set's half-width
/// @param region leaves that meet none of these balls are left out, for queries that stay near
///               their seeds; empty: the whole level set
/// @throws Error  InvalidArgument where h is wider than the level set, BadInput for too many voxels
/// Time O(active voxels of the region), in parallel; 35 bytes per node.
Band bandFromLevelSet(const LevelSet& levelSet, double h, const std::vector<Ball>& region = {},
                      Progress& progress = Progress::none());

}  // namespace igeo
