#include <igeo/surface/detail/mesh_ways.h>

#include <igeo/band/detail/mesh_fan.h>
#include <igeo/band/tangent_frame.h>
#include <igeo/base/parallel.h>
#include <igeo/surface/detail/open_sector.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <tuple>

namespace igeo {

namespace {

using Fan = MeshFan<MeshAdjacency>;
constexpr double kTurnAround = 2 * std::numbers::pi;

/// The core nodes by the triangles of their foot points.
class CoreOnTriangles {
public:
    explicit CoreOnTriangles(const MeshBand& on) : begin_(on.faceNormal.size() + 1) {
        auto forCore = [&](const auto& visit) {
            for (LeafIndex l = 0; l < on.band.leaves.size(); ++l)
                on.band.forNodes(l, [&](NodeIndex i, unsigned at) {
                    if (on.band.leaves[l].core.node(at) != kNoNode) visit(i);
                });
        };
        // Foot points at vertices belong to all triangles there.
        auto forTriangles = [&](NodeIndex i, const auto& visit) {
            if (on.voxel(i).feature >= 3) return visit(on.voxel(i).triangle);
            for (const std::uint32_t t : trianglesAt(on.adjacency, on.foot(i))) visit(t);
        };
        forCore([&](NodeIndex i) { forTriangles(i, [&](std::uint32_t t) { ++begin_[t + 1]; }); });
        for (std::size_t t = 1; t < begin_.size(); ++t) begin_[t] += begin_[t - 1];
        node_.resize(begin_.back());
        std::vector<std::size_t> next(begin_.begin(), begin_.end() - 1);
        forCore(
            [&](NodeIndex i) { forTriangles(i, [&](std::uint32_t t) { node_[next[t]++] = i; }); });
    }
    template <typename Visit>
    void forOn(std::uint32_t triangle, const Visit& visit) const {
        for (std::size_t k = begin_[triangle]; k < begin_[triangle + 1]; ++k) visit(node_[k]);
    }

private:
    std::vector<std::size_t> begin_;
    std::vector<NodeIndex> node_;
};

/// Calls visit(j, line) for the nodes to which straight lines of the fan lead.
template <typename Visit>
void forSeen(const MeshBand& on, const CoreOnTriangles& core, const Fan& fan, const Visit& visit) {
    WalkEnds line;
    for (std::size_t k = 0; k < fan.parts().size(); ++k)
        core.forOn(fan.parts()[k].triangle, [&](NodeIndex j) {
            if (fan.sees(k, on.foot(j).at, line)) visit(j, line);
        });
}

/// Adds the directions of the links and bridges of a node to a sector.
/// @param frame  of the node's normal
void addLinks(const MeshBand& on, MeshWalk& walk, NodeIndex i, const TangentFrame& frame,
              OpenSector& sector) {
    const Band& band = on.band;
    const std::uint32_t severed = band.severedSteps(i);
    const Vec3d foot = on.foot(i).at;
    auto add = [&](const Vec3f& v) { sector.add(frame.flat(v)); };
    band.forNeighbors(&BandLeaf::band, i, [&](NodeIndex j, int x, int y, int z) {
        if (severed & SeveredLinks::bit(x, y, z) || !band.inCore(j)) return;
        const Vec3f chord(foot - on.foot(j).at), &n = band.normal[j];
        if (onOneSheet(chord, band.normal[i], n, dot(band.normal[i], n))) add(-chord);
    });
    band.forBridges(i, [&](const Bridge& b) {
        const MeshPoint to = on.foot(b.to);
        if (!b.jump) return add(Vec3f(to.at - foot));
        const WalkEnds way = walk.ends(on.foot(i), to, 2 * MeshWays::kReach);
        if (way.length < kInfinity) add(Vec3f(way.out));
    });
}

/// The nearest of the nodes seen in each of 16 directions, two of each.
/// @param seenThere  all that are seen
std::vector<MeshWay> nearestAround(const MeshBand& on, const CoreOnTriangles& core, NodeIndex i,
                                   std::vector<NodeIndex>& seenThere) {
    constexpr std::size_t kDirections = 16, kMost = 2;
    const TangentFrame frame(on.band.normal[i]);
    std::vector<MeshWay> seen;
    forSeen(on, core, Fan(on.adjacency, on.foot(i), MeshWays::kReach),
            [&](NodeIndex j, const WalkEnds& line) {
                if (j != i) seen.push_back({i, j, line});
            });
    std::sort(seen.begin(), seen.end(), [](const MeshWay& a, const MeshWay& b) {
        return std::tie(a.line.length, a.to) < std::tie(b.line.length, b.to);
    });
    for (const MeshWay& way : seen) seenThere.push_back(way.to);
    std::array<std::size_t, kDirections> count{};
    std::vector<MeshWay> kept;
    for (const MeshWay& way : seen) {
        const Vec2f a = frame.flat(Vec3f(way.line.out));
        const double turn = std::atan2(double(a.y), double(a.x)) / kTurnAround + 0.5;
        std::size_t& here = count[std::size_t(turn * kDirections) % kDirections];
        if (here++ < kMost) kept.push_back(way);
    }
    return kept;
}

template <typename Find>
auto inParallel(std::size_t count, Progress& progress, const Find& find) {
    constexpr std::size_t kChunk = 32;
    std::vector<decltype(find(std::size_t(0)))> parts(count);
    parallelFor(count, kChunk, progress, [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) parts[k] = find(k);
    });
    return parts;
}

}  // namespace

std::vector<NodeIndex> openOnMesh(const MeshBand& on, Progress& progress) {
    constexpr double kOn = 3;        // voxels: farther off a mesh goes on behind its crease
    constexpr double kMargin = 0.5;  // radians
    const Band& band = on.band;
    std::vector<NodeIndex> some;
    for (LeafIndex l = 0; l < band.leaves.size(); ++l) {
        if (!on.folds[l]) continue;
        band.forNodes(l, [&](NodeIndex i, unsigned) {
            if (band.facing[i] & Band::kSevered && band.inCore(i)) some.push_back(i);
        });
    }
    const auto isOpen = inParallel(some.size(), progress, [&](std::size_t k) -> std::uint8_t {
        MeshWalk walk(on.adjacency);
        const TangentFrame frame(band.normal[some[k]]);
        OpenSector sector;
        addLinks(on, walk, some[k], frame, sector);
        if (!sector.find()) return 0;
        // Whether a straight line of this length leads into it.
        const Fan fan(on.adjacency, on.foot(some[k]), kOn);
        return fan.leads(
            [&](const Vec3d& out) { return sector.holds(frame.flat(Vec3f(out)), kMargin); });
    });
    std::vector<NodeIndex> open;
    for (std::size_t k = 0; k < some.size(); ++k)
        if (isOpen[k]) open.push_back(some[k]);
    return open;
}

std::vector<Link> inexactLinks(const MeshBand& on, const std::vector<NodeIndex>& open) {
    constexpr double kOff = 1.05, kRoom = 0.05;  // kRoom: voxels
    const Band& band = on.band;
    MeshWalk walk(on.adjacency);
    std::vector<Link> off;
    for (const NodeIndex i : open)
        band.forNeighbors(&BandLeaf::band, i, [&](NodeIndex j, int, int, int) {
            if (band.severed(i, j) || !band.inCore(j)) return;
            const Vec3f chord(on.foot(i).at - on.foot(j).at);
            const double most = kOff * flatLength(band, i, chord, j) + kRoom;
            if (!(walk.tightLength(on.foot(i), on.foot(j), 1.25 * most) <= most))
                off.emplace_back(i, j);
        });
    return off;
}

MeshWays waysOnMesh(const MeshBand& on, const std::vector<NodeIndex>& open, Progress& progress) {
    MeshWays all;
    if (open.empty()) return all;
    const CoreOnTriangles core(on);
    struct Around {
        std::vector<MeshWay> ways;
        std::vector<NodeIndex> seen;
    };
    const auto parts = inParallel(open.size(), progress, [&](std::size_t k) {
        Around around;
        around.ways = nearestAround(on, core, open[k], around.seen);
        return around;
    });
    std::vector<NodeIndex> seen(open);
    for (const Around& part : parts) {
        for (const MeshWay& way : part.ways) {
            all.ways.push_back(way);
            all.ways.push_back({way.to, way.from, way.line.reversed()});
        }
        seen.insert(seen.end(), part.seen.begin(), part.seen.end());
    }
    std::sort(seen.begin(), seen.end());
    seen.erase(std::unique(seen.begin(), seen.end()), seen.end());
    auto key = [](const MeshWay& w) { return std::tie(w.to, w.from, w.line.length); };
    std::sort(all.ways.begin(), all.ways.end(),
              [&](const MeshWay& a, const MeshWay& b) { return key(a) < key(b); });
    all.ways.erase(std::unique(all.ways.begin(), all.ways.end(),
                               [](const MeshWay& a, const MeshWay& b) {
                                   return a.from == b.from && a.to == b.to;
                               }),
                   all.ways.end());
    for (const NodeIndex i : seen)
        for (const std::uint32_t t : trianglesAt(on.adjacency, on.foot(i)))
            all.ofTriangle.emplace_back(t, i);
    std::sort(all.ofTriangle.begin(), all.ofTriangle.end());
    return all;
}

}  // namespace igeo
