#include <igeo/surface/detail/mesh_bridges.h>

#include <igeo/band/detail/open_sector.h>
#include <igeo/band/tangent_frame.h>
#include <igeo/base/detail/disjoint_sets.h>
#include <igeo/base/parallel.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>
#include <unordered_map>

namespace igeo {

namespace {

/// Collects the core nodes linked to a core node, sorted, and adds their directions to a sector.
/// @param counts(j)  whether the direction of a node counts
template <typename Counts>
void collectLinks(const Band& band, NodeIndex i, std::vector<NodeIndex>& linked, OpenSector* sector,
                  const Counts& counts) {
    linked.clear();
    const std::uint32_t severed = band.severedSteps(i);
    const TangentFrame frame(band.normal[i]);
    band.forNeighbors(&BandLeaf::band, i, [&](NodeIndex j, int x, int y, int z) {
        if (severed & SeveredLinks::bit(x, y, z) || !band.inCore(j)) return;
        const Vec3f chord = chordOf(band, i, j), &n = band.normal[j];
        if (!onOneSheet(chord, band.normal[i], n, dot(band.normal[i], n))) return;
        linked.push_back(j);
        if (sector && counts(j)) sector->add(frame.flat(-chord));
    });
    std::sort(linked.begin(), linked.end());
}
void collectLinks(const Band& band, NodeIndex i, std::vector<NodeIndex>& linked) {
    collectLinks(band, i, linked, nullptr, [](NodeIndex) { return true; });
}

/// Finds bridges for nodes whose links leave a sector open.
class Bridges {
public:
    explicit Bridges(const MeshBand& on) : on_(on), band_(on.band), walk_(on.adjacency) {}
    /// Adds the bridges from a core node.
    /// @param pages  whether an edge of three or more triangles is near: sheets that meet there at
    ///               small angles have no nodes for some voxels, and all of them are joined
    void find(NodeIndex i, bool pages, MeshBridges& all);

private:
    /// Adds jumps to the spine from a node with no others of its page in between.
    void findSpine(NodeIndex i, MeshBridges& all);

    static constexpr double kBeside = 0.3;     ///< closer to a link, a bridge leads the same way
    static constexpr std::size_t kMost = 4;    ///< per node, and of each page
    static constexpr double kOnePage = 0.997;  ///< cosine of normals of faces

    const Vec3d& faceOf(NodeIndex i) const { return on_.faceNormal[on_.voxel(i).triangle]; }
    bool onOnePage(NodeIndex i, NodeIndex j) const {
        return std::abs(dot(faceOf(i), faceOf(j))) > kOnePage;
    }
    bool inOpenSector(const Vec2f& direction) const { return sector_.holds(direction, kBeside); }
    bool haveLinkInCommon(NodeIndex j);
    /// The length of the walk to j, if a bridge is needed; +infinity otherwise.
    double lengthTo(NodeIndex i, NodeIndex j, Bridge& bridge);
    /// The same near an edge of three or more triangles.
    double lengthOverPages(NodeIndex i, NodeIndex j, Bridge& bridge);

    const MeshBand& on_;
    const Band& band_;
    MeshWalk walk_;
    std::vector<NodeIndex> linked_, linkedThere_;
    OpenSector sector_;
};

bool Bridges::haveLinkInCommon(NodeIndex j) {
    collectLinks(band_, j, linkedThere_);
    return std::any_of(linkedThere_.begin(), linkedThere_.end(), [&](NodeIndex k) {
        return std::binary_search(linked_.begin(), linked_.end(), k);
    });
}

double Bridges::lengthTo(NodeIndex i, NodeIndex j, Bridge& bridge) {
    // With opposite normals, at the tip of a thin plate, gradients cannot be transported.
    constexpr float kHeadOn = -0.95f;
    constexpr double kLongest = 6, kShort = 1e-3;
    if (std::binary_search(linked_.begin(), linked_.end(), j)) return kInfinity;
    const Vec3f chord = chordOf(band_, i, j);
    const bool jump = dot(band_.normal[i], band_.normal[j]) < kHeadOn;
    if (!jump && !inOpenSector(TangentFrame(band_.normal[i]).flat(-chord))) return kInfinity;
    const double arc = jump ? double(igeo::length(chord)) : arcOf(band_, i, chord, j);
    const double most = std::min(2 * arc + 1, kLongest);
    const double length = walk_.length(on_.foot(i), on_.foot(j), most);
    if (!(length < kInfinity) || haveLinkInCommon(j)) return kInfinity;
    // Around the end of a slit a front does not continue straight.
    const bool bent = length > longestFor(arc);
    const double flat = jump || bent ? double(igeo::length(chord)) : arc;
    bridge = {i, j, float(std::max(1.0, length / std::max(flat, kShort))), jump || bent};
    return length;
}

double Bridges::lengthOverPages(NodeIndex i, NodeIndex j, Bridge& bridge) {
    constexpr double kLongest = 12, kShort = 1e-3;
    if (std::binary_search(linked_.begin(), linked_.end(), j)) return kInfinity;
    const WalkEnds way = walk_.ends(on_.foot(i), on_.foot(j), kLongest);
    if (!(way.length < kInfinity) ||
        !inOpenSector(TangentFrame(band_.normal[i]).flat(Vec3f(way.out))) ||
        (onOnePage(i, j) && haveLinkInCommon(j)))
        return kInfinity;
    const double chord = double(igeo::length(chordOf(band_, i, j)));
    bridge = {i, j, float(std::max(1.0, way.length / std::max(chord, kShort))), true};
    return way.length;
}

void Bridges::find(NodeIndex i, bool pages, MeshBridges& all) {
    sector_.clear();
    collectLinks(band_, i, linked_, &sector_,
                 [&](NodeIndex j) { return !pages || onOnePage(i, j); });
    if (!sector_.find()) return;
    std::vector<std::pair<double, Bridge>> found;
    band_.forBox(&BandLeaf::band, i, {}, 3, [&](NodeIndex j, const Ijk&) {
        if (j == i || !band_.inCore(j)) return;
        Bridge bridge;
        const double length = pages ? lengthOverPages(i, j, bridge) : lengthTo(i, j, bridge);
        if (length < kInfinity) found.emplace_back(length, bridge);
    });
    std::sort(found.begin(), found.end(), [](const auto& a, const auto& b) {
        return std::pair(a.first, a.second.to) < std::pair(b.first, b.second.to);
    });
    std::vector<Bridge> own;
    for (const auto& each : found) {
        const Bridge& bridge = each.second;
        const auto onPage = std::count_if(own.begin(), own.end(), [&](const Bridge& other) {
            return !pages || onOnePage(other.to, bridge.to);
        });
        if (std::size_t(onPage) < kMost) own.push_back(bridge);
    }
    all.bridges.insert(all.bridges.end(), own.begin(), own.end());
    findSpine(i, all);
}

void Bridges::findSpine(NodeIndex i, MeshBridges& all) {
    // Nearer nodes are in the box. Fronts that pass the edge at up to 75 degrees come straight.
    constexpr double kNear = 2, kSlant = 4;
    const MeshPoint from = on_.foot(i);
    const TangentFrame frame(band_.normal[i]);
    const std::vector<NodeIndex> spine = band_.spineNear(from.at);
    bool isOpen = false;
    for (const NodeIndex j : spine) {
        const Vec3d chord = on_.foot(j).at - from.at;
        if (igeo::length(chord) < kNear) return;
        isOpen |= inOpenSector(frame.flat(Vec3f(chord)));
    }
    if (!isOpen) return;
    std::vector<std::pair<double, Bridge>> found;
    double nearest = kInfinity;
    for (const NodeIndex j : spine) {
        const double chord = igeo::length(on_.foot(j).at - from.at),
                     length = walk_.length(from, on_.foot(j), kBeforeTight * chord);
        if (!(length < kInfinity)) continue;
        nearest = std::min(nearest, length);
        found.emplace_back(length, Bridge{i, j, float(std::max(1.0, length / chord)), true});
    }
    for (const auto& [length, bridge] : found)
        if (length <= kSlant * nearest) {
            all.bridges.push_back(bridge);
            all.spine.insert(all.spine.end(), {i, bridge.to});
        }
}

}  // namespace

double shareCutOff(const MeshBand& on) {
    const Band& band = on.band;
    if (std::none_of(band.facing.begin(), band.facing.end(),
                     [](std::uint8_t f) { return f & Band::kSevered; }))
        return 0;
    DisjointSets parts(band.coreSize());
    std::vector<NodeIndex> linked;
    auto forCore = [&](const auto& visit) {
        for (NodeIndex i = 0; i < band.size(); ++i)
            if (const NodeIndex c = band.coreNode(i); c != kNoNode) visit(i, c);
    };
    forCore([&](NodeIndex i, NodeIndex c) {
        if (!band.facing[i]) {
            band.forNeighbors(&BandLeaf::core, i, [&](NodeIndex j, int, int, int) {
                if (j < c) parts.join(c, j);
            });
            return;
        }
        collectLinks(band, i, linked);
        for (const NodeIndex j : linked) parts.join(c, band.coreNode(j));
        band.forBridges(i, [&](const Bridge& b) { parts.join(c, band.coreNode(b.to)); });
    });
    std::vector<NodeIndex> sizeOf(band.coreSize()), largest(on.adjacency.components());
    forCore([&](NodeIndex i, NodeIndex c) {
        const NodeIndex size = ++sizeOf[parts.first(c)];
        NodeIndex& most = largest[on.adjacency.componentOf(on.voxel(i).triangle)];
        most = std::max(most, size);
    });
    const std::size_t held = std::accumulate(largest.begin(), largest.end(), std::size_t(0));
    return 1 - double(held) / double(band.coreSize());
}

std::vector<NodeIndex> spineOfMesh(const MeshBand& on) {
    constexpr double kOnEdge = 1, kApart = 0.7;  // voxels
    const MeshAdjacency& mesh = on.adjacency;
    std::vector<std::vector<NodeIndex>> parts(on.leaves.size());
    parallelFor(on.leaves.size(), 16, [&](std::size_t begin, std::size_t end) {
        for (std::size_t l = begin; l < end; ++l) {
            std::vector<std::pair<std::uint32_t, std::size_t>> edges;
            for (const std::uint32_t t : on.leaves[l].triangles)
                for (std::size_t k = 0; k < 3; ++k)
                    if (mesh.isMany(t, k)) edges.emplace_back(t, k);
            if (edges.empty()) continue;
            std::vector<std::pair<double, NodeIndex>> beside;
            on.band.forNodes(LeafIndex(l), [&](NodeIndex i, unsigned) {
                if (!on.band.inCore(i)) return;
                double nearest = kOnEdge;
                for (const auto& [t, k] : edges)
                    nearest = std::min(nearest, distanceToSegment(on.foot(i).at, mesh.corner(t, k),
                                                                  mesh.corner(t, k + 1)));
                if (nearest < kOnEdge) beside.emplace_back(nearest, i);
            });
            std::sort(beside.begin(), beside.end());
            for (const auto& [distance, node] : beside) {
                const Vec3d at = on.foot(node).at;
                if (std::none_of(parts[l].begin(), parts[l].end(),
                                 [&](NodeIndex j) { return length(at - on.foot(j).at) < kApart; }))
                    parts[l].push_back(node);
            }
        }
    });
    std::vector<NodeIndex> spine;
    for (const auto& part : parts) spine.insert(spine.end(), part.begin(), part.end());
    std::sort(spine.begin(), spine.end());
    return spine;
}

std::vector<Bridge> thinned(std::vector<Bridge> bridges) {
    constexpr std::uint16_t kMostPerNode = 16, kMostJumps = 1024;  // a march stores no jumps
    for (Bridge& b : bridges)
        if (b.to < b.from) std::swap(b.from, b.to);
    std::sort(bridges.begin(), bridges.end(), [](const Bridge& a, const Bridge& b) {
        return std::tie(a.from, a.to, a.stretch) < std::tie(b.from, b.to, b.stretch);
    });
    std::unordered_map<NodeIndex, std::uint16_t> count;
    std::vector<Bridge> kept;
    for (const Bridge& b : bridges) {
        if (!kept.empty() && kept.back().from == b.from && kept.back().to == b.to) continue;
        std::uint16_t &from = count[b.from], &to = count[b.to];
        if (std::max(from, to) >= (b.jump ? kMostJumps : kMostPerNode)) continue;
        ++from, ++to;
        kept.push_back(b);
    }
    return kept;
}

MeshBridges bridgesOnMesh(const MeshBand& on, Progress& progress) {
    const Band& band = on.band;
    std::vector<MeshBridges> parts(band.leaves.size());
    parallelFor(band.leaves.size(), 16, progress, [&](std::size_t begin, std::size_t end) {
        Bridges bridges(on);
        for (std::size_t l = begin; l < end; ++l) {
            const bool pages = pagesMeetNear(on, LeafIndex(l));
            const LeafNodes& nodes = band.leaves[l].band;
            for (NodeIndex i = nodes.firstNode; i < nodes.firstNode + nodes.count; ++i)
                if (band.facing[i] && band.inCore(i)) bridges.find(i, pages, parts[l]);
        }
    });
    MeshBridges all;
    for (const MeshBridges& part : parts) {
        all.bridges.insert(all.bridges.end(), part.bridges.begin(), part.bridges.end());
        all.spine.insert(all.spine.end(), part.spine.begin(), part.spine.end());
    }
    all.bridges = thinned(std::move(all.bridges));
    std::sort(all.spine.begin(), all.spine.end());
    all.spine.erase(std::unique(all.spine.begin(), all.spine.end()), all.spine.end());
    return all;
}

}  // namespace igeo
