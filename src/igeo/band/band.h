/// The band Omega_h = {|psi| < h}: all that a marching scheme or a tracer knows of a surface.
///
/// Where a band comes from (a level set, a mesh, points) is the business of the file that fills it;
/// level_set_band.h is one. All lengths are in voxels, all positions in index space (types.h).
#pragma once

#include <igeo/band/band_leaf.h>
#include <igeo/band/severed_links.h>
#include <igeo/band/surface_triangles.h>
#include <igeo/base/types.h>

#include <bit>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

namespace igeo {

struct MeshWays;

/// Whether two foot points, `chord` apart, lie on sheets one on top of the other with normals
/// alike, as open surfaces have them: neighbors on one sheet are never a voxel apart along both
/// normals.
inline bool stacked(const Vec3f& chord, const Vec3f& a, const Vec3f& b) {
    const float alongA = dot(a, chord), alongB = dot(b, chord);
    return std::min(alongA, alongB) > 1 || std::max(alongA, alongB) < -1;
}

/// Whether two foot points, `chord` apart, lie on either side of a gap or a plate rather than of a
/// crease: both normals along the chord, and the chord longer than between neighbors on one sheet
/// (sqrt(3), and a bit). In gaps of about two voxels psi bends normals away from each other, and
/// Band::kOtherSheet alone does not tell.
inline bool acrossGap(const Vec3f& chord, const Vec3f& a, const Vec3f& b) {
    constexpr float kFar2 = 3.2f, kAlong2 = 0.25f;
    const float c2 = dot(chord, chord), alongA = dot(a, chord), alongB = dot(b, chord);
    return c2 > kFar2 && alongA * alongB < 0 &&
           std::min(alongA * alongA, alongB * alongB) > kAlong2 * c2;
}

/// Cosine of normals that oppose: beyond a right angle, which an honest crease has.
constexpr float kOppositeNormals = -0.2f;

/// Whether two neighbors, their foot points `chord` apart, may be on one sheet, by their normals.
/// @param cosine  a . b
inline bool onOneSheet(const Vec3f& chord, const Vec3f& a, const Vec3f& b, float cosine) {
    return cosine >= kOppositeNormals && !stacked(chord, a, b) &&
           !(cosine < 0.5f && acrossGap(chord, a, b));
}

/// The band in flat arrays. Nodes are numbered leaf by leaf, by offset within the leaf, so the
/// numbering depends on the topology alone. 19 bytes per node, 12 more where foot points are
/// stored, 4 more on a mesh, and about 5 for the leaves.
///
/// The core is the thinnest part of the band that is still closed: the nearer end of every lattice
/// edge that S crosses along the axis its normal is closest to. For a plane these are the voxels
/// with |psi| <= max(|n_x|, |n_y|, |n_z|) / 2, one per lattice column, so that neighbors of the
/// core are neighbors along S (26 steps); about a quarter of a band of h = sqrt(3).
///
/// M&S (14) keeps h below W, the distance at which two sheets of the surface meet, so that a front
/// never jumps from one to the other. Real surfaces have places where no grid affords that
/// (grooves, thin walls); there `linked` cuts the band along the medial axis instead.
struct Band {
    Similarity transform;  ///< world from index; transform.dx is the voxel size
    double h = 0;          ///< half the band's thickness, voxels
    /// S is a polyhedron with faces about as wide as voxels or wider, and normals are those of the
    /// faces: between two of them a path runs over both planes, however small the angle, where it
    /// would follow an arc on a smooth surface.
    bool faceted = false;
    /// Pairs of components of a mesh that bridges over gaps join (bandFromMesh).
    std::size_t joints = 0;
    /// The share of the core that no link joins with the rest of its component of a mesh.
    double cutOff = 0;
    /// S itself, where the band was made from a mesh; null elsewhere.
    std::shared_ptr<const SurfaceTriangles> triangles;
    /// Where three or more pages of a mesh share an edge at small angles, some have no nodes for
    /// voxels. Jumps lead from the edge to the first nodes of such a page. Core nodes at both ends
    /// of them, ascending.
    std::vector<NodeIndex> spine;
    /// Straight lines over the triangles of a mesh where sheets cross or fold within a voxel; null
    /// where there are none.
    std::shared_ptr<const MeshWays> ways;

    std::vector<BandLeaf> leaves;
    std::vector<float> psi;     ///< per node: signed distance, voxels; |psi| < h
    std::vector<Vec3f> foot;    ///< per node: footOf; empty: -psi times the normal, as psi says
    std::vector<Vec3f> normal;  ///< per node: unit normal at the foot point, along grad psi
    std::vector<std::uint32_t> triangle;  ///< per node of a mesh: that of its foot point; or empty

    /// Per node, bits: kFacing where a neighbor lies on a sheet that faces it, kSevered where links
    /// are severed, kBesideSevered there and at all neighbors of such nodes (and beyond:
    /// markBesideSevered), kBridged at the ends of bridges, kStretched at those of stretched links,
    /// kKink where psi of a level set has a kink, kHasWays at the ends of straight lines.
    std::vector<std::uint8_t> facing;
    static constexpr std::uint8_t kFacing = 1, kSevered = 2, kBesideSevered = 4, kBridged = 8,
                                  kStretched = 16, kKink = 32, kHasWays = 64;

    std::size_t size() const { return psi.size(); }

    /// Where a node is.
    struct Place {
        LeafIndex leaf;
        unsigned offset;  ///< in the leaf
    };
    Place placeOf(NodeIndex i) const { return {leafOf(i), offset_[i]}; }
    LeafIndex leafOf(NodeIndex i) const {
        LeafIndex l = leafOfBlock_[i / kBlock];
        while (i - leaves[l].band.firstNode >= leaves[l].band.count) ++l;
        return l;
    }
    /// Calls visit(i, offset) for the nodes of a leaf, in their order.
    template <typename Visit>
    void forNodes(LeafIndex l, const Visit& visit) const {
        const LeafNodes& nodes = leaves[l].band;
        NodeIndex i = nodes.firstNode;
        for (unsigned x = 0; x < 8; ++x)
            for (std::uint64_t bits = nodes.mask[x]; bits; bits &= bits - 1, ++i)
                visit(i, x << 6 | unsigned(std::countr_zero(bits)));
    }

    Ijk ijk(NodeIndex i) const {
        const auto [l, o] = placeOf(i);
        return leaves[l].origin +
               Ijk{std::int32_t(o >> 6), std::int32_t(o >> 3 & 7), std::int32_t(o & 7)};
    }
    /// The foot point on S, relative to the voxel.
    Vec3f footOf(NodeIndex i) const { return foot.empty() ? -psi[i] * normal[i] : foot[i]; }
    Vec3d footPoint(NodeIndex i) const { return Vec3d(ijk(i)) + Vec3d(footOf(i)); }
    /// The same on the triangles of a mesh.
    SurfaceTriangles::Place footPlace(NodeIndex i) const { return {triangle[i], footPoint(i), 0}; }

    /// The node at step (dx, dy, dz) from node i, or kNoNode. O(1); fastest within 8 voxels.
    NodeIndex neighbor(NodeIndex i, int dx, int dy, int dz) const {
        const Place at = placeOf(i);
        return neighbor(&BandLeaf::band, at.leaf, at.offset, {dx, dy, dz});
    }
    /// The same from the voxel at an offset of leaf l.
    /// @param nodes  &BandLeaf::band, or &BandLeaf::core for the core's numbers
    NodeIndex neighbor(LeafNodes BandLeaf::*nodes, LeafIndex l, unsigned at,
                       const Ijk& step) const {
        const int x = int(at >> 6) + step.x, y = int(at >> 3 & 7) + step.y,
                  z = int(at & 7) + step.z;
        if ((x | y | z) & ~7) {
            l = leafBeside(l, x >> 3, y >> 3, z >> 3);
            if (l == kNoLeaf) return kNoNode;
        }
        return (leaves[l].*nodes).node(offsetOf(x, y, z));
    }

    /// The node at a voxel, or kNoNode. One hash look-up.
    NodeIndex nodeAt(const Ijk& ijk) const {
        const LeafIndex l = leafAt(ijk);
        if (l == kNoLeaf) return kNoNode;
        return leaves[l].band.node(offsetOf(ijk.x, ijk.y, ijk.z));
    }
    /// Offset of a voxel in its leaf.
    static unsigned offsetOf(int x, int y, int z) {
        return unsigned((x & 7) << 6 | (y & 7) << 3 | (z & 7));
    }
    NodeIndex neighbor(NodeIndex i, const Ijk& step) const {
        return neighbor(i, step.x, step.y, step.z);
    }
    /// The step across face 0 to 5 of a voxel: -x, +x, -y, +y, -z, +z.
    static Ijk faceStep(int face) {
        Ijk step{};
        step[face / 2] = face % 2 ? 1 : -1;
        return step;
    }

    /// Calls visit(j, dx, dy, dz) for the nodes j within one voxel of a voxel in every axis (itself
    /// left out), in the order of the steps. Faster than 26 calls of neighbor().
    /// @param nodes  &BandLeaf::band, or &BandLeaf::core for the core's numbers
    /// @param l, at  leaf and offset of the voxel
    template <typename Visit>
    void forNeighbors(LeafNodes BandLeaf::*nodes, LeafIndex l, unsigned at,
                      const Visit& visit) const;
    template <typename Visit>
    void forNeighbors(LeafNodes BandLeaf::*nodes, NodeIndex i, const Visit& visit) const {
        const Place at = placeOf(i);
        forNeighbors(nodes, at.leaf, at.offset, visit);
    }

    /// Calls visit(j, corner) for the nodes j among the 8 voxels at low + {0, 1}^3, corner (a, b,
    /// c) numbered 4 a + 2 b + c, in that order.
    /// @param low  relative to the voxel at an offset of leaf l
    template <typename Visit>
    void forCorners(LeafNodes BandLeaf::*nodes, LeafIndex l, unsigned at, const Ijk& low,
                    const Visit& visit) const;
    template <typename Visit>
    void forCorners(LeafNodes BandLeaf::*nodes, NodeIndex i, const Ijk& low,
                    const Visit& visit) const {
        const Place at = placeOf(i);
        forCorners(nodes, at.leaf, at.offset, low, visit);
    }

    /// Calls visit(j, weight, from) for the nodes j at the corners around the foot point of node i:
    /// trilinear weight, corners that hardly count left out, and the vector from the corner's voxel
    /// to the foot point.
    /// @param l, at  leaf and offset of the node
    template <typename Visit>
    void forCornersOfFoot(LeafNodes BandLeaf::*nodes, NodeIndex i, LeafIndex l, unsigned at,
                          const Visit& visit) const {
        constexpr float kLight = 0.01f;
        const Vec3f y = footOf(i);
        const Ijk low{floorToInt(y.x), floorToInt(y.y), floorToInt(y.z)};
        const Vec3f up = y - Vec3f(low);
        forCorners(nodes, l, at, low, [&](NodeIndex j, unsigned k) {
            const Vec3f from = up - Vec3f{float(k >> 2), float(k >> 1 & 1), float(k & 1)};
            const float weight =
                (1 - std::abs(from.x)) * (1 - std::abs(from.y)) * (1 - std::abs(from.z));
            if (weight >= kLight) visit(j, weight, from);
        });
    }
    template <typename Visit>
    void forCornersOfFoot(LeafNodes BandLeaf::*nodes, NodeIndex i, const Visit& visit) const {
        const Place at = placeOf(i);
        forCornersOfFoot(nodes, i, at.leaf, at.offset, visit);
    }

    /// Calls visit(j, step) for the nodes up to `reach` steps from the voxel at step `middle` from
    /// the one at an offset of leaf l.
    template <typename Visit>
    void forBox(LeafNodes BandLeaf::*nodes, LeafIndex l, unsigned at, const Ijk& middle, int reach,
                const Visit& visit) const {
        for (int x = -reach; x <= reach; ++x)
            for (int y = -reach; y <= reach; ++y)
                for (int z = -reach; z <= reach; ++z) {
                    const Ijk step = middle + Ijk{x, y, z};
                    const NodeIndex j = neighbor(nodes, l, at, step);
                    if (j != kNoNode) visit(j, step);
                }
    }
    template <typename Visit>
    void forBox(LeafNodes BandLeaf::*nodes, NodeIndex i, const Ijk& middle, int reach,
                const Visit& visit) const {
        const Place at = placeOf(i);
        forBox(nodes, at.leaf, at.offset, middle, reach, visit);
    }

    /// Calls visit(i, voxel) for the nodes among the voxels from `low` to `high`, leaf by leaf.
    template <typename Visit>
    void forVoxels(const Ijk& low, const Ijk& high, const Visit& visit) const;

    /// Whether a front may pass between neighbors i and j: not if their normals oppose, for then
    /// they belong to two sheets that face each other, nor if one sheet lies on top of the other,
    /// nor if the link is severed.
    bool linked(NodeIndex i, NodeIndex j) const {
        const int both = facing[i] & facing[j];
        return !both || ((!(both & kFacing) ||
                          (dot(normal[i], normal[j]) > kOtherSheet && !stacked(i, j))) &&
                         (!(both & kSevered) || !severed(i, j)));
    }
    /// Cosine below which normals oppose.
    static constexpr float kOtherSheet = kOppositeNormals;

    bool stacked(NodeIndex i, NodeIndex j) const {
        return igeo::stacked(Vec3f(ijk(j) - ijk(i)) + footOf(j) - footOf(i), normal[i], normal[j]);
    }

    /// Marks i and its neighbors up to two voxels along the axes as `facing` where normals oppose
    /// or sheets are stacked. May be called for many nodes in parallel.
    void markFacing(NodeIndex i);
    /// Marks i as kKink and calls markFacing(i). Call it for every node at which psi has a kink, in
    /// parallel if you like.
    void markKink(NodeIndex i);
    /// markFacing of all nodes, in parallel.
    void markFacing();

    /// Severs links between neighbors, in both directions. Call it once psi, foot points and
    /// normals are set, as often as there are links to add.
    /// Time O(n log n) for n links.
    void sever(const std::vector<Link>& links);
    /// Marks the neighbors of kBesideSevered outside the core too: on a mesh their foot points may
    /// lie beside severed links. Call it once all links are severed and the core is numbered.
    void markBesideSevered();
    /// SeveredLinks::bit of the neighbors that links of node i to are severed; 0 at most nodes,
    /// without a search.
    std::uint32_t severedSteps(NodeIndex i) const {
        return facing[i] & kSevered ? severed_.stepsFrom(i) : 0;
    }
    /// Whether the link between neighbors is severed.
    bool severed(NodeIndex i, NodeIndex j) const;
    /// Whether no severed link parts two nodes up to two steps apart: a node is a neighbor of both
    /// that no severed link parts from either. False further off, where links are severed.
    bool joined(NodeIndex i, NodeIndex j) const;
    /// The same for a node at a place and another a step away, both beside severed links.
    /// @param fromI, fromJ  severedSteps() of them
    bool joined(const Place& at, const Ijk& step, std::uint32_t fromI, std::uint32_t fromJ) const;

    /// Adds bridges between nodes of the core, in both directions.
    /// Time O(n log n).
    void bridge(const std::vector<Bridge>& bridges);
    /// Calls visit(bridge) for the bridges from a node.
    template <typename Visit>
    void forBridges(NodeIndex i, const Visit& visit) const {
        if (!(facing[i] & kBridged)) return;
        auto at = std::lower_bound(bridges_.begin(), bridges_.end(), i,
                                   [](const Bridge& b, NodeIndex node) { return b.from < node; });
        for (; at != bridges_.end() && at->from == i; ++at) visit(*at);
    }

    /// The nodes of the spine with foot points within kSpineReach of a point, ascending.
    std::vector<NodeIndex> spineNear(const Vec3d& p) const;
    static constexpr double kSpineReach = 16;  ///< voxels

    /// Sets the links of the core that are stretched. Time O(n log n).
    void stretch(std::vector<StretchedLink> links);
    /// Calls visit(link) for the stretched links from a node.
    template <typename Visit>
    void forStretched(NodeIndex i, const Visit& visit) const {
        auto at =
            std::lower_bound(stretched_.begin(), stretched_.end(), i,
                             [](const StretchedLink& l, NodeIndex node) { return l.from < node; });
        for (; at != stretched_.end() && at->from == i; ++at) visit(*at);
    }

    /// The leaf at a step of so many leaves, or kNoLeaf.
    LeafIndex leafBeside(LeafIndex l, int dx, int dy, int dz) const {
        if (std::max({std::abs(dx), std::abs(dy), std::abs(dz)}) > 1)
            return leafAt(leaves[l].origin + Ijk{8 * dx, 8 * dy, 8 * dz});
        return leaves[l].neighbor[std::size_t(9 * dx + 3 * dy + dz + 13)];
    }
    /// The leaf that holds a voxel, or kNoLeaf.
    LeafIndex leafAt(const Ijk& ijk) const;

    /// Numbers the nodes of `leaves` (origin and mask of `band` set, in their final order), links
    /// the leaves and sizes the node arrays; leaves them to the caller, who then calls
    /// numberCore().
    /// @param withFeet  the caller sets foot points
    /// @throws Error  BadInput for more nodes than NodeIndex can number
    void buildTopology(bool withFeet = true);

    /// Finds and numbers the core, from psi and normal.
    /// @param rim  nodes around sharp bends, which it takes in as well
    void numberCore(const std::vector<NodeIndex>& rim = {});
    std::size_t coreSize() const { return coreSize_; }
    /// The core's number of node i, or kNoNode.
    NodeIndex coreNode(NodeIndex i) const {
        const Place at = placeOf(i);
        return leaves[at.leaf].core.node(at.offset);
    }
    bool inCore(NodeIndex i) const { return coreNode(i) != kNoNode; }

    /// Bytes held by the arrays.
    std::size_t memUsage() const;

private:
    void markFacing(NodeIndex i, const Ijk& step);
    /// Bits of a slice in the rows y - 1 to y + 1, and in the columns z - 1 to z + 1; y and z in
    /// [-1, 8].
    static std::uint64_t rowsNear(int y) {
        return y < 1 ? 0xffffffu >> (8 - 8 * y) : std::uint64_t(0xffffff) << (8 * y - 8);
    }
    static std::uint64_t columnsNear(int z) {
        return ((z < 1 ? 7u >> (1 - z) : 7u << (z - 1)) & 0xff) * 0x0101010101010101ull;
    }

    static constexpr std::size_t kBlock = 16;
    std::vector<LeafIndex> leafOfBlock_;  ///< of every kBlock-th node
    std::vector<std::uint16_t> offset_;   ///< per node: in its leaf
    std::size_t coreSize_ = 0;
    SeveredLinks severed_;
    std::vector<Bridge> bridges_;           ///< sorted by both ends
    std::vector<StretchedLink> stretched_;  ///< sorted
    std::vector<LeafIndex> table_;  ///< open addressing over leaf origins, a power of two long
};

template <typename Visit>
void Band::forNeighbors(LeafNodes BandLeaf::*nodes, LeafIndex l, unsigned at,
                        const Visit& visit) const {
    const int x = int(at >> 6), y = int(at >> 3 & 7), z = int(at & 7);
    const BandLeaf& here = leaves[l];
    // The voxels of slice x + dx in the leaf at step (sy, sz) that lie in `rows`.
    auto slice = [&](int dx, int sy, int sz, std::uint64_t rows) {
        const int nx = x + dx, step = 9 * (nx >> 3) + 3 * sy + sz + 13;
        const LeafIndex m = step == 13 ? l : here.neighbor[std::size_t(step)];
        if (m == kNoLeaf) return;
        const LeafNodes& in = leaves[m].*nodes;
        const unsigned first = unsigned(nx & 7) << 6;
        std::uint64_t bits = in.mask[first >> 6] & rows & columnsNear(z - 8 * sz);
        if (dx == 0 && step == 13) bits &= ~(std::uint64_t(1) << (at & 63));
        for (; bits; bits &= bits - 1) {
            const auto bit = unsigned(std::countr_zero(bits));
            visit(in.numberOf(first | bit), dx, int(bit >> 3) + 8 * sy - y,
                  int(bit & 7) + 8 * sz - z);
        }
    };
    const int y0 = y == 0 ? -1 : 0, y1 = y == 7 ? 1 : 0;
    for (int dx = -1; dx <= 1; ++dx)
        for (int sy = y0; sy <= y1; ++sy) {
            const std::uint64_t rows = rowsNear(y - 8 * sy);
            if (z > 0 && z < 7)
                slice(dx, sy, 0, rows);
            else  // Row by row, for the order of the steps.
                for (int row = 0; row < 8; ++row) {
                    const std::uint64_t one = rows & std::uint64_t(0xff) << (8 * row);
                    if (!one) continue;
                    slice(dx, sy, z == 0 ? -1 : 0, one);
                    slice(dx, sy, z == 0 ? 0 : 1, one);
                }
        }
}

inline bool Band::joined(const Place& at, const Ijk& step, std::uint32_t fromI,
                         std::uint32_t fromJ) const {
    const auto first = [](int d) { return std::max(-1, d - 1); };
    const auto last = [](int d) { return std::min(1, d + 1); };
    if (std::max({std::abs(step.x), std::abs(step.y), std::abs(step.z)}) <= 1 &&
        !(fromI & SeveredLinks::bit(step.x, step.y, step.z)))
        return true;
    for (int x = first(step.x); x <= last(step.x); ++x)
        for (int y = first(step.y); y <= last(step.y); ++y)
            for (int z = first(step.z); z <= last(step.z); ++z)
                if ((x || y || z) && !(fromI & SeveredLinks::bit(x, y, z)) &&
                    !(fromJ & SeveredLinks::bit(x - step.x, y - step.y, z - step.z)) &&
                    neighbor(&BandLeaf::band, at.leaf, at.offset, {x, y, z}) != kNoNode)
                    return true;
    return false;
}

template <typename Visit>
void Band::forVoxels(const Ijk& low, const Ijk& high, const Visit& visit) const {
    // Bit k for each k in [first, last] within a leaf that begins at `from`.
    const auto within = [](int first, int last, int from) {
        return 0xffu >> (7 - std::min(last - from, 7)) & 0xffu << std::max(first - from, 0);
    };
    for (int x = low.x & ~7; x <= high.x; x += 8)
        for (int y = low.y & ~7; y <= high.y; y += 8)
            for (int z = low.z & ~7; z <= high.z; z += 8) {
                const LeafIndex l = leafAt({x, y, z});
                if (l == kNoLeaf) continue;
                const LeafNodes& in = leaves[l].band;
                const std::uint64_t row = within(low.z, high.z, z);
                std::uint64_t seen = 0;
                for (unsigned rows = within(low.y, high.y, y); rows; rows &= rows - 1)
                    seen |= row << 8 * std::countr_zero(rows);
                for (unsigned slices = within(low.x, high.x, x); slices; slices &= slices - 1) {
                    const auto s = unsigned(std::countr_zero(slices));
                    for (std::uint64_t bits = in.mask[s] & seen; bits; bits &= bits - 1) {
                        const auto bit = unsigned(std::countr_zero(bits));
                        visit(in.numberOf(s << 6 | bit),
                              Ijk{x + int(s), y + int(bit >> 3), z + int(bit & 7)});
                    }
                }
            }
}

template <typename Visit>
void Band::forCorners(LeafNodes BandLeaf::*nodes, LeafIndex l, unsigned at, const Ijk& low,
                      const Visit& visit) const {
    const int x = int(at >> 6) + low.x, y = int(at >> 3 & 7) + low.y, z = int(at & 7) + low.z;
    const int sx = x >> 3, sy = y >> 3, sz = z >> 3;
    if ((x & 7) < 7 && (y & 7) < 7 && (z & 7) < 7) {
        if (sx | sy | sz) l = leafBeside(l, sx, sy, sz);
        if (l == kNoLeaf) return;
        const LeafNodes& in = leaves[l].*nodes;
        const unsigned first = offsetOf(x, y, z);
        for (unsigned a = 0; a < 2; ++a) {
            const unsigned o = first + 64 * a;
            const std::uint64_t cell = in.mask[o >> 6] >> (o & 63);
            if (!(cell & 0x303)) continue;
            if (cell & 1) visit(in.numberOf(o), 4 * a);
            if (cell & 2) visit(in.numberOf(o + 1), 4 * a + 1);
            if (cell >> 8 & 1) visit(in.numberOf(o + 8), 4 * a + 2);
            if (cell >> 8 & 2) visit(in.numberOf(o + 9), 4 * a + 3);
        }
        return;
    }
    for (unsigned k = 0; k < 8; ++k) {
        const Ijk corner{int(k >> 2), int(k >> 1 & 1), int(k & 1)};
        const NodeIndex j = neighbor(nodes, l, at, low + corner);
        if (j != kNoNode) visit(j, k);
    }
}

/// The 8 nodes around a position with their trilinear weights: how values on band voxels are read
/// at points of S. A band of h >= sqrt(3) holds all 8 corners for every point of S (M&S 3.1).
struct BandCell {
    std::array<NodeIndex, 8> node;  ///< corner (a, b, c) at 4 a + 2 b + c; kNoNode outside the band
    std::array<double, 8> weight;   ///< trilinear, sums to 1 over all corners
    Ijk low;                        ///< the voxel of corner 0
    Vec3d t;                        ///< position in the cell, [0, 1)^3
    bool complete = true;           ///< all 8 corners are in the band

    Vec3d point() const { return Vec3d(low) + t; }
    Ijk voxel(std::size_t k) const {
        return low + Ijk{std::int32_t(k >> 2), std::int32_t(k >> 1 & 1), std::int32_t(k & 1)};
    }
};
BandCell cellAt(const Band& band, const Vec3d& pIndex);

/// Whether a path on the triangles hardly longer than the chord joins a point of the mesh with the
/// foot point of a node.
bool meshJoins(const Band& band, const SurfaceTriangles::Place& at, NodeIndex i);
/// The first of the nodes that the triangles join with a point; the first of all where none is.
/// @param nodes  with their order; sorted here
NodeIndex firstOnSheet(const Band& band, const SurfaceTriangles::Place& at,
                       std::span<std::pair<float, NodeIndex>> nodes);

/// Takes the corners that lie on a sheet facing the others' (Band::linked) out of the cell, and
/// those that severed links part from the corner on the sheet that is meant (whose foot point is
/// near and in its plane), so that values of two sheets are never blended.
/// @param sheetNormal  normal of the sheet that is meant, where it is known; zero: that of most of
///        the corners
/// @return the unit normal blended from the corners that are left; zero if there are none
Vec3d dropFacingCorners(const Band& band, BandCell& cell, const Vec3d& sheetNormal = {});

/// psi and its gradient at a position: psi_i + n_i . (p - x_i) / 2 of the cell's voxels x_i,
/// blended with trilinear weights. Exact for a quadratic psi, where psi_i alone are off by 1 / (8
/// R) voxels per curvature 1 / R. Creases are rounded. Where corners are missing, as at the rim of
/// an open surface: psi_i + n_i . (p - x_i) of the others, off by up to 1 / R.
struct PsiSample {
    bool valid = false;  ///< whether corners of 0.05 of the weight or more are there
    double psi = 0;      ///< voxels
    Vec3d gradient;      ///< of the blend, about 1 long
};
PsiSample samplePsi(const Band& band, const Vec3d& pIndex);
/// Its psi alone, in half the time; NaN where it is not valid.
double psiAt(const Band& band, const Vec3d& pIndex);

/// Moves a position near S onto it: to the nearest point of the band's triangles, or to psi = 0 by
/// Newton steps along grad psi (samplePsi).
/// @param sheetNormal  normal of the sheet that is meant, where it is known: triangles that oppose
///                     it count only where there are no others
/// @return false (and p unchanged) where S is more than 2 voxels away, or where the steps leave the
///         band or do not settle within 1e-6 voxels
bool projectToSurface(const Band& band, Vec3d& pIndex, const Vec3d& sheetNormal = {});
/// The position moved onto S so; itself where that fails, or moves it by a voxel or more, to
/// another sheet.
Vec3d ontoSurface(const Band& band, const Vec3d& pIndex);

/// Unit normal at a point of S: of the nearest triangle, or along the gradient of samplePsi; zero
/// where there is none.
Vec3d surfaceNormal(const Band& band, const Vec3d& pIndex);

}  // namespace igeo
