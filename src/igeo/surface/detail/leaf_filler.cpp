#include <igeo/surface/detail/leaf_filler.h>

#include <igeo/surface/detail/face_normal.h>

#include <bit>
#include <cmath>

namespace igeo {

namespace {

/// On the round side of an edge sharper than about 80 degrees, normals turn so fast that no front
/// would pass from face to face (Band::linked). So around bends of less than kSharpRadius the core
/// holds all voxels within kRim of S. Voxels.
constexpr double kRim = 1, kSharpRadius = 2;

/// Where |psi| is concave, |grad psi| by central differences is less than this where sheets meet,
/// and more at the crease of a right angle (0.71).
constexpr double kMeeting = 0.65;

/// A central difference whose length is as far off 1 may mix a face with what lies behind its edge.
constexpr float kMixed = 0.03f;

/// A node of a fan (addFans) is around a sharp bend. Where a level set is not exact, the length is
/// off 1 by kUneven, and psi is at most kRidge concave.
constexpr float kRidge = 0.8f;

/// The nodes of a row.
template <int Width>
struct NodeRow {
    RowNumbers nx, ny, nz;  ///< unit normals of smooth ones
    RowNumbers slope;       ///< length of the central difference
    unsigned smooth;
    unsigned mixed;  ///< bits: where differences may mix faces; of smooth ones, within kRim
    unsigned rim;    ///< bits: around a sharp bend
    unsigned fan;    ///< bits: may join the faces of a sharp edge

    IGEO_INLINE NodeRow(const LeafBlock& b, int x, int y) : mixed(0), rim(0), fan(0) {
        using V = typename Registers<Width>::Vector;
        const PsiRow<Width> row(b, x, y);
        smooth = row.smooth;
        slope = row.slope;
        const float *here = b.row(x, y), *x0 = b.row(x - 1, y), *x1 = b.row(x + 1, y),
                    *y0 = b.row(x, y - 1), *y1 = b.row(x, y + 1);
        for (std::size_t k = 0; k < 8; k += Width) {
            const V steep = loadLanes<Width>(&slope[k]), length = 2 * steep;
            storeLanes(loadLanes<Width>(&row.dx[k]) / length, &nx[k]);
            storeLanes(loadLanes<Width>(&row.dy[k]) / length, &ny[k]);
            storeLanes(loadLanes<Width>(&row.dz[k]) / length, &nz[k]);
            const V psi = loadLanes<Width>(here + k),
                    around = (loadLanes<Width>(x0 + k) + loadLanes<Width>(x1 + k)) +
                             (loadLanes<Width>(y0 + k) + loadLanes<Width>(y1 + k)) +
                             (loadLanes<Width>(here + k - 1) + loadLanes<Width>(here + k + 1)),
                    laplacian = around - 6 * psi, onRoundSide = psi < 0 ? -laplacian : laplacian;
            const auto mayBeCore = (absolute(psi) < float(kRim));
            const auto sharp = (onRoundSide > float(1 / kSharpRadius));
            rim |= bitsOf<Width>(mayBeCore & sharp) << k;
            mixed |= bitsOf<Width>(mayBeCore & (absolute(steep - 1) > kMixed)) << k;
            fan |= bitsOf<Width>(
                       (absolute(psi) >= float(kFanBegin)) & (absolute(psi) < float(kFanEnd)) &
                       (sharp | ((absolute(steep - 1) > kUneven) & (onRoundSide > -kRidge))))
                   << k;
        }
        mixed |= 0xff & ~smooth;
    }
};

/// Fills nodes leaf by leaf.
template <int Width>
class LeafFiller {
public:
    LeafFiller(const openvdb::FloatTree& psi, Band& band, Marks& marks)
        : psi_(psi), band_(band), marks_(marks) {}

    IGEO_INLINE void fill(LeafIndex l) {
        l_ = l;
        gather(LeafBlock::kFaces);
        const BandLeaf& leaf = band_.leaves[l_];
        NodeIndex first = leaf.band.firstNode;
        for (int x = 0; x < 8; ++x)
            for (int y = 0; y < 8; ++y)
                if (const unsigned bits = leaf.band.mask[std::size_t(x)] >> (8 * y) & 0xff)
                    first = fillRow(first, x, y, bits);
    }

private:
    IGEO_INLINE void gather(LeafBlock::Beyond beyond) {
        const Ijk& o = band_.leaves[l_].origin;
        block_.gather<Width>(psi_, openvdb::Coord(o.x, o.y, o.z), band_.transform.dx, beyond);
        beyond_ = beyond;
    }
    /// @param first  node of the row
    /// @param bits   of its nodes
    /// @return the first node of the next row
    IGEO_INLINE NodeIndex fillRow(NodeIndex first, int x, int y, unsigned bits) {
        const NodeRow<Width> row(block_, x, y);
        const float* psi = block_.row(x, y);
        NodeIndex i = first;
        for (unsigned rest = bits; rest; rest &= rest - 1, ++i) {
            const auto z = std::size_t(std::countr_zero(rest));
            band_.psi[i] = psi[z];
            band_.normal[i] = {row.nx[z], row.ny[z], row.nz[z]};
        }
        const auto nodeAt = [&](int z) {
            return first + NodeIndex(std::popcount(bits & ((1u << z) - 1)));
        };
        const unsigned mixed = bits & row.mixed;
        if (mixed && beyond_ != LeafBlock::kCorners) gather(LeafBlock::kCorners);
        for (unsigned rest = mixed; rest; rest &= rest - 1) {
            const int z = std::countr_zero(rest);
            fillMixed(nodeAt(z), x, y, z, row.smooth >> z & 1);
        }
        for (unsigned rest = bits & row.rim; rest; rest &= rest - 1)
            marks_.rims[l_].push_back(nodeAt(std::countr_zero(rest)));
        for (unsigned rest = bits & row.fan; rest; rest &= rest - 1) {
            const int z = std::countr_zero(rest);
            marks_.fans[l_].push_back({nodeAt(z), row.slope[std::size_t(z)]});
        }
        return i;
    }
    void fillMixed(NodeIndex i, int x, int y, int z, bool smooth) {
        const std::optional<Vec3f> face = faceNormal(block_, x, y, z);
        if (face) band_.normal[i] = *face;
        if (smooth) return;
        const PsiDifferences d(block_, x, y, z);
        const double value = block_.at(x, y, z);
        if (!face) band_.normal[i] = Vec3f(normalized(psiGradient(d, value)));
        marks_.kinks[l_].push_back(i);
        if (length(d.central()) < kMeeting && d.laplacian(value < 0 ? -1 : 1) < 0)
            marks_.meetings[l_].push_back(i);
    }

    const LeafBlock::Accessor psi_;
    LeafBlock block_;
    LeafBlock::Beyond beyond_;  ///< what of it is gathered
    LeafIndex l_;
    Band& band_;
    Marks& marks_;
};

template <int Width>
IGEO_INLINE void fillAll(const openvdb::FloatTree& psi, LeafIndex first, std::size_t count,
                         Band& band, Marks& marks) {
    LeafFiller<Width> filler(psi, band, marks);
    for (LeafIndex l = first; l < first + count; ++l) filler.fill(l);
}
void fillByFour(const openvdb::FloatTree& psi, LeafIndex first, std::size_t count, Band& band,
                Marks& marks) {
    fillAll<4>(psi, first, count, band, marks);
}

/// @param limit  at least that of markWithin, with no number between the two
template <int Width>
IGEO_INLINE void markAll(const float* values, float limit, std::array<std::uint64_t, 8>& slices) {
    for (std::uint64_t& slice : slices) {
        slice = 0;
        for (unsigned k = 0; k < 64; k += 8, values += 8)
            slice |= std::uint64_t(within<Width>(values, limit)) << k;
    }
}
void markByFour(const float* values, float limit, std::array<std::uint64_t, 8>& slices) {
    markAll<4>(values, limit, slices);
}
#ifdef IGEO_AVX2
IGEO_AVX2 void fillByEight(const openvdb::FloatTree& psi, LeafIndex first, std::size_t count,
                           Band& band, Marks& marks) {
    fillAll<8>(psi, first, count, band, marks);
}
IGEO_AVX2 void markByEight(const float* values, float limit, std::array<std::uint64_t, 8>& slices) {
    markAll<8>(values, limit, slices);
}
#endif

}  // namespace

void fillLeaves(const openvdb::FloatTree& psi, LeafIndex first, std::size_t count, Band& band,
                Marks& marks) {
#ifdef IGEO_AVX2
    if (eightAtATime()) return fillByEight(psi, first, count, band, marks);
#endif
    fillByFour(psi, first, count, band, marks);
}

void markWithin(const float* values, double limit, std::array<std::uint64_t, 8>& slices) {
    auto rounded = float(limit);
    if (double(rounded) < limit) rounded = std::nextafter(rounded, float(kInfinity));
#ifdef IGEO_AVX2
    if (eightAtATime()) return markByEight(values, rounded, slices);
#endif
    markByFour(values, rounded, slices);
}

}  // namespace igeo
