/// Whether a grid is a signed distance, how wide, how curved, where cut.
#pragma once

#include <igeo/base/progress.h>
#include <igeo/io/vdb_read.h>
#include <igeo/surface/level_set.h>

namespace igeo {

/// Checks a grid and describes it. A grid that others hold is left as it is: where it has active
/// tiles, strays or voxels with the wrong sign, is negative outside, or is too narrow, the level
/// set has a copy. It is negative outside, and gets the other sign, where the voxels farthest out
/// are negative along all axes.
///
/// Asks for a transform of uniform scale, rotation and translation, indices within +-2^30, finite
/// values, both signs, and |grad psi| near 1; judged by shares, since distances of real models have
/// creases and medial axes. Fewer than 1 in 5 voxels next to the surface at a change of sign
/// (closed surfaces: more than half) means an open surface was converted: psi is then next to
/// nowhere negative. Strays, active voxels whose |psi| lies two voxels and more beyond the last
/// shell of the band, are made inactive with a warning: a distance grows by a voxel from voxel to
/// voxel, so they hold none.
/// @throws Error  BadInput with what to do about it
/// Time O(active voxels), in parallel.
LevelSet checkLevelSet(LoadedGrid loaded, Progress& progress = Progress::none());

/// The same into `levelSet`, which keeps what was found out before a refusal: `transform.dx` is 0
/// where it did not come to that, `stats.activeVoxels` and `stats.nearSurface` likewise where
/// values and differences were not examined.
void checkLevelSet(LoadedGrid loaded, LevelSet& levelSet, Progress& progress = Progress::none());

/// A grid that the library has made of something else, which was judged before: described as
/// checkLevelSet does, and neither refused nor warned of.
/// @throws Error  Cancelled through `progress`
LevelSet describeLevelSet(LoadedGrid made, Progress& progress = Progress::none());

/// Widens the narrow band to at least `halfWidth` voxels with OpenVDB's fast sweeping (first order
/// in the new voxels) and adds a warning that says so; does nothing if it is as wide already.
void widen(LevelSet& levelSet, double halfWidth);

}  // namespace igeo
