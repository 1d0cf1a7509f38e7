#include <igeo/metric/slope.h>

#include <fmt/core.h>
#include <igeo/band/detail/mesh_fan.h>
#include <igeo/base/detail/single.h>
#include <igeo/base/error.h>
#include <igeo/base/parallel.h>
#include <igeo/metric/obstacles.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

namespace igeo {

namespace {

/// Rounding of normals must not block a plane at the limit.
constexpr double kRounding = 1e-6;

void check(const SlopeWeight& slope) {
    if (std::abs(length(slope.up) - 1) < 1e-6 && slope.steepest > 0 &&
        slope.steepest < std::numbers::pi / 2 && slope.power > 0 && std::isfinite(slope.power))
        return;
    throw Error(Error::Kind::InvalidArgument,
                fmt::format("a slope of {} radians at most, to the power of {}; allowed are angles "
                            "above 0 and below pi/2, powers above 0, and a direction of length 1",
                            slope.steepest, slope.power));
}

/// The tangent of the slope of a plane with a unit normal.
double slopeOf(const Vec3d& normal, const Vec3d& up) {
    return length(cross(normal, up)) / std::max(std::abs(dot(normal, up)), 1e-12);
}

/// The slopes of a band. On an edge the normal of a node lies between those of both sides, and
/// along a ridge it points straight up. On a mesh the least of the triangles that meet there
/// counts. On level sets and points, where voxels round edges off, at least that of the gentler
/// side does.
class Slopes {
public:
    Slopes(const Band& band, const Vec3d& up) : band_(band), up_(up) {
        if (band.triangles) return;
        bend_.resize(band.size());
        forNodes([&](NodeIndex i) { bend_[i] = bendAt(i); });
        gentler_.resize(band.size());
        forNodes([&](NodeIndex i) { gentler_[i] = besideEdge(i); });
    }

    double at(NodeIndex i) const {
        return band_.triangles ? onMesh(i) : std::max(slopeAt(i), gentler_[i]);
    }
    /// The slope of the gentler side of an edge at each node of a level set or of points; 0 where
    /// there is no edge.
    const std::vector<double>& gentlerSides() const { return gentler_; }
    template <typename Visit>
    void forNodes(const Visit& visit) const {
        parallelFor(band_.size(), 4096, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) visit(NodeIndex(i));
        });
    }

private:
    double slopeAt(const Vec3f& normal) const { return slopeOf(normalized(Vec3d(normal)), up_); }
    double slopeAt(NodeIndex i) const { return slopeAt(band_.normal[i]); }
    double onMesh(NodeIndex i) const {
        constexpr double kOn = 1e-3;  // voxels
        const SurfaceTriangles::Place foot = band_.footPlace(i);
        double least = kInfinity;
        // In the precision of the band, in which triangles of one plane have one normal.
        for (const std::uint32_t t :
             trianglesAt(*band_.triangles, {foot.triangle, foot.point}, kOn))
            if (const Vec3d n = band_.triangles->normal(t); n != Vec3d{})
                least = std::min(least, slopeOf(normalized(inSingle(n)), up_));
        return least < kInfinity ? least : slopeAt(i);
    }
    /// By how much the normal turns per voxel, from a node to its neighbors.
    float bendAt(NodeIndex i) const;
    double besideEdge(NodeIndex i) const;

    const Band& band_;
    const Vec3d up_;
    std::vector<float> bend_;      ///< bendAt; empty on a mesh
    std::vector<double> gentler_;  ///< gentlerSides; empty on a mesh
};

float Slopes::bendAt(NodeIndex i) const {
    constexpr float kLeastStep = 0.5f;  // voxels
    float most = 0;
    band_.forNeighbors(&BandLeaf::band, i, [&](NodeIndex j, int x, int y, int z) {
        const float step = length(Vec3f(Ijk{x, y, z}) + band_.footOf(j) - band_.footOf(i));
        if (step < kLeastStep || !band_.linked(i, j)) return;
        const float cosine = std::min(dot(band_.normal[i], band_.normal[j]), 1.0f);
        most = std::max(most, std::acos(cosine) / step);
    });
    return most;
}

double Slopes::besideEdge(NodeIndex i) const {
    // Radians per voxel: a round ridge of 7 voxels radius is none. Nodes above an edge belong to
    // it, as far off as the band is thick: those of the sides are beyond them.
    constexpr int kReach = 4;
    constexpr float kEdge = 0.15f, kFace = 0.03f;
    constexpr float kAlike = -0.5f;  // cosine: farther ones are across a wall
    if (bend_[i] < kEdge) return 0;
    const Vec3f& here = band_.normal[i];
    std::vector<NodeIndex> faces;
    band_.forBox(&BandLeaf::band, i, {}, kReach, [&](NodeIndex j, const Ijk&) {
        if (bend_[j] < kFace && dot(here, band_.normal[j]) > kAlike) faces.push_back(j);
    });
    const auto farthestFrom = [&](const Vec3f& n) {
        return *std::min_element(faces.begin(), faces.end(), [&](NodeIndex a, NodeIndex b) {
            return dot(band_.normal[a], n) < dot(band_.normal[b], n);
        });
    };
    if (faces.empty()) return 0;
    // The normal here lies between those of the sides.
    const Vec3f &one = band_.normal[farthestFrom(here)], &other = band_.normal[farthestFrom(one)];
    if (dot(one, other) > dot(one, here)) return 0;
    return std::min(slopeAt(one), slopeAt(other));
}

/// Blocks where the normal of a level set or of points is too steep, and along edges between two
/// sides that are.
class SteepNormals final : public Obstacles {
public:
    SteepNormals(const Band& band, const Slopes& slopes, const Vec3d& up, double steepest)
        : up_(up), leastCosine_(std::cos(steepest) - kRounding) {
        const double most = std::tan(steepest);
        for (NodeIndex i = 0; i < band.size(); ++i)
            if (slopes.gentlerSides()[i] > most) edges_.push_back(voxelAt(band.footPoint(i)));
        std::sort(edges_.begin(), edges_.end());
    }

    bool block(const Vec3d& a, const Vec3d& b, const Vec3d& normal) const override {
        return std::abs(dot(normal, up_)) < leastCosine_ || isOnEdge(a) || isOnEdge(b);
    }
    bool mayBeNear(const Vec3d&, double) const override { return true; }

private:
    using Voxel = std::array<std::int32_t, 3>;
    static Voxel voxelAt(const Vec3d& p) {
        const Ijk v = roundToIjk(p);
        return {v.x, v.y, v.z};
    }
    bool isOnEdge(const Vec3d& p) const {
        return std::binary_search(edges_.begin(), edges_.end(), voxelAt(p));
    }
    const Vec3d up_;
    const double leastCosine_;
    std::vector<Voxel> edges_;
};

/// Null where nothing of a mesh is too steep.
std::shared_ptr<const Obstacles> steepTriangles(const Band& band, const Vec3d& up,
                                                double steepest) {
    const SurfaceTriangles& triangles = *band.triangles;
    const double most = std::tan(steepest) * (1 + kRounding);
    std::vector<bool> steep(triangles.size());
    bool any = false;
    for (std::size_t t = 0; t < steep.size(); ++t) {
        const Vec3d n = triangles.normal(t);
        steep[t] = n != Vec3d{} && slopeOf(n, up) > most;
        any = any || steep[t];
    }
    if (!any) return nullptr;
    auto set = std::make_shared<ObstacleSet>(band.transform);
    set->addTriangles(triangles, steep);
    return set;
}

}  // namespace

SlopeCosts slopeCosts(const Band& band, const SlopeWeight& slope) {
    check(slope);
    const Vec3d up = normalized(band.transform.indexFromWorldDirection(slope.up));
    const Slopes slopes(band, up);
    const double most = std::tan(slope.steepest);
    SlopeCosts costs;
    costs.weights.resize(band.size());
    slopes.forNodes([&](NodeIndex i) {
        costs.weights[i] = float(1 + std::pow(std::min(slopes.at(i) / most, 1.0), slope.power));
    });
    if (band.triangles)
        costs.steep = steepTriangles(band, up, slope.steepest);
    else
        costs.steep = std::make_shared<SteepNormals>(band, slopes, up, slope.steepest);
    return costs;
}

}  // namespace igeo
