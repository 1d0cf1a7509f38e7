#include <igeo/surface/detail/mesh_ways.h>

#include <igeo/band/detail/mesh_fan.h>
#include <igeo/band/detail/open_sector.h>
#include <igeo/band/tangent_frame.h>
#include <igeo/base/parallel.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <tuple>
#include <unordered_set>

namespace igeo {

namespace {

using Fan = MeshFan<MeshAdjacency>;

/// The core nodes; those with foot points at vertices are on all triangles there.
NodesOnTriangles coreOnTriangles(const MeshBand& on) {
    NodesOnTriangles core;
    for (NodeIndex i = 0; i < on.band.size(); ++i) {
        if (!on.band.inCore(i)) continue;
        if (on.voxel(i).feature >= 3)
            core.all.emplace_back(on.voxel(i).triangle, i);
        else
            for (const std::uint32_t t : trianglesAt(on.adjacency, on.foot(i)))
                core.all.emplace_back(t, i);
    }
    std::sort(core.all.begin(), core.all.end());
    return core;
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

/// Whether the mesh folds within voxels beside a node. Others are open at rims alone.
bool isBesideFold(const MeshBand& on, NodeIndex i) {
    return on.bends[on.band.leafOf(i)] == LeafBend::Fold;
}

/// The nodes that lines from a node lead to.
struct Around {
    /// Straight ones to the two nearest in each of 16 directions, and all that go around vertices,
    /// as these have few directions.
    std::vector<MeshWay> chosen;
    std::vector<NodeIndex> seen;  ///< all
};
Around lookAround(const MeshBand& on, const NodesOnTriangles& core, NodeIndex i) {
    constexpr std::size_t kDirections = 16, kMost = 2;
    const TangentFrame frame(on.band.normal[i]);
    std::vector<MeshWay> seen;
    const bool atRim = !isBesideFold(on, i);
    const Fan fan(on.adjacency, on.foot(i), atRim ? MeshWays::kRimReach : MeshWays::kReach,
                  AtVertex::GoAround);
    WalkEnds line;
    for (std::size_t k = 0; k < fan.parts().size(); ++k)
        core.forOn(fan.parts()[k].triangle, [&](NodeIndex j) {
            if (j != i && fan.sees(k, on.foot(j).at, line)) seen.push_back({i, j, line, atRim});
        });
    std::sort(seen.begin(), seen.end(), [](const MeshWay& a, const MeshWay& b) {
        return std::tie(a.line.length, a.to) < std::tie(b.line.length, b.to);
    });
    Around around;
    std::array<std::size_t, kDirections> count{};
    std::unordered_set<NodeIndex> nearer;
    for (const MeshWay& way : seen) {
        around.seen.push_back(way.to);
        const bool isFirst = nearer.insert(way.to).second;
        if (!way.line.straight) {
            if (isFirst) around.chosen.push_back(way);
            continue;
        }
        const Vec2f a = frame.flat(Vec3f(way.line.out));
        const double turn = std::atan2(double(a.y), double(a.x)) / (2 * std::numbers::pi) + 0.5;
        std::size_t& here = count[std::size_t(turn * kDirections) % kDirections];
        if (here++ < kMost) around.chosen.push_back(way);
    }
    return around;
}

/// A vertex with more than a full turn of faces, or half a turn at a boundary.
struct Saddle {
    Vec3d at;
    double more;  ///< radians
};
/// Those around a leaf.
std::vector<Saddle> saddlesAround(const MeshBand& on, LeafIndex l) {
    std::vector<std::pair<std::uint32_t, double>> angles;  // per vertex and face
    const MeshAdjacency& mesh = on.adjacency;
    for (const std::uint32_t t : on.leaves[l].triangles)
        for (std::size_t k = 0; k < 3; ++k) {
            // Half a turn at a boundary, where two edges end.
            if (mesh.isBoundary(t, k)) {
                angles.emplace_back(mesh[t][k], std::numbers::pi / 2);
                angles.emplace_back(mesh[t][(k + 1) % 3], std::numbers::pi / 2);
            }
            const Vec3d& p = mesh.corner(t, k);
            angles.emplace_back(mesh[t][k],
                                angleBetween(mesh.corner(t, k + 1) - p, mesh.corner(t, k + 2) - p));
        }
    std::sort(angles.begin(), angles.end());
    std::vector<Saddle> saddles;
    for (std::size_t k = 0; k < angles.size();) {
        const std::uint32_t vertex = angles[k].first;
        double more = -2 * std::numbers::pi;
        for (; k < angles.size() && angles[k].first == vertex; ++k) more += angles[k].second;
        if (more > 0) saddles.push_back({mesh.mesh().points[vertex], more});
    }
    return saddles;
}

/// Whether a front bends within a voxel or two of a point by more than links can follow.
bool isAtNeck(const std::vector<Saddle>& saddles, const Vec3d& p) {
    constexpr double kNear = 1.7, kMost = 1;  // voxels, radians
    double more = 0;
    for (const Saddle& saddle : saddles)
        if (length(saddle.at - p) < kNear) more += saddle.more;
    return more > kMost;
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
    std::vector<NodeIndex> some, atNecks;
    for (LeafIndex l = 0; l < band.leaves.size(); ++l) {
        const bool folds = on.bends[l] == LeafBend::Fold;
        if (!folds && !hasRim(on, l)) continue;
        const std::vector<Saddle> saddles = saddlesAround(on, l);
        band.forNodes(l, [&](NodeIndex i, unsigned) {
            if (!band.inCore(i)) return;
            if (isAtNeck(saddles, on.foot(i).at))
                atNecks.push_back(i);
            else if (folds && band.facing[i] & Band::kSevered)
                some.push_back(i);
        });
    }
    auto open = inParallel(some.size(), progress, [&](std::size_t k) -> NodeIndex {
        MeshWalk walk(on.adjacency);
        const TangentFrame frame(band.normal[some[k]]);
        OpenSector sector;
        addLinks(on, walk, some[k], frame, sector);
        if (!sector.find()) return kNoNode;
        // Whether a straight line of this length leads into it.
        const Fan fan(on.adjacency, on.foot(some[k]), kOn);
        const bool leads = fan.leads(
            [&](const Vec3d& out) { return sector.holds(frame.flat(Vec3f(out)), kMargin); });
        return leads ? some[k] : kNoNode;
    });
    std::erase(open, kNoNode);
    open.insert(open.end(), atNecks.begin(), atNecks.end());
    std::sort(open.begin(), open.end());
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
    const NodesOnTriangles core = coreOnTriangles(on);
    const auto parts = inParallel(open.size(), progress,
                                  [&](std::size_t k) { return lookAround(on, core, open[k]); });
    std::vector<NodeIndex> seen(open);
    for (const Around& part : parts) {
        for (const MeshWay& way : part.chosen) {
            all.ways.push_back(way);
            all.ways.push_back({way.to, way.from, way.line.reversed(), way.atRim});
        }
        seen.insert(seen.end(), part.seen.begin(), part.seen.end());
    }
    std::sort(seen.begin(), seen.end());
    seen.erase(std::unique(seen.begin(), seen.end()), seen.end());
    auto key = [](const MeshWay& w) { return std::tie(w.to, w.from, w.atRim, w.line.length); };
    std::sort(all.ways.begin(), all.ways.end(),
              [&](const MeshWay& a, const MeshWay& b) { return key(a) < key(b); });
    all.ways.erase(std::unique(all.ways.begin(), all.ways.end(),
                               [](const MeshWay& a, const MeshWay& b) {
                                   return a.from == b.from && a.to == b.to;
                               }),
                   all.ways.end());
    for (const NodeIndex i : seen)
        for (const std::uint32_t t : trianglesAt(on.adjacency, on.foot(i)))
            all.nodes.all.emplace_back(t, i);
    std::sort(all.nodes.all.begin(), all.nodes.all.end());
    return all;
}

}  // namespace igeo
