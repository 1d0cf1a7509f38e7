#include <igeo/march/seeds.h>

#include <igeo/base/error.h>
#include <igeo/base/parallel.h>

#include <algorithm>
#include <cmath>
#include <string>

namespace igeo {

namespace {

constexpr double kSegment = 0.5;  ///< length of a segment of a curve, voxels
/// Points found on S between two tests of cancellation.
constexpr std::size_t kLookEverySeeds = 64;
/// Voxels of a region, the same.
constexpr std::size_t kLookEveryVoxels = 1 << 14;

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

StraightLines::StraightLines(const std::vector<SurfacePoint>& seeds, double leastCost)
    : leastCost_(leastCost) {
    const std::vector<std::uint32_t> source = sourcesOf(seeds);
    for (std::size_t k = 0; k < seeds.size(); ++k) {
        const SurfacePoint& seed = seeds[k];
        if (source[k] < lines_.size())
            lines_.back().start = -kInfinity;
        else
            lines_.push_back({seed.pIndex, seed.segment, dot(seed.segment, seed.segment),
                              seed.rim || seed.node == kNoNode ? -kInfinity : seed.start});
    }
}

SeedsNear::SeedsNear(const std::vector<SurfacePoint>& seeds, double radius) {
    constexpr std::size_t kFew = 8;
    few_ = seeds.size();
    if (few_ <= kFew) return;
    double longest = 0;
    for (const SurfacePoint& s : seeds) longest = std::max(longest, length(s.segment));
    edge_ = std::max(radius, 1.0) + longest;
    cells_.reserve(seeds.size());
    for (std::size_t k = 0; k < seeds.size(); ++k)
        cells_.emplace_back(keyOf(cellOf(seeds[k].pIndex)), k);
    std::sort(cells_.begin(), cells_.end());
}

namespace {

/// The points of a curve, projected to S.
std::vector<Vec3d> cornersOnSurface(const Band& band, const Curve& curve, double snap,
                                    const Progress& progress) {
    std::vector<Vec3d> corners;
    for (std::size_t k = 0; k < curve.points.size(); ++k) {
        if (k % kLookEverySeeds == 0) progress.throwIfCancelled();
        const SurfacePoint p = nearestSurfacePoint(band, curve.points[k]);
        if (!(p.snapDistance <= snap))
            throw Error(Error::Kind::InvalidArgument,
                        "point " + std::to_string(k) + " of a curve is " +
                            std::to_string(p.snapDistance) + " voxels from the surface, " +
                            std::to_string(snap) + " are allowed",
                        "move it there or raise maxSnap");
        corners.push_back(p.pIndex);
    }
    return corners;
}

/// The seeds of a curve, point by point.
class CurveSeeds {
public:
    CurveSeeds(const Band& band, double start, const Progress& progress)
        : band_(band), start_(start), progress_(progress) {}

    /// Adds the point of S nearest to p, and the segment to it from the last point.
    /// @return false where that segment is too long: snapping changes the distance of neighbors,
    ///         but does not move them to another sheet
    bool add(const Vec3d& p) {
        constexpr double kFar = 4 * kSegment;
        if (seeds.size() % kLookEverySeeds == 0) progress_.throwIfCancelled();
        SurfacePoint next = nearestSurfacePoint(band_, p);
        if (!seeds.empty()) {
            SurfacePoint& last = seeds.back();
            last.segment = next.pIndex - last.pIndex;
            if (length(last.segment) > kFar) return false;
            if (band_.triangles) takeTriangles(*band_.triangles, last, next);
        }
        seeds.push_back(next);
        seeds.back().start = start_;
        seeds.back().joined = seeds.size() > 1;
        return true;
    }
    /// Adds points up to b in steps of half a voxel.
    /// @return false where S does not follow the line from a to b, two points of S
    bool addLine(const Vec3d& a, const Vec3d& b) {
        // No path on S of this length has so few nodes around it.
        if (length(b - a) > 2 * double(band_.size())) return false;
        const auto steps = std::max(1, int(std::ceil(length(b - a) / kSegment)));
        for (int s = 1; s <= steps; ++s)
            if (!add(a + (double(s) / steps) * (b - a))) return false;
        return true;
    }

    std::vector<SurfacePoint> seeds;

private:
    const Band& band_;
    double start_;
    const Progress& progress_;
};

}  // namespace

std::vector<SurfacePoint> seedsAlong(const Band& band, const Curve& curve, double snap,
                                     Progress& progress) {
    using Kind = Error::Kind;
    if (curve.points.empty()) throw Error(Kind::InvalidArgument, "a curve has no points");
    const std::size_t n = curve.points.size();
    const std::vector<Vec3d> corners = cornersOnSurface(band, curve, snap, progress);
    const std::size_t lines = curve.closed && n > 2 ? n : n - 1;
    CurveSeeds found(band, curve.start, progress);
    found.add(corners[0]);
    // From points of S, so that the number of steps is limited by the width of the surface.
    for (std::size_t k = 0; k < lines; ++k)
        if (!found.addLine(corners[k], corners[(k + 1) % n]))
            throw Error(Kind::InvalidArgument,
                        "between points " + std::to_string(k) + " and " +
                            std::to_string((k + 1) % n) + " a curve leaves the surface",
                        "give more points along the surface there");
    // The end of a closed curve repeats its start.
    if (lines == n) found.seeds.pop_back();
    return std::move(found.seeds);
}

std::vector<std::uint8_t> nodesInside(const Band& band, const Obstacles& region,
                                      Progress& progress) {
    std::vector<std::uint8_t> in(band.size());
    parallelFor(band.size(), 1024, progress, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const Vec3d p = band.footPoint(NodeIndex(i));
            in[i] = region.contains(p, Vec3d(band.normal[i]));
        }
    });
    return in;
}

namespace {

/// The point of S where the segment between two foot points, inside and outside of a region, leaves
/// the region; by bisection.
SurfacePoint rimPoint(const Band& band, const Obstacles& region, NodeIndex inside,
                      NodeIndex outside) {
    const Vec3d normal(band.normal[inside]), in = band.footPoint(inside);
    const Vec3d segment = band.footPoint(outside) - in;
    double low = 0, high = 1;
    for (int round = 0; round < 10; ++round) {
        const double t = (low + high) / 2;
        Vec3d p = in + t * segment;
        // Regions of triangles hold points of them alone.
        if (band.triangles) projectToSurface(band, p, normal);
        (region.block(p, p, normal) ? low : high) = t;
    }
    // On a mesh the other end may be beyond a gap.
    SurfacePoint s;
    s.pIndex = in + (band.triangles ? low : (low + high) / 2) * segment;
    projectToSurface(band, s.pIndex, band.triangles ? normal : Vec3d{});
    s.askedIndex = s.pIndex;
    s.node = inside;
    s.rim = true;
    return s;
}

/// Seeds along the lines of a region.
std::vector<SurfacePoint> seedsOnLines(const Band& band, const Obstacles& region,
                                       const Progress& progress) {
    std::vector<SurfacePoint> seeds;
    region.forLines([&](const Obstacles::Line& line) {
        CurveSeeds along(band, 0, progress);
        along.add(line.from);
        if (!along.addLine(line.from, line.to))
            throw Error(Error::Kind::InvalidArgument, "an edge of a region leaves the surface",
                        "use smaller voxels");
        seeds.insert(seeds.end(), along.seeds.begin(), along.seeds.end());
    });
    return seeds;
}

/// Whether one of some seeds is near to points.
class Cover {
public:
    /// @param within  voxels
    Cover(const std::vector<SurfacePoint>& seeds, double within)
        : seeds_(seeds), near_(seeds, within), within_(within) {}
    bool has(const Vec3d& p) const {
        bool is = false;
        near_.forNear(p,
                      [&](std::size_t k) { is |= length(seeds_[k].nearestTo(p) - p) < within_; });
        return is;
    }

private:
    const std::vector<SurfacePoint>& seeds_;
    const SeedsNear near_;
    const double within_;
};

/// Seeds of the voxels of a region that lie between the foot points and meet S, where no other seed
/// is near.
/// @param rim  the other seeds
std::vector<SurfacePoint> seedsBetween(const Band& band, const Obstacles& region,
                                       const std::vector<std::uint8_t>& inside,
                                       const std::vector<SurfacePoint>& rim,
                                       const Progress& progress) {
    constexpr double kReach = 1.5;  // voxels: how far a voxel that meets S is from it
    // A point of the region with foot points outside around it is so near to the rim.
    constexpr double kToRim = 1.25;
    const Cover cover(rim, kToRim);
    std::vector<SurfacePoint> seeds;
    // Whether the foot point of the core that is nearest to a point of S lies inside.
    auto isNextToInside = [&](const Vec3d& p, NodeIndex around) {
        double least = kInfinity;
        bool is = false;
        auto look = [&](NodeIndex j) {
            const double off = length(band.footPoint(j) - p);
            if (band.inCore(j) && off < least) least = off, is = inside[j];
        };
        look(around);
        band.forNeighbors(&BandLeaf::band, around, [&](NodeIndex j, int, int, int) { look(j); });
        return is;
    };
    std::size_t looked = 0;
    region.forVoxels([&](const Vec3d& center) {
        if (looked++ % kLookEveryVoxels == 0) progress.throwIfCancelled();
        const NodeIndex i = band.nodeAt(roundToIjk(center));
        if (i == kNoNode || std::abs(band.psi[i]) > kReach || (inside[i] && band.inCore(i))) return;
        const Vec3d normal(band.normal[i]);
        Vec3d p = center;
        if (!projectToSurface(band, p, normal)) p = band.footPoint(i);
        const NodeIndex there = band.nodeAt(roundToIjk(p));
        if (isNextToInside(p, there == kNoNode ? i : there) || cover.has(p) ||
            !region.block(p, p, normal))
            return;
        seeds.push_back(nearestSurfacePoint(band, p));
        seeds.back().rim = true;
    });
    return seeds;
}

}  // namespace

std::vector<SurfacePoint> seedsAround(const Band& band, const Obstacles& region,
                                      Progress& progress) {
    constexpr double kLink = 2;  // voxels: so near to a foot point is a rim that a link crosses
    const std::vector<std::uint8_t> inside = nodesInside(band, region, progress);
    const std::vector<SurfacePoint> lines = seedsOnLines(band, region, progress);
    const Cover cover(lines, kLink);
    std::vector<std::vector<SurfacePoint>> found(band.leaves.size());
    parallelFor(band.leaves.size(), 16, progress, [&](std::size_t begin, std::size_t end) {
        for (std::size_t l = begin; l < end; ++l) {
            const BandLeaf& leaf = band.leaves[l];
            band.forNodes(LeafIndex(l), [&](NodeIndex i, unsigned at) {
                if (leaf.core.node(at) == kNoNode || !inside[i] || cover.has(band.footPoint(i)))
                    return;
                const auto addTo = [&](NodeIndex j) {
                    if (!inside[j]) found[l].push_back(rimPoint(band, region, i, j));
                };
                band.forNeighbors(
                    &BandLeaf::core, LeafIndex(l), at, [&](NodeIndex, int dx, int dy, int dz) {
                        const NodeIndex j = band.neighbor(i, dx, dy, dz);
                        if (dot(band.normal[i], band.normal[j]) >= Band::kOtherSheet &&
                            !band.severed(i, j))
                            addTo(j);
                    });
                // Over gaps.
                if (band.joints > 0) band.forBridges(i, [&](const Bridge& b) { addTo(b.to); });
            });
        }
    });
    std::vector<SurfacePoint> seeds = lines;
    for (const auto& part : found) seeds.insert(seeds.end(), part.begin(), part.end());
    const std::vector<SurfacePoint> thin = seedsBetween(band, region, inside, seeds, progress);
    seeds.insert(seeds.end(), thin.begin(), thin.end());
    for (std::size_t k = 1; k < seeds.size(); ++k) seeds[k].joined = true;
    return seeds;
}

std::vector<SurfacePoint> seedWithin(const Band& band, const Obstacles& region,
                                     Progress& progress) {
    const std::vector<std::uint8_t> inside = nodesInside(band, region, progress);
    NodeIndex first = kNoNode;
    bool all = true;
    for (NodeIndex i = 0; i < band.size(); ++i)
        if (band.inCore(i)) {
            if (inside[i] && first == kNoNode) first = i;
            all &= inside[i] > 0;
        }
    if (first == kNoNode || all) return {};
    SurfacePoint s;
    s.pIndex = s.askedIndex = band.footPoint(first);
    s.node = first;
    s.rim = true;
    return {s};
}

}  // namespace igeo
