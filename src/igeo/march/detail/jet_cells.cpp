#include <igeo/base/detail/registers.h>
#include <igeo/march/detail/jet_corners.h>

namespace igeo {

namespace {

/// Counts bits: processors that have registers of eight do so at once.
template <int Width>
IGEO_INLINE NodeIndex bitCount(std::uint64_t bits) {
    if constexpr (Width == 8)
        return NodeIndex(__builtin_popcountll(bits));
    else
        return LeafNodes::bitCount(bits);
}

/// Where the corners of cells are that lie in a leaf or in those around it.
struct CellCorners {
    template <typename T>
    using PerLane = CellPlaces::PerLane<T>;
    alignas(32) PerLane<std::int32_t> x;       ///< slice of the low corner, in its leaf
    alignas(32) PerLane<std::int32_t> nextX;   ///< from its leaf to that of the next slice
    alignas(32) PerLane<std::int32_t> nextYZ;  ///< not 0: corners of a slice are in several leaves
    alignas(32) PerLane<std::int32_t> beside;  ///< 0: some are elsewhere
    /// Per corner (b, c) of a slice, at 2 b + c: its leaf in BandLeaf::neighbor, and its bit there.
    alignas(32) PerLane<std::int32_t> leaf[4], bit[4];

    template <int Width>
    IGEO_INLINE void set(const CellPlaces& cells, std::size_t first) {
        using Integers = typename Registers<Width>::Integers;
        const auto lowX = loadAs<Integers>(cells.x.data() + first),
                   lowY = loadAs<Integers>(cells.y.data() + first),
                   lowZ = loadAs<Integers>(cells.z.data() + first);
        const Integers low = 9 * (lowX >> 3) + 3 * (lowY >> 3) + (lowZ >> 3) + 13,
                       acrossX = ((lowX & 7) == 7) & 9, acrossY = ((lowY & 7) == 7) & 3,
                       acrossZ = ((lowZ & 7) == 7) & 1;
        storeLanes(lowX & 7, x.data() + first);
        storeLanes(acrossX, nextX.data() + first);
        storeLanes(acrossY | acrossZ, nextYZ.data() + first);
        storeLanes(
            (lowX >= -8) & (lowX < 15) & (lowY >= -8) & (lowY < 15) & (lowZ >= -8) & (lowZ < 15),
            beside.data() + first);
        for (int b = 0; b < 2; ++b)
            for (int c = 0; c < 2; ++c) {
                storeLanes(low + b * acrossY + c * acrossZ, leaf[2 * b + c].data() + first);
                storeLanes(((lowY + b) & 7) * 8 + ((lowZ + c) & 7), bit[2 * b + c].data() + first);
            }
    }
};

/// Finds the nodes at the corners of the cell in one lane.
template <int Width>
class CornerNodes {
public:
    IGEO_INLINE CornerNodes(const Band& band, LeafIndex leaf, const CellCorners& cells,
                            std::size_t lane, NodeIndex* node)
        : leaves_(band.leaves.data()),
          around_(leaves_[leaf].neighbor.data()),
          cells_(cells),
          lane_(lane),
          node_(node) {}

    /// @return whether all are nodes of the band; if not, not all numbers are set
    IGEO_INLINE bool find() const {
        if (cells_.nextYZ[lane_])
            return findCorner<0>(0) && findCorner<1>(0) && findCorner<2>(0) && findCorner<3>(0) &&
                   findCorner<0>(1) && findCorner<1>(1) && findCorner<2>(1) && findCorner<3>(1);
        return findSquare(0) && findSquare(1);
    }

private:
    /// A slice of a leaf, from a corner on.
    struct Slice {
        std::uint64_t isNode = 0, isCore;
        NodeIndex core;  ///< number of the first node of the core from there on

        NodeIndex isThere(int k) const { return NodeIndex(isCore >> k & 1); }
    };
    /// That of corner k of slice a; nothing without a leaf.
    IGEO_INLINE Slice sliceAt(int a, int k) const {
        Slice slice;
        const LeafIndex m = around_[cells_.leaf[k][lane_] + a * cells_.nextX[lane_]];
        if (m == kNoLeaf) return slice;
        const BandLeaf& leaf = leaves_[m];
        const int x = (cells_.x[lane_] + a) & 7, bit = cells_.bit[k][lane_];
        const std::uint64_t core = leaf.core.mask.data()[x];
        slice.isNode = leaf.band.mask.data()[x] >> bit, slice.isCore = core >> bit;
        slice.core = leaf.core.firstNode + leaf.core.before.data()[x] +
                     bitCount<Width>(core & ((std::uint64_t(1) << bit) - 1));
        return slice;
    }
    /// The corners of a slice, all in one leaf.
    IGEO_INLINE bool findSquare(int a) const {
        constexpr std::uint64_t kSquare = 0x303;
        const Slice slice = sliceAt(a, 0);
        if (~slice.isNode & kSquare) return false;
        const NodeIndex second = slice.core + bitCount<Width>(slice.isCore & 0xff);
        set(4 * a, slice.core, slice.isThere(0));
        set(4 * a + 1, slice.core + slice.isThere(0), slice.isThere(1));
        set(4 * a + 2, second, slice.isThere(8));
        set(4 * a + 3, second + slice.isThere(8), slice.isThere(9));
        return true;
    }
    template <int K>
    IGEO_INLINE bool findCorner(int a) const {
        const Slice slice = sliceAt(a, K);
        set(4 * a + K, slice.core, slice.isThere(0));
        return slice.isNode & 1;
    }
    IGEO_INLINE void set(int k, NodeIndex node, NodeIndex isThere) const {
        static_assert(kNoNode == ~NodeIndex(0));
        node_[std::size_t(k) * Lanes::kNodes] = node | (isThere - 1);
    }

    const BandLeaf* const leaves_;
    const LeafIndex* const around_;
    const CellCorners& cells_;
    const std::size_t lane_;
    NodeIndex* const node_;
};

/// The same wherever the cell is.
bool findFarCorners(const Band& band, LeafIndex leaf, const Ijk& low, NodeIndex* node) {
    for (int k = 0; k < 8; ++k) {
        const Ijk corner = low + Ijk{k >> 2, k >> 1 & 1, k & 1};
        if (band.neighbor(&BandLeaf::band, leaf, 0, corner) == kNoNode) return false;
        node[std::size_t(k) * Lanes::kNodes] = band.neighbor(&BandLeaf::core, leaf, 0, corner);
    }
    return true;
}

template <int Width>
IGEO_INLINE void findCornersHere(const Band& band, const CellPlaces& cells, unsigned wanted,
                                 CellPoints& points) {
    CellCorners corners;
    for (std::size_t first = 0; first < Lanes::kNodes; first += Width)
        corners.set<Width>(cells, first);
    for (std::size_t lane = 0; lane < Lanes::kNodes; ++lane) {
        NodeIndex* const node = &points.node[0][lane];
        const LeafIndex leaf = cells.leaf[lane];
        const bool isWhole =
            wanted >> lane & 1 &&
            (corners.beside[lane]
                 ? CornerNodes<Width>(band, leaf, corners, lane, node).find()
                 : findFarCorners(band, leaf, {cells.x[lane], cells.y[lane], cells.z[lane]}, node));
        if (!isWhole) points.clearNodes(lane);
    }
}
void findCornersByFour(const Band& band, const CellPlaces& cells, unsigned wanted,
                       CellPoints& points) {
    findCornersHere<4>(band, cells, wanted, points);
}
#ifdef IGEO_AVX2
IGEO_AVX2 void findCornersByEight(const Band& band, const CellPlaces& cells, unsigned wanted,
                                  CellPoints& points) {
    findCornersHere<8>(band, cells, wanted, points);
}
#endif

}  // namespace

void findCorners(const Band& band, const CellPlaces& cells, unsigned wanted, CellPoints& points) {
#ifdef IGEO_AVX2
    if (eightAtATime()) return findCornersByEight(band, cells, wanted, points);
#endif
    findCornersByFour(band, cells, wanted, points);
}

}  // namespace igeo
