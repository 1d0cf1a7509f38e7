#include <igeo/march/seeds.h>

#include <igeo/base/error.h>
#include <igeo/base/parallel.h>

#include <algorithm>
#include <cmath>
#include <string>

namespace igeo {

namespace {

constexpr double kPiece = 0.5;  ///< length of a piece of a curve, voxels

}  // namespace

std::vector<std::uint32_t> sourcesOf(const std::vector<SurfacePoint>& seeds) {
    std::vector<std::uint32_t> source;
    std::uint32_t count = 0;
    for (const SurfacePoint& s : seeds) {
        if (!s.joined || source.empty()) ++count;
        source.push_back(count - 1);
    }
    return source;
}

SeedsNear::SeedsNear(const std::vector<SurfacePoint>& seeds, double radius) {
    constexpr std::size_t kFew = 8;
    few_ = seeds.size();
    if (few_ <= kFew) return;
    double longest = 0;
    for (const SurfacePoint& s : seeds) longest = std::max(longest, length(s.piece));
    edge_ = std::max(radius, 1.0) + longest;
    cells_.reserve(seeds.size());
    for (std::size_t k = 0; k < seeds.size(); ++k)
        cells_.emplace_back(keyOf(cellOf(seeds[k].pIndex)), k);
    std::sort(cells_.begin(), cells_.end());
}

std::vector<SurfacePoint> seedsAlong(const Band& band, const Curve& curve, double snap) {
    using Kind = Error::Kind;
    if (curve.points.empty()) throw Error(Kind::InvalidArgument, "a curve has no points");
    const std::size_t n = curve.points.size();
    std::vector<SurfacePoint> seeds;
    auto add = [&](const SurfacePoint& p) {
        // Snapping moves neighbors together and apart, but not to another sheet.
        constexpr double kFar = 4 * kPiece;
        if (!seeds.empty()) {
            SurfacePoint& last = seeds.back();
            last.piece = p.pIndex - last.pIndex;
            if (length(last.piece) > kFar) return false;
        }
        seeds.push_back(p);
        seeds.back().start = curve.start;
        seeds.back().joined = seeds.size() > 1;
        return true;
    };
    std::vector<Vec3d> corners;
    for (std::size_t k = 0; k < n; ++k) {
        const SurfacePoint p = nearestSurfacePoint(band, curve.points[k]);
        if (!(p.snapDistance <= snap))
            throw Error(Kind::InvalidArgument,
                        "point " + std::to_string(k) + " of a curve is " +
                            std::to_string(p.snapDistance) + " voxels from the surface, " +
                            std::to_string(snap) + " are allowed",
                        "move it there or raise --snap");
        corners.push_back(p.pIndex);
    }
    const std::size_t stretches = curve.closed && n > 2 ? n : n - 1;
    add(nearestSurfacePoint(band, corners[0]));
    for (std::size_t k = 0; k < stretches; ++k) {
        // Between points of S, so that there are no more steps than the surface is wide.
        const Vec3d &a = corners[k], &b = corners[(k + 1) % n];
        auto staysOnSurface = [&] {
            // No way of so many voxels runs over fewer nodes.
            if (length(b - a) > 2 * double(band.size())) return false;
            const auto steps = std::max(1, int(std::ceil(length(b - a) / kPiece)));
            for (int s = 1; s <= steps; ++s)
                if (!add(nearestSurfacePoint(band, a + (double(s) / steps) * (b - a))))
                    return false;
            return true;
        };
        if (!staysOnSurface())
            throw Error(Kind::InvalidArgument,
                        "between points " + std::to_string(k) + " and " +
                            std::to_string((k + 1) % n) + " a curve leaves the surface",
                        "give more points along the surface there");
    }
    // Back where it began.
    if (stretches == n) seeds.pop_back();
    return seeds;
}

std::vector<std::uint8_t> nodesInside(const Band& band, const Obstacles& region) {
    std::vector<std::uint8_t> in(band.size());
    parallelFor(band.size(), 1024, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const Vec3d p = band.footPoint(NodeIndex(i));
            in[i] = region.mayBeNear(p, 1) && region.block(p, p, Vec3d(band.normal[i]));
        }
    });
    return in;
}

std::vector<SurfacePoint> seedsAround(const Band& band, const Obstacles& region) {
    const std::vector<std::uint8_t> inside = nodesInside(band, region);
    std::vector<std::vector<SurfacePoint>> found(band.leaves.size());
    parallelFor(band.leaves.size(), 16, [&](std::size_t begin, std::size_t end) {
        for (std::size_t l = begin; l < end; ++l) {
            const BandLeaf& leaf = band.leaves[l];
            for (NodeIndex i = leaf.band.first; i < leaf.band.first + leaf.band.count; ++i) {
                const unsigned at = band.offset[i];
                if (leaf.core.node(at) == kNoNode || !inside[i]) continue;
                const Vec3d normal(band.normal[i]), in = band.footPoint(i);
                band.forNeighbors(
                    &BandLeaf::core, LeafIndex(l), at, [&](NodeIndex, int dx, int dy, int dz) {
                        const NodeIndex j = band.neighbor(i, dx, dy, dz);
                        if (dot(band.normal[i], band.normal[j]) < Band::kOtherSheet || inside[j])
                            return;
                        const Vec3d way = band.footPoint(j) - in;
                        double low = 0, high = 1;
                        for (int round = 0; round < 10; ++round) {
                            const double t = (low + high) / 2;
                            const Vec3d p = in + t * way;
                            (region.block(p, p, normal) ? low : high) = t;
                        }
                        SurfacePoint s;
                        s.pIndex = in + (low + high) / 2 * way;
                        projectToSurface(band, s.pIndex);
                        s.askedIndex = s.pIndex;
                        s.node = i;
                        s.rim = true;
                        found[l].push_back(s);
                    });
            }
        }
    });
    std::vector<SurfacePoint> seeds;
    for (const auto& part : found)
        for (const SurfacePoint& s : part) {
            seeds.push_back(s);
            seeds.back().joined = seeds.size() > 1;
        }
    return seeds;
}

}  // namespace igeo
