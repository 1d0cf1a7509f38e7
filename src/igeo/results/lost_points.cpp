#include <igeo/results/lost_points.h>

#include <fmt/core.h>
#include <igeo/band/surface_triangles.h>
#include <igeo/base/detail/disjoint_sets.h>
#include <igeo/base/detail/text.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

namespace igeo {

/// The corners of the triangles, joined along edges that no obstacle blocks.
struct LostPoints::Parts {
    using Part = DisjointSets::Index;
    static constexpr Part kNone = std::numeric_limits<Part>::max(), kUnknown = kNone - 1;

    Parts(const SurfaceTriangles& mesh, const Metric& costs, std::size_t points)
        : triangles(mesh), metric(costs), sets(mesh.points().size()), ofPoint(points, kUnknown) {
        for (std::uint32_t t = 0; t < mesh.size(); ++t)
            for (unsigned k = 0; k < 3; ++k)
                if (isClear(mesh.corner(t, k), mesh.corner(t, k + 1), t))
                    sets.join(mesh[t][k], mesh[t][(k + 1) % 3]);
    }
    /// In steps of a voxel at most.
    bool isClear(const Vec3d& a, const Vec3d& b, std::uint32_t t) const {
        if (!metric.obstacles) return true;
        const Vec3d n = triangles.normal(t), step = b - a;
        const auto steps = std::max(1.0, std::ceil(length(step)));
        for (double s = 0; s < steps; ++s)
            if (metric.blocked(a + (s / steps) * step, a + ((s + 1) / steps) * step, n))
                return false;
        return true;
    }
    /// The part around a point of S; kNone inside of obstacles.
    Part at(const Vec3d& p) {
        const std::uint32_t t = triangles.nearest(p).triangle;
        if (t != SurfaceTriangles::kNone)
            for (unsigned k = 0; k < 3; ++k)
                if (isClear(p, triangles.corner(t, k), t)) return sets.first(triangles[t][k]);
        return kNone;
    }

    const SurfaceTriangles& triangles;
    const Metric& metric;
    DisjointSets sets;
    std::vector<Part> ofPoint;
};

LostPoints::LostPoints(const Band& band, const MetricPtr& metric, std::vector<Vec3d> pWorld)
    : band_(band),
      metric_(metric ? metric : std::make_shared<Metric>()),
      points_(std::move(pWorld)) {}
LostPoints::~LostPoints() = default;

void LostPoints::add(const std::vector<SurfacePoint>& seeds, const double* distance) {
    add(seeds, 0, points_.size(), distance);
}
void LostPoints::addSource(const Field& field, std::size_t source, const double* distance) {
    std::vector<SurfacePoint> seeds;
    for (std::size_t s = 0; s < field.seeds.size(); ++s)
        if (field.source[s] == source) seeds.push_back(field.seeds[s]);
    add(seeds, distance);
}
void LostPoints::add(const std::vector<SurfacePoint>& seeds, std::size_t point, double distance) {
    add(seeds, point, point + 1, &distance);
}

void LostPoints::add(const std::vector<SurfacePoint>& seeds, std::size_t begin, std::size_t end,
                     const double* distance) {
    const double* const last = distance + (end - begin);
    all_ += std::size_t(std::count_if(distance, last, [](double d) { return !std::isnan(d); }));
    if (!band_.triangles || std::count(distance, last, kInfinity) == 0) return;
    if (!parts_) parts_ = std::make_unique<Parts>(*band_.triangles, *metric_, points_.size());
    auto partOf = [&](std::size_t k) {
        auto& part = parts_->ofPoint[k];
        if (part == Parts::kUnknown) part = parts_->at(band_.transform.indexFromWorld(points_[k]));
        return part;
    };
    std::set<Parts::Part> reached;  // a march may add as little as a pair of points
    for (const SurfacePoint& seed : seeds) reached.insert(parts_->at(seed.pIndex));
    for (std::size_t k = begin; band_.joints > 0 && k < end; ++k)
        if (distance[k - begin] < kInfinity) reached.insert(partOf(k));
    reached.erase(Parts::kNone);
    for (std::size_t k = begin; k < end; ++k)
        if (distance[k - begin] == kInfinity) lost_ += reached.count(partOf(k));
}

std::string LostPoints::warning(const char* what) const {
    if (lost_ == 0) return "";
    return fmt::format(
        "{} of {} {} ({}) have no distance, though triangles join them to a seed: they are "
        "in walls or between sheets too narrow for the voxels, or beyond a vertex that is all two "
        "parts share; take smaller voxels, or weld the parts along edges",
        lost_, all_, what, percent(double(lost_) / double(all_)));
}

std::string lostWarning(const Field& field, const char* what, const std::vector<Vec3d>& pWorld,
                        const std::vector<double>& distance) {
    constexpr double kBeyondCore = 2;  // voxels
    if (field.stoppedEarly ||
        (field.greatest < kInfinity &&
         field.greatest < field.maxDistance + kBeyondCore * field.metric->largest()))
        return "";
    LostPoints lost(*field.band, field.metric, pWorld);
    lost.add(field.seeds, distance.data());
    return lost.warning(what);
}

}  // namespace igeo
