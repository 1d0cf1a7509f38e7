#include <igeo/surface/detail/psi_tally.h>

#include <bit>
#include <cmath>
#include <cstring>

namespace igeo {

namespace {

constexpr double kGradientRange = 4;  // histogram of |grad psi| over [0, 4)
constexpr double kReachRange = 16;    // histogram of |psi| at medial voxels, voxels

/// Bits: whether a neighbor of a voxel has the other sign; NaN has none.
template <int Width>
IGEO_INLINE unsigned crossing(const LeafBlock& b, int x, int y) {
    using Flags = typename Registers<Width>::Integers;
    const float* row = b.row(x, y);
    const std::array<const float*, 6> around{b.row(x - 1, y), b.row(x + 1, y), b.row(x, y - 1),
                                             b.row(x, y + 1), row - 1,         row + 1};
    unsigned bits = 0;
    for (std::size_t k = 0; k < 8; k += Width) {
        Flags below{}, above{}, here;
        for (const float* from : around) {
            const auto value = loadLanes<Width>(from + k);
            below |= value < 0, above |= value >= 0;
        }
        std::memcpy(&here, row + k, sizeof(here));
        bits |= bitsOf<Width>(here < 0 ? above : below) << k;
    }
    return bits;
}

/// Bits: the voxels of a row with values below a limit.
template <int Width>
IGEO_INLINE unsigned below(float limit, const RowNumbers& values) {
    unsigned bits = 0;
    for (std::size_t k = 0; k < 8; k += Width)
        bits |= bitsOf<Width>(loadLanes<Width>(&values[k]) < limit) << k;
    return bits;
}

/// Bits: the voxels of a row within a voxel of the surface.
template <int Width>
IGEO_INLINE unsigned withinOne(const float* psi) {
    unsigned bits = 0;
    for (std::size_t k = 0; k < 8; k += Width)
        bits |= bitsOf<Width>(absolute(loadLanes<Width>(psi + k)) < 1) << k;
    return bits;
}

/// The bins of |grad psi| at the voxels of a row.
template <int Width>
IGEO_INLINE std::array<std::int32_t, 8> gradientBins(const RowNumbers& slope) {
    using V = typename Registers<Width>::Vector;
    constexpr auto kPerUnit = float(double(Histogram::kBins) / kGradientRange);
    const V last = V{} + float(Histogram::kBins - 1);
    std::array<std::int32_t, 8> bins;
    for (std::size_t k = 0; k < 8; k += Width) {
        const V scaled = kPerUnit * loadLanes<Width>(&slope[k]);
        const auto bin = __builtin_convertvector(scaled < last ? scaled : last,
                                                 typename Registers<Width>::Integers);
        std::memcpy(&bins[k], &bin, sizeof(bin));
    }
    return bins;
}

const CurvatureBins& curvatureBins() {
    static const CurvatureBins bins;
    return bins;
}

}  // namespace

template <int Width>
void PsiTally::addRow(const LeafBlock& b, int x, int y, double halfWidth) {
    const PsiRow<Width> row(b, x, y);
    if (!row.active) return;
    const float* psi = b.row(x, y);
    const auto bins = gradientBins<Width>(row.slope);
    for (unsigned bits = row.complete; bits; bits &= bits - 1)
        gradient_.addToBin(std::size_t(bins[std::size_t(std::countr_zero(bits))]));
    // Where opposite sheets meet, central differences cancel; at creases they stay above 0.58.
    for (unsigned bits = row.complete & below<Width>(0.5f, row.slope); bits; bits &= bits - 1)
        meeting_.add(double(std::abs(psi[std::countr_zero(bits)])) / kReachRange);
    const unsigned within = row.active & withinOne<Width>(psi);
    if (within == 0) return;
    nearSurface_ += unsigned(std::popcount(within));
    crossing_ += unsigned(std::popcount(within & crossing<Width>(b, x, y)));
    const RowCurvatures curvatures(b, x, y);
    for (unsigned bits = within & row.complete; bits; bits &= bits - 1)
        if (const auto k = double(curvatures.largest[std::size_t(std::countr_zero(bits))]);
            !std::isnan(k))
            curvature_.addToBin(curvatureBins()(k));
    for (unsigned bits = within & ~row.complete; bits; bits &= bits - 1) {
        const int z = std::countr_zero(bits);
        cut_ += cutBeside(PsiDifferences(b, x, y, z), psi[z], halfWidth);
    }
}

template <int Width>
void PsiTally::addAll(const LevelSet& s, std::span<const Leaf* const> leaves) {
    LeafBlock block;
    const LeafBlock::Accessor psi(s.psi->constTree());
    for (const Leaf* leaf : leaves) {
        block.gather(psi, leaf->origin(), s.transform.dx, LeafBlock::kEdges);
        for (int x = 0; x < 8; ++x)
            for (int y = 0; y < 8; ++y) addRow<Width>(block, x, y, s.stats.halfWidth);
    }
}

void PsiTally::addByFour(const LevelSet& s, std::span<const Leaf* const> leaves) {
    addAll<4>(s, leaves);
}
#ifdef IGEO_AVX2
void PsiTally::addByEight(const LevelSet& s, std::span<const Leaf* const> leaves) {
    addAll<8>(s, leaves);
}
#endif

void PsiTally::addLeaves(const LevelSet& s, std::span<const Leaf* const> leaves) {
#ifdef IGEO_AVX2
    if (eightAtATime()) return addByEight(s, leaves);
#endif
    addByFour(s, leaves);
}

void PsiTally::add(const PsiTally& o) {
    nearSurface_ += o.nearSurface_, crossing_ += o.crossing_, cut_ += o.cut_;
    gradient_.add(o.gradient_), curvature_.add(o.curvature_), meeting_.add(o.meeting_);
}

void PsiTally::summarize(LevelSetStats& st) const {
    st.nearSurface = nearSurface_;
    st.crossingShare = nearSurface_ ? double(crossing_) / double(nearSurface_) : 0;
    st.cutVoxels = cut_;
    st.gradientMedian = gradient_.quantile(0.5) * kGradientRange;
    st.gradientShare = gradient_.share((1 - kGradientTolerance) / kGradientRange,
                                       (1 + kGradientTolerance) / kGradientRange);
    st.largestCurvature = curvature_.total() ? curvatureOfScale(curvature_.quantile(0.95)) : 0;
    // One surface voxel in 200 may lie at a place where sheets meet before it counts.
    const double meeting = meeting_.valueAfter(nearSurface_ / 200) * kReachRange;
    st.reach = std::min(meeting, st.halfWidth);
}

}  // namespace igeo
