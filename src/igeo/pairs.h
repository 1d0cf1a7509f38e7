/// Distances between pairs of points, each found on the part of the surface around it.
#pragma once

#include <igeo/level_set.h>
#include <igeo/progress.h>
#include <igeo/surface_point.h>

#include <vector>

namespace igeo {

struct PairDistance {
    /// As found on S; `node` is kNoNode, as the bands are gone.
    SurfacePoint source, target;
    double distance = kInfinity;  ///< voxels; +inf: no way between them
};

/// Distances from sources[k] to targets[k] by marchJet, without weights.
///
/// Pairs of one source share a march. A way of length L from s to t stays in the ball of radius L/2
/// about their middle. So the march is on the band in such balls for a length of one and a half
/// times the straight line, which doubles until all targets are found within it; what is found then
/// is what a march on the whole surface finds.
/// @param h       half the band's thickness, voxels, as in bandFromLevelSet
/// @param sources, targets  index space, as many of either
/// @param snap    how far they may be from S, voxels
/// @throws Error  InvalidArgument for lists of different lengths, positions that are not finite, or
///         the first point that is too far from S; as bandFromLevelSet and marchJet; Cancelled
/// Time O(the surface around each source and its targets, and the leaves of the level set) per
/// source, side by side; what is far apart or not connected takes a march of the whole surface.
/// Same bits for any number of threads.
std::vector<PairDistance> pairDistances(const LevelSet& levelSet, double h,
                                        const std::vector<Vec3d>& sources,
                                        const std::vector<Vec3d>& targets, double snap,
                                        Progress& progress = Progress::none());

}  // namespace igeo
