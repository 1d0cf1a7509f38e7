/// Distances between pairs of points, each computed on the part of the surface around it.
#pragma once

#include <igeo/band/surface_point.h>
#include <igeo/base/progress.h>
#include <igeo/metric/metric.h>
#include <igeo/path/path.h>
#include <igeo/surface/level_set.h>
#include <igeo/surface/level_set_band.h>

#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace igeo {

struct SolvedPair {
    /// The points found on S; `node` is kNoNode, because the bands are freed.
    SurfacePoint source, target;
    /// Voxels times weight; +infinity: no path joins them; NaN: a point was skipped.
    double distance = kInfinity;
    /// From source to target, if requested: with normals, and at each vertex the distance from the
    /// source. Without vertices unless Reached.
    Path path = {};
};

/// A surface whose bands are made part by part, and the metric on them.
struct PairSurface {
    /// The band within some balls; without balls that of the whole surface. Several threads may
    /// call it at once.
    std::function<std::shared_ptr<const Band>(const std::vector<Ball>&, Progress&)> band;
    std::function<MetricPtr(const Band&, Progress&)> metric;  ///< none: Euclidean
    /// The point of the surface nearest to one in index space; none: nearestSurfacePoint.
    std::function<SurfacePoint(const Band&, const Vec3d&)> nearest;
    /// Throws for a point of pair k that is too far from S; none: a message in voxels.
    std::function<void(const Vec3d& askedIndex, const std::string& what)> refuse;
    /// Lower bound of the cost per unit length; 0: unknown, and every pair takes the whole surface
    double leastWeight = 1;
    double diagonal = 0;  ///< across the surface, voxels
    enum class Paths { None, Traced, Straightened } paths = Paths::None;
    /// Skip pairs with a point that is too far from S (SurfacePoint::offSurface), instead of an
    /// error.
    bool skipOffSurface = false;
    /// The name of a point in messages, by its pair and whether it is the target; none: "the target
    /// of pair 3".
    std::function<std::string(std::size_t pair, bool target)> nameOf = {};
};

/// Distances from sources[k] to targets[k] by marchJet.
///
/// Pairs of one source share a march. A path of length L from s to t stays in the ball of radius
/// L/2 around their middle, and one of cost c is at most c / leastWeight long. So the march uses
/// the band in such balls for a length of one and a half times the straight line, which doubles
/// until all targets are found within it. The result equals that of a march on the whole surface.
/// @param sources, targets  index space, equally many
/// @param snap    how far they may be from S, voxels
/// @throws Error  InvalidArgument for lists of different lengths, positions that are not finite, or
///         the first point that is too far from S; as bandFromLevelSet and marchJet; Cancelled
/// Time O(the surface around each source and its targets, and the leaves of the level set) per
/// source, in parallel; pairs that are far apart or not connected take a march of the whole
/// surface. Same bits for any number of threads.
std::vector<SolvedPair> pairDistances(const PairSurface& surface, const std::vector<Vec3d>& sources,
                                      const std::vector<Vec3d>& targets, double snap,
                                      Progress& progress = Progress::none());

}  // namespace igeo
