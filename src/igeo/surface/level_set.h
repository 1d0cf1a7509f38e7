/// A checked level set, and what its values show.
#pragma once

#include <igeo/base/types.h>
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
    bool halfPrecision = false;       ///< isInHalfPrecision: nothing shows what made the values
    std::uint64_t loweredVoxels = 0;  ///< before hollow edges, by a conversion; set right again
    std::uint64_t nearSurface = 0;    ///< |psi| < 1
    double crossingShare = 0;         ///< of nearSurface: a face neighbor has the other sign
    double gradientMedian = 0;        ///< of |grad psi| as given, central differences; NaN: no
                                      ///< voxel has six active neighbors
    double gradientShare = 0;         ///< of voxels with |grad psi| in [0.75, 1.25]
    double dividedBy = 1;             ///< psi was a distance times this; the share is that after
    std::uint64_t cutVoxels = 0;  ///< at the surface, yet a neighbor that should be there is not
    double largestCurvature = 0;  ///< 95th percentile of max |principal curvature| on S
    double reach = 0;             ///< least |psi| at which sheets meet; halfWidth if they do not
    double unresolvedShare = 0;   ///< of S: it bends, or sheets meet, within sqrt(3) voxels
};

/// A usable level set.
struct LevelSet {
    openvdb::FloatGrid::ConstPtr psi;  ///< signed distance, world units, no active tiles
    Similarity transform;
    std::string file, name;  ///< for messages and results
    LevelSetStats stats;
    std::vector<std::string> warnings;  ///< what a user should know, one sentence each
};

}  // namespace igeo
