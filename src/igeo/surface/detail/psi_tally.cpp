#include <igeo/surface/detail/psi_tally.h>

#include <bit>
#include <cmath>

namespace igeo {

namespace {

/// Bits: whether a neighbor of a voxel has the other sign; NaN has none.
template <int Width>
IGEO_INLINE unsigned crossing(const LeafBlock& b, int x, int y) {
    using Flags = typename Registers<Width>::Integers;
    const float* row = b.row(x, y);
    const std::array<const float*, 6> around{b.row(x - 1, y), b.row(x + 1, y), b.row(x, y - 1),
                                             b.row(x, y + 1), row - 1,         row + 1};
    unsigned bits = 0;
    for (std::size_t k = 0; k < 8; k += Width) {
        Flags below{}, above{};
        for (const float* from : around) {
            const auto value = loadLanes<Width>(from + k);
            below |= value < 0, above |= value >= 0;
        }
        // By its sign bit.
        bits |= bitsOf<Width>(loadAs<Flags>(row + k) < 0 ? above : below) << k;
    }
    return bits;
}

/// The bins of |grad psi| at the voxels of a row.
template <int Width>
IGEO_INLINE std::array<std::int32_t, 8> gradientBins(const RowNumbers& slope) {
    using V = typename Registers<Width>::Vector;
    constexpr auto kPerUnit = float(double(Histogram::kBins) / PsiTally::kGradientRange);
    const V last = V{} + float(Histogram::kBins - 1);
    std::array<std::int32_t, 8> bins;
    for (std::size_t k = 0; k < 8; k += Width) {
        const V scaled = kPerUnit * loadLanes<Width>(&slope[k]);
        const auto bin = __builtin_convertvector(scaled < last ? scaled : last,
                                                 typename Registers<Width>::Integers);
        storeLanes(bin, &bins[k]);
    }
    return bins;
}

const CurvatureBins& curvatureBins() {
    static const CurvatureBins bins;
    return bins;
}

template <int Width>
IGEO_INLINE void addRow(const LeafBlock& b, int x, int y, double halfWidth, PsiTally& tally) {
    const PsiRow<Width> row(b, x, y);
    if (!row.active) return;
    const float* psi = b.row(x, y);
    const auto bins = gradientBins<Width>(row.slope);
    for (unsigned bits = row.complete; bits; bits &= bits - 1)
        tally.gradient.addToBin(std::size_t(bins[std::size_t(std::countr_zero(bits))]));
    // Where opposite sheets meet, central differences cancel; at creases they stay above 0.58.
    for (unsigned bits = row.complete & within<Width>(row.slope.data(), 0.5f); bits;
         bits &= bits - 1)
        tally.meeting.add(double(std::abs(psi[std::countr_zero(bits)])) / PsiTally::kReachRange);
    const unsigned near = row.active & within<Width>(psi, 1);
    if (near == 0) return;
    tally.nearSurface += unsigned(std::popcount(near));
    tally.crossing += unsigned(std::popcount(near & crossing<Width>(b, x, y)));
    const RowCurvatures curvatures(b, x, y);
    const CurvatureBins& curvatureBin = curvatureBins();
    for (unsigned bits = near & row.complete; bits; bits &= bits - 1)
        if (const auto k = double(curvatures.largest[std::size_t(std::countr_zero(bits))]);
            !std::isnan(k))
            tally.curvature.addToBin(curvatureBin(k));
    for (unsigned bits = near & ~row.complete; bits; bits &= bits - 1) {
        const int z = std::countr_zero(bits);
        tally.cut += cutBeside(PsiDifferences(b, x, y, z), psi[z], halfWidth);
    }
}

using Leaves = std::span<const PsiTally::Leaf* const>;

template <int Width>
IGEO_INLINE void addAll(const openvdb::FloatTree& tree, double dx, double halfWidth, Leaves leaves,
                        PsiTally& tally) {
    LeafBlock block;
    const LeafBlock::Accessor psi(tree);
    for (const PsiTally::Leaf* leaf : leaves) {
        block.gather(psi, leaf->origin(), dx, LeafBlock::kEdges);
        for (int x = 0; x < 8; ++x)
            for (int y = 0; y < 8; ++y) addRow<Width>(block, x, y, halfWidth, tally);
    }
}
void addByFour(const openvdb::FloatTree& psi, double dx, double halfWidth, Leaves leaves,
               PsiTally& tally) {
    addAll<4>(psi, dx, halfWidth, leaves, tally);
}
#ifdef IGEO_AVX2
IGEO_AVX2 void addByEight(const openvdb::FloatTree& psi, double dx, double halfWidth, Leaves leaves,
                          PsiTally& tally) {
    addAll<8>(psi, dx, halfWidth, leaves, tally);
}
#endif

}  // namespace

void PsiTally::addLeaves(const openvdb::FloatTree& psi, double dx, double halfWidth,
                         std::span<const Leaf* const> leaves) {
#ifdef IGEO_AVX2
    if (eightAtATime()) return addByEight(psi, dx, halfWidth, leaves, *this);
#endif
    addByFour(psi, dx, halfWidth, leaves, *this);
}

void PsiTally::add(const PsiTally& o) {
    nearSurface += o.nearSurface, crossing += o.crossing, cut += o.cut;
    gradient.add(o.gradient), curvature.add(o.curvature), meeting.add(o.meeting);
}

}  // namespace igeo
