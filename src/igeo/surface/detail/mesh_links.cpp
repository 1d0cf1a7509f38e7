#include <igeo/surface/detail/mesh_links.h>

#include <igeo/band/tangent_frame.h>
#include <igeo/base/detail/disjoint_sets.h>
#include <igeo/base/parallel.h>

#include <algorithm>
#include <cmath>
#include <numeric>

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

/// The links of one leaf's nodes to nodes of larger numbers.
class LinksOfLeaf {
public:
    /// @param beside  only links beside severed ones are tested, not those of the core; else links
    ///                of the core come first, and where no sheet faces another and the mesh has all
    ///                of these, no others
    LinksOfLeaf(const MeshBand& on, LeafIndex l, MeshWalk& walk, bool beside,
                std::vector<Link>& off)
        : on_(on), nodes_(on.band.leaves[l].band), walk_(walk), beside_(beside), off_(off) {
        LeafSheets sheets(on, on.leaves[l].triangles);
        if (sheets.isOneEvenSheet()) return;
        pages_ = pagesMeetNear(on, l);
        for (const NearVoxel& v : on.leaves[l].voxels)
            sheetOf_.push_back(sheets.evenSheetOf(v.triangle));
        const auto first = on.band.facing.begin() + nodes_.firstNode;
        // Where no core node has a sheet facing it, no node has.
        if (!beside && std::all_of(first, first + nodes_.count, [](auto f) { return f == 0; })) {
            find(sheets, /*coreOnly=*/true);
            if (off_.empty()) return;
            off_.clear();
        }
        find(sheets, /*coreOnly=*/false);
    }

private:
    bool isBeside(NodeIndex i) const { return on_.band.facing[i] & Band::kBesideSevered; }
    void find(LeafSheets& sheets, bool coreOnly) {
        const NodeIndex end = nodes_.firstNode + nodes_.count;
        for (NodeIndex i = nodes_.firstNode; i < end; ++i) {
            if (beside_ && !isBeside(i)) continue;
            const bool isCore = on_.band.inCore(i);
            const std::uint32_t sheet = sheetOf_[i - nodes_.firstNode];
            on_.band.forNeighbors(&BandLeaf::band, i, [&](NodeIndex j, int, int, int) {
                // A node of the next leaf may have a sheet facing it.
                if (j < i || (beside_ && (!isBeside(j) || (isCore && on_.band.inCore(j)))) ||
                    (coreOnly && !(isCore && on_.band.inCore(j)) && !on_.band.facing[j]))
                    return;
                if (sheet == LeafSheets::kNone ||
                    sheet != (j < end ? sheetOf_[j - nodes_.firstNode]
                                      : sheets.evenSheetOf(on_.voxel(j).triangle)))
                    test(i, j);
            });
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
    const bool beside_;
    std::vector<Link>& off_;
    bool pages_ = false;                  ///< pagesMeetNear
    std::vector<std::uint32_t> sheetOf_;  ///< per node of the leaf: LeafSheets::evenSheetOf
};

/// Whether a triangle in a leaf or beside it has an edge of some kind.
/// @param isKind(t, k)  whether edge k of triangle t is
template <typename IsKind>
bool hasEdge(const MeshBand& on, std::size_t l, const IsKind& isKind) {
    const auto& triangles = on.leaves[l].triangles;
    return std::any_of(triangles.begin(), triangles.end(), [&](std::uint32_t t) {
        return isKind(t, 0) || isKind(t, 1) || isKind(t, 2);
    });
}

/// SeveredLinks::bit of the voxels in the box that a step spans.
std::uint32_t boxOf(const Ijk& step) {
    std::uint32_t box = 0;
    for (const int x : {0, step.x})
        for (const int y : {0, step.y})
            for (const int z : {0, step.z}) box |= SeveredLinks::bit(x, y, z);
    return box;
}

}  // namespace

bool hasRim(const MeshBand& on, LeafIndex l) {
    return hasEdge(on, l,
                   [&](std::uint32_t t, std::size_t k) { return on.adjacency.isBoundary(t, k); });
}

Vec3f chordOf(const Band& band, NodeIndex i, NodeIndex j) {
    return band.footOf(i) - band.footOf(j) - Vec3f(band.ijk(j) - band.ijk(i));
}

double arcOf(const Band& band, NodeIndex i, const Vec3f& chord, NodeIndex j) {
    return std::max(flatLength(band, i, chord, j), double(length(chord)));
}

bool pagesMeetNear(const MeshBand& on, LeafIndex l) {
    auto meetIn = [&](LeafIndex m) {
        return m != kNoLeaf && hasEdge(on, m, [&](std::uint32_t t, std::size_t k) {
                   return on.adjacency.isMany(t, k);
               });
    };
    const auto& beside = on.band.leaves[l].neighbor;
    return meetIn(l) || std::any_of(beside.begin(), beside.end(), meetIn);
}

double flatLength(const Band& band, NodeIndex i, const Vec3f& chord, NodeIndex j) {
    const TangentFrame frame(band.normal[i], band.faceted);
    return double(length(frame.unfold(chord, band.normal[j], dot(band.normal[i], band.normal[j]))));
}

std::vector<LeafBend> bendsOf(const MeshAdjacency& adjacency, const std::vector<Vec3d>& faceNormal,
                              const std::vector<NearLeaf>& leaves, Progress& progress) {
    constexpr double kAlike = 0.8;
    std::vector<LeafBend> bends(leaves.size());
    auto bendAt = [&](std::uint32_t t) {
        LeafBend most = LeafBend::Slight;
        for (std::size_t k = 0; k < 3; ++k)
            adjacency.forBeyond(t, k, [&](std::uint32_t u) {
                const double cosine = dot(faceNormal[t], faceNormal[u]);
                if (cosine < kAlike) most = std::max(most, LeafBend::Sharp);
                if (cosine < double(Band::kOtherSheet)) most = LeafBend::Fold;
            });
        return most;
    };
    parallelFor(leaves.size(), 16, progress, [&](std::size_t begin, std::size_t end) {
        for (std::size_t l = begin; l < end; ++l)
            for (const std::uint32_t t : leaves[l].triangles)
                if (bends[l] != LeafBend::Fold) bends[l] = std::max(bends[l], bendAt(t));
    });
    return bends;
}

void severOffMesh(const MeshBand& on, Band& band, Progress& progress) {
    std::vector<std::vector<Link>> parts(on.leaves.size());
    auto severIn = [&](const std::vector<LeafIndex>& leaves, bool beside) {
        parallelFor(leaves.size(), 16, progress, [&](std::size_t begin, std::size_t end) {
            MeshWalk walk(on.adjacency);
            for (std::size_t k = begin; k < end; ++k)
                LinksOfLeaf(on, leaves[k], walk, beside, parts[leaves[k]]);
        });
        std::vector<Link> off;
        for (const LeafIndex l : leaves) off.insert(off.end(), parts[l].begin(), parts[l].end());
        band.sever(off);
    };
    std::vector<LeafIndex> leaves(on.leaves.size());
    std::iota(leaves.begin(), leaves.end(), LeafIndex(0));
    severIn(leaves, /*beside=*/false);
    // In leaves beside these the mesh may lack links of nodes outside the core alone.
    auto isOff = [&](LeafIndex l) { return l != kNoLeaf && !parts[l].empty(); };
    std::erase_if(leaves, [&](LeafIndex l) {
        const auto& around = band.leaves[l].neighbor;
        return isOff(l) || std::none_of(around.begin(), around.end(), isOff);
    });
    severIn(leaves, /*beside=*/true);
}

namespace {

/// The stretched links of one leaf's core nodes to nodes of larger numbers.
class StretchedOfLeaf {
public:
    StretchedOfLeaf(const MeshBand& on, LeafIndex l, MeshWalk& walk,
                    std::vector<StretchedLink>& found)
        : on_(on),
          band_(on.band),
          walk_(walk),
          // Folds narrower than a voxel lie between nodes with normals alike, and so do holes.
          mayLeaveAnywhere_(on.bends[l] == LeafBend::Fold || hasRim(on, l)),
          mayLeave_(on.bends[l] == LeafBend::Sharp),
          found_(found) {
        band_.forNodes(l, [&](NodeIndex i, unsigned offset) {
            if (band_.leaves[l].core.node(offset) != kNoNode) find(i, l, offset);
        });
    }

private:
    static constexpr float kBend = 0.985f;

    void find(NodeIndex i, LeafIndex l, unsigned offset) {
        constexpr float kAside = 0.1f;
        // The voxels around i that lie over the plane of its foot point.
        std::uint32_t over = SeveredLinks::bit(0, 0, 0);
        const Vec3f& n = band_.normal[i];
        links_.clear();
        band_.forNeighbors(&BandLeaf::band, l, offset, [&](NodeIndex j, int x, int y, int z) {
            if (j > i) links_.emplace_back(j, Ijk{x, y, z});
            if (!mayLeave_) return;
            const Vec3f aside = band_.footOf(j) + band_.psi[j] * n;
            if (dot(n, band_.normal[j]) > kBend && dot(aside, aside) < kAside * kAside)
                over |= SeveredLinks::bit(x, y, z);
        });
        const std::uint32_t severed = band_.severedSteps(i);
        for (const auto& [j, step] : links_) {
            const auto& [x, y, z] = step;
            if (!band_.inCore(j) || severed & SeveredLinks::bit(x, y, z)) continue;
            // In a plane, a link may cut the corner of a wall on it or below.
            const std::uint32_t box = boxOf(step);
            measure(i, j, step, mayLeaveAnywhere_ || (mayLeave_ && (over & box) != box));
        }
    }
    bool isOnBend(NodeIndex i) const {
        return dot(Vec3d(band_.normal[i]), on_.faceNormal[on_.voxel(i).triangle]) < double(kBend);
    }
    /// @param mayLeave  the mesh, though it looks flat at both nodes
    void measure(NodeIndex i, NodeIndex j, const Ijk& step, bool mayLeave) {
        constexpr float kRise = 0.1f;
        const float cosine = dot(band_.normal[i], band_.normal[j]);
        if (cosine < Band::kOtherSheet) return;
        const Vec3f chord = chordOf(band_, i, j);
        if (!mayLeave && cosine > kBend && std::abs(dot(band_.normal[i], chord)) < kRise &&
            std::abs(dot(band_.normal[j], chord)) < kRise && !isOnBend(i) && !isOnBend(j))
            return;
        // Around a vertex with more than a full turn of faces, two of which lie in one plane, a
        // link that severOffMesh need not test may stand for a longer walk.
        const double along =
            walk_.tightLength(on_.foot(i), on_.foot(j), 2 * longestFor(arcOf(band_, i, chord, j)));
        if (!(along < kInfinity)) return;
        add(i, step, along, flatLength(band_, i, chord, j));
        add(j, -step, along, flatLength(band_, j, -chord, i));
    }
    void add(NodeIndex from, const Ijk& by, double along, double flat) {
        constexpr double kSame = 0.002, kShort = 1e-3;
        const double stretch =
            std::clamp(along / flat, StretchedLink::kLeast, StretchedLink::kMost);
        if (flat > kShort && std::abs(stretch - 1) > kSame)
            found_.emplace_back(from, by.x, by.y, by.z, stretch);
    }

    const MeshBand& on_;
    const Band& band_;
    MeshWalk& walk_;
    const bool mayLeaveAnywhere_, mayLeave_;
    std::vector<std::pair<NodeIndex, Ijk>> links_;  ///< of one node
    std::vector<StretchedLink>& found_;
};

}  // namespace

std::vector<StretchedLink> stretchedOnMesh(const MeshBand& on, Progress& progress) {
    std::vector<std::vector<StretchedLink>> parts(on.band.leaves.size());
    parallelFor(parts.size(), 16, progress, [&](std::size_t begin, std::size_t end) {
        MeshWalk walk(on.adjacency);
        for (std::size_t l = begin; l < end; ++l) StretchedOfLeaf(on, LeafIndex(l), walk, parts[l]);
    });
    std::vector<StretchedLink> all;
    for (const auto& part : parts) all.insert(all.end(), part.begin(), part.end());
    return all;
}

}  // namespace igeo
