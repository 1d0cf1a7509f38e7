/// A checked level set: whether it is a signed distance, how wide, how curved, where cut.
#pragma once

#include <igeo/base/progress.h>
#include <igeo/base/types.h>
#include <igeo/io/vdb_read.h>
#include <openvdb/openvdb.h>

#include <cstdint>
#include <string>
#include <vector>

namespace igeo {

/// How far from 1 |grad psi| of a good distance may be, at a voxel.
constexpr double kGradientTolerance = 0.25;

/// What the values of a level set show. Shares are in [0, 1], lengths and curvatures in voxels.
struct LevelSetStats {
    std::uint64_t activeVoxels = 0;
    std::uint64_t badVoxels = 0;      ///< NaN or infinite
    Ijk firstBad{};                   ///< the first of them
    std::uint64_t negative = 0;       ///< active voxels inside
    double halfWidth = 0;             ///< largest |psi| of an active voxel that is no stray
    std::uint64_t strayVoxels = 0;    ///< |psi| far beyond that of all others
    bool conversionUndone = false;    ///< isRenormalized: the last step of the conversion
    std::uint64_t loweredVoxels = 0;  ///< before hollow edges, by a conversion; set right again
    std::uint64_t nearSurface = 0;    ///< |psi| < 1
    double crossingShare = 0;         ///< of nearSurface: a face neighbor has the other sign
    double gradientMedian = 0;        ///< of |grad psi|, central differences; NaN: no voxel has six
                                      ///< active neighbors
    double gradientShare = 0;         ///< of voxels with |grad psi| in [0.75, 1.25]
    std::uint64_t cutVoxels = 0;  ///< at the surface, yet a neighbor that should be there is not
    double largestCurvature = 0;  ///< 95th percentile of max |principal curvature| on S
    double reach = 0;             ///< least |psi| at which sheets meet; halfWidth if they do not
};

/// A usable level set.
struct LevelSet {
    openvdb::FloatGrid::ConstPtr psi;  ///< signed distance, world units, no active tiles
    Similarity transform;
    std::string file, name;  ///< for messages and results
    LevelSetStats stats;
    std::vector<std::string> warnings;  ///< what a user should know, one sentence each
};

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
