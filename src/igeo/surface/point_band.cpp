#include <igeo/surface/point_band.h>

#include <fmt/core.h>
#include <igeo/base/detail/box.h>
#include <igeo/base/detail/steps.h>
#include <igeo/base/error.h>
#include <igeo/base/parallel.h>
#include <igeo/surface/detail/edge_fans.h>
#include <igeo/surface/detail/points_around.h>
#include <igeo/surface/medial_radii.h>

#include <algorithm>
#include <cmath>
#include <tuple>

namespace igeo {

namespace {

/// How far beyond a rim a voxel still represents a point on it, as of a mesh: without such voxels
/// the last nodes before a rim are so few that fronts along it turn away from it. Voxels.
constexpr double kBeyondRim = 0.5;

using Kind = Error::Kind;
using Index = PointSurface::Index;

/// Voxels finer than this fraction of the spacing resolve the fits, not the points.
constexpr double kFinest = 8;
/// Least number of voxels along the cloud's longest side.
constexpr double kCoarsest = 8;

void requireRange(const PointSurface& surface, PointBandKind kind, double dx, double h) {
    const CloudDensity& density = surface.density();
    Box box;
    for (std::size_t i = 0; i < surface.points().size(); ++i) box.include(surface.points()[i]);
    const double side = box.longestSide();
    if (!(dx >= density.spacing / kFinest * (1 - 1e-9)))
        throw Error(Kind::InvalidArgument,
                    fmt::format("{}: voxels of {:.3g} are too fine for points {:.3g} apart "
                                "(median); allowed are {:.3g} and more",
                                surface.file(), dx, density.spacing, density.spacing / kFinest),
                    "choose a voxel size near the spacing");
    if (!(dx <= side / kCoarsest))
        throw Error(Kind::InvalidArgument,
                    fmt::format("{}: voxels of {:.3g} are too coarse for a cloud {:.3g} long; "
                                "allowed are {:.3g} and less",
                                surface.file(), dx, side, side / kCoarsest),
                    fmt::format("choose a voxel size near the spacing, {:.3g}", density.spacing));
    const double least = kind == PointBandKind::Fits ? std::sqrt(3.0) / 2 : density.spacing99 / dx;
    if (!(h >= least * (1 - 1e-9) && std::isfinite(h)))
        throw Error(Kind::InvalidArgument,
                    fmt::format("{}: a band of {:.3g} ({:.3g} voxels) has holes: points are up to "
                                "{:.3g} apart, it takes {:.3g} ({:.3g} voxels) at least",
                                surface.file(), h * dx, h, density.spacing99, least * dx, least),
                    "widen the band");
    if (const double farthest = box.farthest(); !(farthest / dx < kFarthestIndex))
        throw Error(Kind::BadInput,
                    fmt::format("{}: a coordinate of {:.3g} is {:.3g} voxels from the origin; up "
                                "to {:.3g} can be numbered",
                                surface.file(), farthest, farthest / dx, double(kFarthestIndex)),
                    "move the cloud to the origin");
}

/// Nodes of one leaf, before their numbering.
struct LeafPart {
    BandLeaf leaf;
    std::vector<float> psi;
    std::vector<Vec3f> foot, normal;
    std::vector<std::uint32_t> onEdge;  ///< those with foot points on sharp edges
};

class Filler {
public:
    Filler(const PointSurface& surface, PointBandKind kind, double dx, double h)
        : surface_(surface), points_(surface.points()), kind_(kind), dx_(dx), h_(h) {}

    /// How far, in world units, a voxel of the band may be from its nearest point i.
    double reach(std::size_t i) const {
        return kind_ == PointBandKind::Balls ? h_ * dx_ : std::hypot(h_ * dx_, points_.reach(i));
    }

    /// The leaves that come within the reach of a point, sorted.
    std::vector<Ijk> candidates() const;
    using Feet = std::vector<PointSurface::Foot>;  ///< per voxel of a leaf
    void fill(LeafPart& part, PointsAround& around, Feet& feet) const;

private:
    PointSurface::Foot footOf(const Vec3d& x, PointsAround& around) const;

    const PointSurface& surface_;
    const PointTree& points_;
    PointBandKind kind_;
    double dx_, h_;
};

bool before(const Ijk& a, const Ijk& b) {
    return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z);
}

void sortUnique(std::vector<Ijk>& origins) {
    std::sort(origins.begin(), origins.end(), before);
    origins.erase(std::unique(origins.begin(), origins.end()), origins.end());
}

std::vector<Ijk> Filler::candidates() const {
    constexpr std::size_t kChunk = 1024;
    std::vector<std::vector<Ijk>> parts((points_.size() + kChunk - 1) / kChunk);
    parallelFor(parts.size(), 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t c = begin; c < end; ++c) {
            for (std::size_t i = c * kChunk; i < std::min(points_.size(), (c + 1) * kChunk); ++i) {
                const double r = reach(i) / dx_;
                const Vec3d p = points_[i] * (1 / dx_), around{r, r, r};
                const Ijk low = floorToIjk(p - around), high = floorToIjk(p + around);
                for (int x = low.x & ~7; x <= high.x; x += 8)
                    for (int y = low.y & ~7; y <= high.y; y += 8)
                        for (int z = low.z & ~7; z <= high.z; z += 8) {
                            const Vec3d corner(x, y, z);
                            Vec3d d;
                            for (int a = 0; a < 3; ++a)
                                d[a] = p[a] - std::clamp(p[a], corner[a], corner[a] + 7);
                            if (length(d) <= r) parts[c].push_back({x, y, z});
                        }
            }
            // Neighbors in the tree are neighbors in space, so most duplicates are removed here.
            sortUnique(parts[c]);
        }
    });
    std::vector<Ijk> all;
    for (const auto& part : parts) all.insert(all.end(), part.begin(), part.end());
    sortUnique(all);
    return all;
}

PointSurface::Foot Filler::footOf(const Vec3d& x, PointsAround& around) const {
    const PointTree::Found nearest = around.nearest(x).front();
    const Index i = nearest.point;
    if (kind_ == PointBandKind::Fits)
        return nearest.squared < reach(i) * reach(i)
                   ? surface_.project(x, h_ * dx_, around, kBeyondRim * dx_)
                   : PointSurface::Foot{};
    const Vec3d n = surface_.normal(i);
    return {nearest.squared < h_ * h_ * dx_ * dx_, points_[i], n, dot(x - points_[i], n)};
}

void Filler::fill(LeafPart& part, PointsAround& around, Feet& feet) const {
    // With fine voxels most leaves are off the surface. All voxels are within kHalf of the middle;
    // those of a block of 4^3 within kHalfBlock of its middle.
    constexpr double kHalf = 6.1, kHalfBlock = 2.6;
    const Vec3d middle = dx_ * (Vec3d(part.leaf.origin) + Vec3d{3.5, 3.5, 3.5});
    const PointTree::Found nearest = points_.nearest(middle);
    const double farthest = (kHalf + 1.25 * h_) * dx_ + points_.reach(nearest.point) / 8;
    if (kind_ == PointBandKind::Fits && surface_.roughDistance(middle, nearest.point) > farthest)
        return;
    const double beside = surface_.reachOfProject(nearest.point, h_ * dx_);
    for (int block = 0; block < 8; ++block) {
        const Ijk low{4 * (block >> 2), 4 * (block >> 1 & 1), 4 * (block & 1)};
        const Vec3d center = dx_ * (Vec3d(part.leaf.origin + low) + Vec3d{1.5, 1.5, 1.5});
        around.moveTo(center, kHalfBlock * dx_, beside);
        const bool any = kind_ == PointBandKind::Balls || around.anyNear([&](Index i) {
            return surface_.mayProject(center, kHalfBlock * dx_, i, h_ * dx_);
        });
        for (int k = 0; k < 64; ++k) {
            const Ijk in = low + Ijk{k >> 4, k >> 2 & 3, k & 3};
            feet[Band::offsetOf(in.x, in.y, in.z)] =
                any ? footOf(dx_ * Vec3d(part.leaf.origin + in), around) : PointSurface::Foot{};
        }
    }
    for (unsigned at = 0; at < feet.size(); ++at) {
        const PointSurface::Foot& foot = feet[at];
        if (!foot.valid) continue;
        const Ijk in{int(at >> 6), int(at >> 3 & 7), int(at & 7)};
        const Vec3d x = dx_ * Vec3d(part.leaf.origin + in);
        part.leaf.band.insert(at);
        if (foot.onEdge) part.onEdge.push_back(std::uint32_t(part.psi.size()));
        part.psi.push_back(float(foot.psi / dx_));
        part.foot.push_back(Vec3f((foot.point - x) * (1 / dx_)));
        part.normal.push_back(Vec3f(foot.normal));
    }
}

/// Nodes around sharp edges, for the core: their normals fan out between those of both faces, as on
/// level sets (addFans).
std::vector<NodeIndex> nodesAroundEdges(const Band& band, const std::vector<LeafPart>& parts) {
    std::vector<NodeIndex> nodes;
    for (std::size_t l = 0; l < parts.size(); ++l)
        for (const std::uint32_t k : parts[l].onEdge) {
            const NodeIndex i = band.leaves[l].band.firstNode + k;
            if (std::abs(band.psi[i]) >= float(kFanEnd)) continue;
            nodes.push_back(i);
            band.forNeighbors(&BandLeaf::band, i, [&](NodeIndex j, int, int, int) {
                if (std::abs(band.psi[j]) < kBesideFan &&
                    dot(band.normal[i], band.normal[j]) >= Band::kOtherSheet)
                    nodes.push_back(j);
            });
        }
    return nodes;
}

}  // namespace

double defaultVoxelSize(const CloudDensity& density, PointBandKind kind) {
    return kind == PointBandKind::Fits ? density.spacing / 2 : density.spacing;
}

double defaultBandWidth(const CloudDensity& density, PointBandKind kind, double dx) {
    const double s = kind == PointBandKind::Balls ? density.spacing99 / dx : 0;
    return std::sqrt(3 + s * s);
}

BandBounds bandBounds(const PointSurface& surface, PointBandKind kind, double dx) {
    const std::size_t n = surface.points().size();
    const double lower = defaultBandWidth(surface.density(), kind, dx);
    std::vector<Vec3d> points(n), normals(n);
    std::size_t bent = 0;
    for (std::size_t i = 0; i < n; ++i) {
        points[i] = surface.points()[i], normals[i] = surface.normal(i);
        bent += surface.curvature(i) * lower * dx > 1;
    }
    const MedialRadii radii = medialRadii(points, normals);
    const double reach = MedialRadii::quantile(radii.facing, 0.01) / dx;
    BandBounds b = bandBounds(surface.density().largestCurvature * dx, reach, kInfinity, lower);
    const double folded = MedialRadii::shareBelow(radii.facing, lower * dx);
    b.unresolvedShare = std::min(double(bent) / double(n) + folded, 1.0);
    return b;
}

Band bandFromPoints(const PointSurface& surface, PointBandKind kind, double dx, double h,
                    Progress& progress) {
    requireRange(surface, kind, dx, h);
    const Filler filler(surface, kind, dx, h);
    const std::vector<Ijk> origins = filler.candidates();
    std::vector<LeafPart> parts(origins.size());
    for (std::size_t l = 0; l < parts.size(); ++l) parts[l].leaf.origin = origins[l];
    Steps steps(progress, "band", parts.size());
    parallelFor(parts.size(), 4, progress, [&](std::size_t begin, std::size_t end) {
        PointsAround around(surface.points());
        Filler::Feet feet(512);
        for (std::size_t l = begin; l < end; ++l) filler.fill(parts[l], around, feet);
        steps.add(end - begin);
    });
    parts.erase(std::remove_if(parts.begin(), parts.end(),
                               [](const LeafPart& part) { return part.psi.empty(); }),
                parts.end());

    Band band;
    band.transform.dx = dx;
    band.h = h;
    for (const LeafPart& part : parts) band.leaves.push_back(part.leaf);
    band.buildTopology();
    parallelFor(parts.size(), 32, [&](std::size_t begin, std::size_t end) {
        for (std::size_t l = begin; l < end; ++l) {
            const auto first = std::ptrdiff_t(band.leaves[l].band.firstNode);
            std::copy(parts[l].psi.begin(), parts[l].psi.end(), band.psi.begin() + first);
            std::copy(parts[l].foot.begin(), parts[l].foot.end(), band.foot.begin() + first);
            std::copy(parts[l].normal.begin(), parts[l].normal.end(), band.normal.begin() + first);
        }
    });
    // Differences do not show kinks of this psi, so all nodes are tested.
    band.markFacing();
    band.numberCore(nodesAroundEdges(band, parts));
    return band;
}

}  // namespace igeo
