/// The band Omega_h = {|psi| < h}: all that a marching scheme or a tracer knows of a surface.
///
/// Where a band comes from (a level set, a mesh, points) is the business of the file that fills it;
/// level_set_band.h is one. All lengths are in voxels, all positions in index space (types.h).
#pragma once

#include <igeo/types.h>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace igeo {

using LeafIndex = std::uint32_t;
constexpr LeafIndex kNoLeaf = std::numeric_limits<LeafIndex>::max();

/// 8^3 voxels of the band, laid out as OpenVDB's leaves: voxel (x, y, z) of the leaf has offset
/// 64 x + 8 y + z, so mask word x holds the slice at x and its byte y the row at (x, y).
struct BandLeaf {
    Ijk origin;                              ///< smallest voxel, a multiple of 8
    NodeIndex firstNode = 0;                 ///< number of the leaf's first node
    NodeIndex nodeCount = 0;                 ///< nodes of the leaf
    std::array<std::uint64_t, 8> mask{};     ///< which voxels are in the band
    std::array<std::uint16_t, 64> before{};  ///< nodes of the leaf before the row at 8 x + y
    std::array<LeafIndex, 27> neighbour{};   ///< leaf at step (dx,dy,dz): 9(dx+1)+3(dy+1)+dz+1

    /// The row at 8 x + y: bit z for voxel z.
    unsigned row(unsigned xy) const { return unsigned(mask[xy >> 3] >> (8 * (xy & 7))) & 0xff; }
    /// The node at an offset of this leaf, or kNoNode.
    NodeIndex node(unsigned offset) const {
        const unsigned bits = row(offset >> 3), z = offset & 7;
        if (!(bits >> z & 1)) return kNoNode;
        return firstNode + before[offset >> 3] + bitCount(bits & ((1u << z) - 1));
    }
    /// Bits set in a byte. By hand: the instruction for it is not in every x86-64.
    static unsigned bitCount(unsigned byte) {
        byte -= byte >> 1 & 0x55;
        byte = (byte & 0x33) + (byte >> 2 & 0x33);
        return (byte + (byte >> 4)) & 0xf;
    }
};

/// The band in flat arrays. Nodes are numbered leaf by leaf, by offset within the leaf, so the
/// numbering depends on the topology alone. 35 bytes per node and 3 to 5 for the leaves.
///
/// M&S (14) keeps h below W, the distance at which two sheets of the surface meet, so that a front
/// never jumps from one to the other. Real surfaces have places where no grid affords that
/// (grooves, thin walls); there `linked` cuts the band along the medial axis instead.
struct Band {
    Similarity transform;  ///< world from index; transform.dx is the voxel size
    double h = 0;          ///< half the band's thickness, voxels

    std::vector<BandLeaf> leaves;
    std::vector<LeafIndex> leaf;        ///< per node: its leaf
    std::vector<std::uint16_t> offset;  ///< per node: its offset in the leaf
    std::vector<float> psi;             ///< per node: signed distance, voxels; |psi| < h
    std::vector<Vec3f> foot;            ///< per node: foot point on S, relative to the voxel
    std::vector<Vec3f> normal;          ///< per node: unit normal at the foot point, along grad psi

    std::vector<std::uint8_t>
        facing;  ///< per node: 1 where a neighbour lies on a sheet that faces it

    std::size_t size() const { return psi.size(); }

    Ijk ijk(NodeIndex i) const {
        const unsigned o = offset[i];
        return leaves[leaf[i]].origin +
               Ijk{std::int32_t(o >> 6), std::int32_t(o >> 3 & 7), std::int32_t(o & 7)};
    }
    Vec3d footPoint(NodeIndex i) const { return Vec3d(ijk(i)) + Vec3d(foot[i]); }

    /// The node at step (dx, dy, dz) from node i, each step in [-8, 8], or kNoNode. O(1).
    NodeIndex neighbour(NodeIndex i, int dx, int dy, int dz) const {
        const int o = offset[i];
        const int x = (o >> 6) + dx, y = (o >> 3 & 7) + dy, z = (o & 7) + dz;
        LeafIndex l = leaf[i];
        if ((x | y | z) & ~7) {
            l = leaves[l].neighbour[std::size_t(9 * (x >> 3) + 3 * (y >> 3) + (z >> 3) + 13)];
            if (l == kNoLeaf) return kNoNode;
        }
        return leaves[l].node(unsigned((x & 7) << 6 | (y & 7) << 3 | (z & 7)));
    }

    /// The node at a voxel, or kNoNode. One hash look-up.
    NodeIndex nodeAt(const Ijk& ijk) const {
        const LeafIndex l = leafAt(ijk);
        if (l == kNoLeaf) return kNoNode;
        return leaves[l].node(unsigned((ijk.x & 7) << 6 | (ijk.y & 7) << 3 | (ijk.z & 7)));
    }
    NodeIndex neighbour(NodeIndex i, const Ijk& step) const {
        return neighbour(i, step.x, step.y, step.z);
    }
    /// The step across face 0 to 5 of a voxel: -x, +x, -y, +y, -z, +z.
    static Ijk faceStep(int side) {
        Ijk step{};
        step[side / 2] = side % 2 ? 1 : -1;
        return step;
    }

    /// Calls visit(j, dx, dy, dz) for the nodes j != i within one voxel of node i in every axis, in
    /// the order of the steps. Faster than 26 calls of neighbour().
    template <typename Visit>
    void forNeighbours(NodeIndex i, const Visit& visit) const;

    /// Whether a front may pass between neighbours i and j: not if their normals oppose, for then
    /// they belong to two sheets that face each other.
    bool linked(NodeIndex i, NodeIndex j) const {
        return !(facing[i] & facing[j]) || dot(normal[i], normal[j]) > kOtherSheet;
    }
    /// Cosine below which normals oppose: beyond a right angle, which an honest crease has.
    static constexpr float kOtherSheet = -0.2f;

    /// Marks i and its neighbours up to two voxels along the axes as `facing` where normals oppose.
    /// May be called for many nodes in parallel; call it for every node at which psi has a kink.
    void markFacing(NodeIndex i);

    /// The leaf that holds a voxel, or kNoLeaf.
    LeafIndex leafAt(const Ijk& ijk) const;

    /// Numbers the nodes of `leaves` (origin and mask set, in their final order), links the leaves
    /// and sizes the node arrays; fills `leaf` and `offset`, leaves the rest to the caller.
    /// @throws Error  BadInput for more nodes than NodeIndex can number
    void buildTopology();

    /// Bytes held by the arrays.
    std::size_t memUsage() const;

private:
    std::vector<LeafIndex> table_;  ///< open addressing over leaf origins, a power of two long
};

template <typename Visit>
void Band::forNeighbours(NodeIndex i, const Visit& visit) const {
    const int o = offset[i], x = o >> 6, y = o >> 3 & 7, z = o & 7;
    const BandLeaf& here = leaves[leaf[i]];
    // Row by row along z: the nodes of a row are consecutive, and most rows are short.
    for (int dx = -1; dx <= 1; ++dx)
        for (int dy = -1; dy <= 1; ++dy) {
            const int nx = x + dx, ny = y + dy;
            const int at = 9 * (nx >> 3) + 3 * (ny >> 3) + 13;
            const auto xy = unsigned((nx & 7) << 3 | (ny & 7));
            const bool centre = dx == 0 && dy == 0;
            auto beside = [&](int step, unsigned bit) {
                const LeafIndex l = here.neighbour[std::size_t(at + step)];
                if (l == kNoLeaf || !(leaves[l].row(xy) >> bit & 1)) return;
                visit(leaves[l].node(xy << 3 | bit), dx, dy, step);
            };
            if (z == 0) beside(-1, 7);
            const LeafIndex l = at == 13 ? leaf[i] : here.neighbour[std::size_t(at)];
            if (l != kNoLeaf) {
                const BandLeaf& in = leaves[l];
                // Shifted up by one bit, so that z - 1 needs no exception at z = 0.
                const unsigned row = in.row(xy) << 1, near = row >> z & 7;
                if (near) {
                    NodeIndex next =
                        in.firstNode + in.before[xy] + BandLeaf::bitCount(row & ((1u << z) - 1));
                    if (near & 1) visit(next++, dx, dy, -1);
                    if (near & 2) {
                        if (!centre) visit(next, dx, dy, 0);
                        ++next;
                    }
                    if (near & 4) visit(next, dx, dy, 1);
                }
            }
            if (z == 7) beside(1, 0);
        }
}

/// The 8 nodes around a position with their trilinear weights: how values on band voxels are read
/// at points of S. A band of h >= sqrt(3) holds all 8 corners for every point of S (M&S 3.1).
struct BandCell {
    std::array<NodeIndex, 8> node;  ///< corner (a, b, c) at 4 a + 2 b + c; kNoNode outside the band
    std::array<double, 8> weight;   ///< trilinear, sums to 1 over all corners
    Vec3d t;                        ///< position in the cell, [0, 1)^3
    bool complete = true;           ///< all 8 corners are in the band
};
BandCell cellAt(const Band& band, const Vec3d& pIndex);

/// Takes the corners that lie on a sheet facing the others' (Band::linked) out of the cell, so that
/// values of two sheets are never blended.
/// @return the unit normal blended from the corners; zero if there are none
Vec3d dropFacingCorners(const Band& band, BandCell& cell);

/// psi and its gradient at a position, from the trilinear interpolant of the band's psi.
struct PsiSample {
    bool valid = false;  ///< false where a corner is missing
    double psi = 0;      ///< voxels
    Vec3d gradient;      ///< of the interpolant, about 1 long
};
PsiSample samplePsi(const Band& band, const Vec3d& pIndex);

/// Moves a position near S to psi = 0 by Newton steps along grad psi.
/// @return false (and p unchanged) where the steps leave the band or do not settle within
///         `tolerance` voxels
bool projectToSurface(const Band& band, Vec3d& pIndex, double tolerance = 1e-6);

}  // namespace igeo
