/// Curves on S and regions of S as seeds.
///
/// A march starts from a list of seeds, each a point or a straight segment of a curve. The seeds of
/// one curve or region are consecutive in the list (SurfacePoint::joined) and form one *source*: a
/// single front with one label.
#pragma once

#include <igeo/band/band.h>
#include <igeo/band/surface_point.h>
#include <igeo/base/polyline.h>
#include <igeo/base/progress.h>
#include <igeo/metric/metric.h>

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace igeo {

/// The number of each seed's source.
std::vector<std::uint32_t> sourcesOf(const std::vector<SurfacePoint>& seeds);

/// A lower bound of the distance: no path on S is shorter than the straight line between its ends,
/// and none costs less per unit length than the least cost. Known for sources of one point, or of
/// one straight segment.
class StraightLines {
public:
    /// A source that is a point, or a straight segment.
    struct Line {
        Vec3d from, along;
        double length2 = 0;         ///< of `along`
        double start = -kInfinity;  ///< of the source; -infinity: no bound
    };

    StraightLines() = default;
    /// @param leastCost  per unit length, over all of the surface
    StraightLines(const std::vector<SurfacePoint>& seeds, double leastCost);
    /// @return the start value of the source and the straight line from it at the least cost;
    ///         -infinity for other sources
    double from(std::uint32_t source, const Vec3d& p) const {
        if (source >= lines_.size()) return -kInfinity;
        const Line& line = lines_[source];
        Vec3d off = p - line.from;
        if (line.length2 > 0)
            off = off - std::clamp(dot(off, line.along) / line.length2, 0.0, 1.0) * line.along;
        return line.start + leastCost_ * length(off);
    }
    /// The least over all sources; -infinity where it is known for none or sources are many.
    double fromAny(const Vec3d& p) const {
        constexpr std::size_t kFew = 8;
        double least = lines_.empty() || lines_.size() > kFew ? -kInfinity : kInfinity;
        for (std::uint32_t s = 0; s < lines_.size() && least > -kInfinity; ++s)
            least = std::min(least, from(s, p));
        return least;
    }
    /// Whether there is one source at most, and no segment.
    bool ofOnePoint() const {
        return lines_.empty() || (lines_.size() == 1 && !(lines_[0].length2 > 0));
    }
    Line only() const { return lines_.empty() ? Line{} : lines_[0]; }
    double leastCost() const { return leastCost_; }

private:
    std::vector<Line> lines_;  ///< per source
    double leastCost_ = 0;
};

/// Finds the seeds near a position.
class SeedsNear {
public:
    SeedsNear() = default;
    /// @param radius within which seeds are found, voxels
    SeedsNear(const std::vector<SurfacePoint>& seeds, double radius);

    /// Calls visit(k) for every seed within the radius of p, and for some farther away.
    template <typename Visit>
    void forNear(const Vec3d& p, const Visit& visit) const {
        if (cells_.empty()) {
            for (std::size_t k = 0; k < few_; ++k) visit(k);
            return;
        }
        const Ijk c = cellOf(p);
        for (int x = -1; x <= 1; ++x)
            for (int y = -1; y <= 1; ++y)
                for (int z = -1; z <= 1; ++z) {
                    const std::uint64_t key = keyOf(c + Ijk{x, y, z});
                    for (auto at = std::lower_bound(cells_.begin(), cells_.end(),
                                                    std::pair(key, std::size_t(0)));
                         at != cells_.end() && at->first == key; ++at)
                        visit(at->second);
                }
    }

private:
    Ijk cellOf(const Vec3d& p) const {
        auto cell = [&](double x) { return std::int32_t(std::floor(x / edge_)); };
        return {cell(p.x), cell(p.y), cell(p.z)};
    }
    /// Cells 2^21 apart share a key, which only causes needless visits.
    static std::uint64_t keyOf(const Ijk& c) {
        constexpr std::uint64_t kMask = (1 << 21) - 1;
        return (std::uint64_t(std::uint32_t(c.x)) & kMask) << 42 |
               (std::uint64_t(std::uint32_t(c.y)) & kMask) << 21 |
               (std::uint64_t(std::uint32_t(c.z)) & kMask);
    }

    std::size_t few_ = 0;  ///< up to this number, all seeds are visited
    double edge_ = 1;
    std::vector<std::pair<std::uint64_t, std::size_t>> cells_;  ///< sorted: key, seed
};

/// A curve as seeds: its points projected to S, and the straight lines between them in steps of
/// half a voxel, as segments from each to the next. The error is the height of S over chords of
/// half a voxel, 0.03 / R voxels at curvature 1 / R.
/// @param curve index space; `start` in voxels
/// @param snap  how far its points may be from S, voxels
/// @throws Error  InvalidArgument for a curve without points, a point farther than `snap` from S,
///         or a line between two points that S does not follow; Cancelled
/// Time O(length).
std::vector<SurfacePoint> seedsAlong(const Band& band, const Curve& curve, double snap,
                                     Progress& progress = Progress::none());

/// The part of S inside a body, as seeds: points on its rim, where foot points of the core inside
/// and outside are neighbors, found by bisection to a thousandth of a voxel. About three points per
/// voxel of the rim; errors of the distance are at most 0.05 voxels next to it and smaller farther
/// out. Parts between the foot points: the lines of the region as segments, and the points of S
/// next to the centers of its voxels; of rims and voxels those half a voxel or more from the other
/// seeds.
/// @param region bodies in index space; block(p, p, normal) is called
/// @return empty where the region does not cross S, or holds whole components
/// @throws Error  Cancelled
/// Time O(n) where the region may be, in parallel, and O(lines and voxels of the region).
std::vector<SurfacePoint> seedsAround(const Band& band, const Obstacles& region,
                                      Progress& progress = Progress::none());

/// A point inside a body that holds whole components of S, and not all of S; else empty.
/// @throws Error  Cancelled
/// Time O(n), in parallel.
std::vector<SurfacePoint> seedWithin(const Band& band, const Obstacles& region,
                                     Progress& progress = Progress::none());

/// Per node whether its foot point lies inside a body.
/// @throws Error  Cancelled
/// Time O(n), in parallel.
std::vector<std::uint8_t> nodesInside(const Band& band, const Obstacles& region,
                                      Progress& progress = Progress::none());

}  // namespace igeo
