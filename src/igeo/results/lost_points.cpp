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
    static constexpr DisjointSets::Index kNone = std::numeric_limits<DisjointSets::Index>::max();

    Parts(const SurfaceTriangles& mesh, const Metric& costs)
        : triangles(mesh), metric(costs), sets(mesh.points().size()) {
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
    DisjointSets::Index at(const Vec3d& p) {
        const std::uint32_t t = triangles.nearest(p).triangle;
        if (t != SurfaceTriangles::kNone)
            for (unsigned k = 0; k < 3; ++k)
                if (isClear(p, triangles.corner(t, k), t)) return sets.first(triangles[t][k]);
        return kNone;
    }

    const SurfaceTriangles& triangles;
    const Metric& metric;
    DisjointSets sets;
};

LostPoints::LostPoints(const Band& band, const MetricPtr& metric)
    : band_(band), metric_(metric ? metric : std::make_shared<Metric>()) {}
LostPoints::~LostPoints() = default;

void LostPoints::add(const std::vector<SurfacePoint>& seeds, const std::vector<Vec3d>& pWorld,
                     const std::vector<double>& distance) {
    for (const double d : distance) all_ += !std::isnan(d);  // NaN: none was asked for
    if (!band_.triangles || std::count(distance.begin(), distance.end(), kInfinity) == 0) return;
    if (!parts_) parts_ = std::make_unique<Parts>(*band_.triangles, *metric_);
    std::set<DisjointSets::Index> reached;  // a march may add as little as a pair of points
    auto reach = [&](const Vec3d& pIndex) {
        if (const auto part = parts_->at(pIndex); part != Parts::kNone) reached.insert(part);
    };
    auto indexOf = [&](std::size_t k) { return band_.transform.indexFromWorld(pWorld[k]); };
    for (const SurfacePoint& seed : seeds) reach(seed.pIndex);
    for (std::size_t k = 0; band_.joints > 0 && k < distance.size(); ++k)
        if (distance[k] < kInfinity) reach(indexOf(k));
    for (std::size_t k = 0; k < distance.size(); ++k)
        if (distance[k] == kInfinity)
            if (const auto part = parts_->at(indexOf(k)); part != Parts::kNone)
                lost_ += reached.count(part);
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
    LostPoints lost(*field.band, field.metric);
    lost.add(field.seeds, pWorld, distance);
    return lost.warning(what);
}

}  // namespace igeo
