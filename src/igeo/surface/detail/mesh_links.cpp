#include <igeo/surface/detail/mesh_links.h>

#include <igeo/band/tangent_frame.h>
#include <igeo/base/detail/disjoint_sets.h>
#include <igeo/base/parallel.h>
#include <igeo/surface/detail/open_sector.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>
#include <unordered_map>

namespace igeo {

namespace {

/// The triangles around a leaf, grouped by sheets: parts connected within them.
class LeafSheets {
public:
    LeafSheets(const MeshBand& on, const std::vector<std::uint32_t>& triangles)
        : triangles_(triangles), sheets_(triangles.size()), uneven_(triangles.size()) {
        for (std::uint32_t a = 0; a < triangles.size(); ++a)
            for (std::size_t k = 0; k < 3; ++k) {
                if (!on.adjacency.isPlain(triangles[a], k)) continue;
                on.adjacency.forBeyond(triangles[a], k, [&](std::uint32_t u) {
                    if (const std::uint32_t b = indexOf(u); b != kNone) sheets_.join(a, b);
                });
            }
        for (std::uint32_t a = 0; a < triangles.size(); ++a) {
            isOne_ &= sheets_.first(a) == 0;
            for (std::size_t k = 0; k < 3; ++k)
                if (!on.adjacency.isPlain(triangles[a], k)) uneven_[sheets_.first(a)] = true;
        }
        findUneven(on.faceNormal);
    }
    /// Whether all are one sheet, nearly a plane and without a boundary: distances along it are
    /// hardly longer than in space.
    bool isOneEvenSheet() const { return isOne_ && !uneven_[0]; }
    static constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
    /// The even sheet of a triangle, or kNone.
    std::uint32_t evenSheetOf(std::uint32_t t) {
        const std::uint32_t a = indexOf(t);
        if (a == kNone) return kNone;
        const std::uint32_t sheet = sheets_.first(a);
        return uneven_[sheet] ? kNone : sheet;
    }

private:
    static constexpr double kEven = 0.57;  ///< 55 degrees, as the faces at the corner of a box

    /// Finds sheets with normals farther than kEven from the middle of two that are far apart.
    void findUneven(const std::vector<Vec3d>& faceNormal) {
        std::vector<Vec3d> first(triangles_.size()), second(first);
        // Degenerate triangles have no normal.
        auto forNormals = [&](const auto& visit) {
            for (std::uint32_t a = 0; a < triangles_.size(); ++a)
                if (const Vec3d& n = faceNormal[triangles_[a]]; n != Vec3d{})
                    visit(sheets_.first(a), n);
        };
        auto farthest = [](const Vec3d& from, const Vec3d& n, Vec3d& soFar) {
            if (soFar == Vec3d{} || dot(from, n) < dot(from, soFar)) soFar = n;
        };
        std::vector<Vec3d> any(first);
        forNormals([&](std::uint32_t sheet, const Vec3d& n) { any[sheet] = n; });
        forNormals([&](std::uint32_t s, const Vec3d& n) { farthest(any[s], n, first[s]); });
        forNormals([&](std::uint32_t s, const Vec3d& n) { farthest(first[s], n, second[s]); });
        for (std::uint32_t s = 0; s < any.size(); ++s) any[s] = normalized(first[s] + second[s]);
        forNormals([&](std::uint32_t s, const Vec3d& n) {
            if (dot(any[s], n) < kEven) uneven_[s] = true;
        });
    }

    std::uint32_t indexOf(std::uint32_t t) const {
        const auto at = std::lower_bound(triangles_.begin(), triangles_.end(), t);
        return at != triangles_.end() && *at == t ? std::uint32_t(at - triangles_.begin()) : kNone;
    }

    const std::vector<std::uint32_t>& triangles_;  ///< sorted
    DisjointSets sheets_;
    std::vector<bool> uneven_;  ///< per sheet, at its first triangle
    bool isOne_ = true;
};

/// From the foot point of node j to that of node i.
Vec3f chordOf(const Band& band, NodeIndex i, NodeIndex j) {
    return band.footOf(i) - band.footOf(j) - Vec3f(band.ijk(j) - band.ijk(i));
}

/// The same, not less than that in space.
double arcOf(const Band& band, NodeIndex i, const Vec3f& chord, NodeIndex j) {
    return std::max(flatLength(band, i, chord, j), double(length(chord)));
}

/// The longest walk that a link with this arc may represent.
double longestFor(double arc) { return 1.25 * arc + 0.25; }

/// Whether three or more triangles meet in an edge in a leaf or one beside it.
bool pagesMeetNear(const MeshBand& on, LeafIndex l) {
    auto meetIn = [&](LeafIndex m) {
        if (m == kNoLeaf) return false;
        const auto& triangles = on.leaves[m].triangles;
        return std::any_of(triangles.begin(), triangles.end(), [&](std::uint32_t t) {
            return on.adjacency.isMany(t, 0) || on.adjacency.isMany(t, 1) ||
                   on.adjacency.isMany(t, 2);
        });
    };
    const auto& beside = on.band.leaves[l].neighbor;
    return meetIn(l) || std::any_of(beside.begin(), beside.end(), meetIn);
}

/// The links of one leaf's nodes to nodes of larger numbers.
class LinksOfLeaf {
public:
    LinksOfLeaf(const MeshBand& on, LeafIndex l, MeshWalk& walk, std::vector<Link>& off)
        : on_(on), nodes_(on.band.leaves[l].band), walk_(walk), off_(off) {
        LeafSheets sheets(on, on.leaves[l].triangles);
        if (sheets.isOneEvenSheet()) return;
        pages_ = pagesMeetNear(on, l);
        for (const NearVoxel& v : on.leaves[l].voxels)
            sheetOf_.push_back(sheets.evenSheetOf(v.triangle));
        const auto first = on.band.facing.begin() + nodes_.firstNode;
        // Where no core node has a sheet facing it, no node has.
        if (std::all_of(first, first + nodes_.count, [](std::uint8_t f) { return f == 0; })) {
            find(sheets, /*coreOnly=*/true);
            if (off_.empty()) return;
            off_.clear();
        }
        find(sheets, /*coreOnly=*/false);
    }

private:
    void find(LeafSheets& sheets, bool coreOnly) {
        const NodeIndex end = nodes_.firstNode + nodes_.count;
        for (NodeIndex i = nodes_.firstNode; i < end; ++i) {
            const bool isCore = on_.band.inCore(i);
            const std::uint32_t sheet = sheetOf_[i - nodes_.firstNode];
            auto visit = [&](NodeIndex j) {
                // A node of the next leaf may have a sheet facing it.
                if (j < i || (coreOnly && !(isCore && on_.band.inCore(j)) && !on_.band.facing[j]))
                    return;
                if (sheet == LeafSheets::kNone ||
                    sheet != (j < end ? sheetOf_[j - nodes_.firstNode]
                                      : sheets.evenSheetOf(on_.voxel(j).triangle)))
                    test(i, j);
            };
            on_.band.forNeighbors(&BandLeaf::band, i,
                                  [&](NodeIndex j, int, int, int) { visit(j); });
        }
    }
    void test(NodeIndex i, NodeIndex j) {
        const Band& band = on_.band;
        const MeshPoint from = on_.foot(i), to = on_.foot(j);
        if (from.triangle == to.triangle) return;
        // Pairs that normals separate are severed too, so that no link leads around (Band::joined).
        if (dot(band.normal[i], band.normal[j]) < Band::kOtherSheet || !joins(i, j, from, to))
            off_.emplace_back(i, j);
    }
    bool joins(NodeIndex i, NodeIndex j, const MeshPoint& from, const MeshPoint& to) {
        const double most = longestFor(arcOf(on_.band, i, chordOf(on_.band, i, j), j));
        if (!pages_) return walk_.length(from, to, most) < kInfinity;
        // Over an edge of three pages normals may end up on the other side: no chart holds both.
        const WalkEnds way = walk_.ends(from, to, most);
        return way.length < kInfinity && !way.mirrored;
    }

    const MeshBand& on_;
    const LeafNodes& nodes_;
    MeshWalk& walk_;
    std::vector<Link>& off_;
    bool pages_ = false;                  ///< pagesMeetNear
    std::vector<std::uint32_t> sheetOf_;  ///< per node of the leaf: LeafSheets::evenSheetOf
};

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
    constexpr double kNear = 2, kSlant = 4, kLonger = 1.1;
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
                     length = walk_.length(from, on_.foot(j), kLonger * chord);
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

double flatLength(const Band& band, NodeIndex i, const Vec3f& chord, NodeIndex j) {
    const TangentFrame frame(band.normal[i], band.faceted);
    return double(length(frame.unfold(chord, band.normal[j], dot(band.normal[i], band.normal[j]))));
}

std::vector<std::uint8_t> leavesThatFold(const MeshAdjacency& adjacency,
                                         const std::vector<Vec3d>& faceNormal,
                                         const std::vector<NearLeaf>& leaves, Progress& progress) {
    std::vector<std::uint8_t> folds(leaves.size());
    auto foldsAt = [&](std::uint32_t t) {
        bool any = false;
        for (std::size_t k = 0; k < 3; ++k)
            adjacency.forBeyond(t, k, [&](std::uint32_t u) {
                any |= dot(faceNormal[t], faceNormal[u]) < double(Band::kOtherSheet);
            });
        return any;
    };
    parallelFor(leaves.size(), 16, progress, [&](std::size_t begin, std::size_t end) {
        for (std::size_t l = begin; l < end; ++l) {
            const auto& triangles = leaves[l].triangles;
            folds[l] = std::any_of(triangles.begin(), triangles.end(), foldsAt);
        }
    });
    return folds;
}

std::vector<Link> linksOffMesh(const MeshBand& on, Progress& progress) {
    std::vector<std::vector<Link>> parts(on.leaves.size());
    parallelFor(on.leaves.size(), 16, progress, [&](std::size_t begin, std::size_t end) {
        MeshWalk walk(on.adjacency);
        for (std::size_t l = begin; l < end; ++l) LinksOfLeaf(on, LeafIndex(l), walk, parts[l]);
    });
    std::vector<Link> off;
    for (const auto& part : parts) off.insert(off.end(), part.begin(), part.end());
    return off;
}

std::vector<StretchedLink> stretchedOnMesh(const MeshBand& on, Progress& progress) {
    constexpr float kBend = 0.985f, kRise = 0.1f;
    constexpr double kSame = 0.002, kShort = 1e-3;
    const Band& band = on.band;
    std::vector<std::vector<StretchedLink>> parts(band.leaves.size());
    auto isOnBend = [&](NodeIndex i) {
        return dot(Vec3d(band.normal[i]), on.faceNormal[on.voxel(i).triangle]) < double(kBend);
    };
    auto measure = [&](NodeIndex i, NodeIndex j, const Ijk& step, bool mayFold, MeshWalk& walk,
                       std::vector<StretchedLink>& found) {
        const float cosine = dot(band.normal[i], band.normal[j]);
        if (cosine < Band::kOtherSheet) return;
        const Vec3f chord = chordOf(band, i, j);
        if (!mayFold && cosine > kBend && std::abs(dot(band.normal[i], chord)) < kRise &&
            std::abs(dot(band.normal[j], chord)) < kRise && !isOnBend(i) && !isOnBend(j))
            return;
        const double along =
            walk.tightLength(on.foot(i), on.foot(j), longestFor(arcOf(band, i, chord, j)));
        if (!(along < kInfinity)) return;
        auto add = [&](NodeIndex from, const Ijk& by, double flat) {
            const double stretch =
                std::clamp(along / flat, StretchedLink::kLeast, StretchedLink::kMost);
            if (flat > kShort && std::abs(stretch - 1) > kSame)
                found.emplace_back(from, by.x, by.y, by.z, stretch);
        };
        add(i, step, flatLength(band, i, chord, j));
        add(j, -step, flatLength(band, j, -chord, i));
    };
    parallelFor(band.leaves.size(), 16, progress, [&](std::size_t begin, std::size_t end) {
        MeshWalk walk(on.adjacency);
        for (std::size_t l = begin; l < end; ++l) {
            // Folds narrower than a voxel lie between nodes with normals alike.
            const bool mayFold = on.folds[l];
            band.forNodes(LeafIndex(l), [&](NodeIndex i, unsigned) {
                if (!band.inCore(i)) return;
                band.forNeighbors(&BandLeaf::band, i, [&](NodeIndex j, int x, int y, int z) {
                    if (j > i && band.inCore(j) && !band.severed(i, j))
                        measure(i, j, {x, y, z}, mayFold, walk, parts[l]);
                });
            });
        }
    });
    std::vector<StretchedLink> all;
    for (const auto& part : parts) all.insert(all.end(), part.begin(), part.end());
    return all;
}

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
