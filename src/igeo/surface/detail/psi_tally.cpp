#include <igeo/surface/detail/psi_tally.h>

#include <bit>
#include <cmath>

namespace igeo {

namespace {

using Leaves = std::span<const LeafBlock::Leaf* const>;

/// Per shell of |psi| next to S: the least |psi| beyond it, as Shells divides.
using ShellLimits = std::array<float, 4>;
ShellLimits shellLimits(double dx) {
    ShellLimits limits;
    for (std::size_t k = 0; k < limits.size(); ++k) {
        const auto voxels = double(k + 1);
        float& limit = limits[k] = float(voxels * dx);
        while (double(limit) / dx >= voxels) limit = std::nextafter(limit, 0.0f);
        while (double(limit) / dx < voxels) limit = std::nextafter(limit, float(kInfinity));
    }
    return limits;
}

template <int Width>
IGEO_INLINE std::uint64_t sumOf(const typename Registers<Width>::Integers& flags) {
    std::array<std::int32_t, Width> each;
    storeLanes(flags, each.data());
    std::int32_t sum = 0;
    for (const std::int32_t flag : each) sum -= flag;
    return std::uint64_t(sum);
}

template <int Width>
IGEO_INLINE void addRange(const LeafBlock::Leaf& leaf, double dx, const ShellLimits& limits,
                          PsiRange& range) {
    using V = typename Registers<Width>::Vector;
    using Integers = typename Registers<Width>::Integers;
    const float* values = leaf.buffer().data();
    V most{};
    Integers negative{}, finite{};
    std::array<Integers, std::tuple_size_v<ShellLimits>> below{};
    std::uint64_t active = 0;
    for (openvdb::Index x = 0; x < 8; ++x, values += 64) {
        const std::uint64_t slice = leaf.valueMask().getWord<openvdb::Index64>(x);
        active += std::uint64_t(std::popcount(slice));
        for (unsigned at = 0; at < 64; at += Width) {
            const auto bits = int(slice >> at & ((1u << Width) - 1));
            if (!bits) continue;
            const Integers isActive = ((Integers{} + bits) & bitPerLane<Width>()) != 0;
            const V value = isActive ? loadLanes<Width>(values + at) : V{} + kMissingVoxel,
                    size = absolute(value);
            const Integers isFinite = size <= std::numeric_limits<float>::max();
            negative += value < 0, finite += isFinite;
            most = (isFinite & (size > most)) ? size : most;
            for (std::size_t k = 0; k < limits.size(); ++k) below[k] += size < limits[k];
        }
    }
    range.active += active, range.negative += sumOf<Width>(negative);
    const std::uint64_t good = sumOf<Width>(finite);
    range.bad += active - good;
    for (std::size_t lane = 0; lane < Width; ++lane)
        range.widest = std::max(range.widest, most[lane]);
    std::uint64_t counted = 0;
    for (std::size_t k = 0; k < limits.size(); ++k) {
        const std::uint64_t all = sumOf<Width>(below[k]);
        range.shells.add(k, all - counted);
        counted = all;
    }
    if (counted < good)  // rarely
        forActive(leaf, [&](float value) {
            if (std::isfinite(value) && std::abs(value) >= limits.back())
                range.shells.add(std::abs(value) / dx);
        });
}
void rangeByFour(double dx, const ShellLimits& limits, Leaves leaves, PsiRange& range) {
    for (const LeafBlock::Leaf* leaf : leaves) addRange<4>(*leaf, dx, limits, range);
}
#ifdef IGEO_AVX2
IGEO_AVX2 void rangeByEight(double dx, const ShellLimits& limits, Leaves leaves, PsiRange& range) {
    for (const LeafBlock::Leaf* leaf : leaves) addRange<8>(*leaf, dx, limits, range);
}
#endif

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

/// Bits: which numbers of a row are no NaN.
template <int Width>
IGEO_INLINE unsigned valid(const RowNumbers& numbers) {
    unsigned bits = 0;
    for (std::size_t k = 0; k < 8; k += Width) {
        const auto value = loadLanes<Width>(&numbers[k]);
        bits |= bitsOf<Width>(value == value) << k;
    }
    return bits;
}

const CurvatureBins& curvatureBins() {
    static const CurvatureBins bins;
    return bins;
}

/// Whether |psi| is clearly convex at a voxel with all face neighbors.
bool isRidge(const LeafBlock& b, int x, int y, int z) {
    constexpr double kSharp = 0.5;
    return PsiDifferences(b, x, y, z).laplacian(b.at(x, y, z) < 0 ? -1 : 1) > kSharp;
}

template <int Width>
IGEO_INLINE void addRow(const LeafBlock& b, const openvdb::Coord& origin, int x, int y,
                        double halfWidth, PsiTally& tally) {
    if (!(b.active(x, y) & 0x1fe)) return;
    const PsiRow<Width> row(b, x, y);
    const float* psi = b.row(x, y);
    const auto bins = gradientBins<Width>(row.slope);
    for (unsigned bits = row.complete; bits; bits &= bits - 1)
        tally.gradient.addToBin(std::size_t(bins[std::size_t(std::countr_zero(bits))]));
    // Where opposite sheets meet, central differences cancel; at creases they stay above 0.58.
    for (unsigned bits = row.complete & within<Width>(row.slope.data(), 0.5f); bits;
         bits &= bits - 1)
        tally.meeting.add(double(std::abs(psi[std::countr_zero(bits)])) / PsiTally::kReachRange);
    constexpr float kRidge = 0.75f;
    for (unsigned bits = row.complete & within<Width>(row.slope.data(), kRidge); bits;
         bits &= bits - 1)
        if (const int z = std::countr_zero(bits); isRidge(b, x, y, z))
            tally.ridges.push_back(origin.offsetBy(x, y, z));
    const unsigned near = row.active & within<Width>(psi, 1);
    if (near == 0) return;
    tally.nearSurface += unsigned(std::popcount(near));
    tally.crossing += unsigned(std::popcount(near & crossing<Width>(b, x, y)));
    const RowCurvatures curvatures(b, x, y);
    const CurvatureBins& curvatureBin = curvatureBins();
    for (unsigned bits = near & row.complete & valid<Width>(curvatures.largest); bits;
         bits &= bits - 1)
        tally.curvature.addToBin(
            curvatureBin(double(curvatures.largest[std::size_t(std::countr_zero(bits))])));
    for (unsigned bits = near & ~row.complete; bits; bits &= bits - 1) {
        const int z = std::countr_zero(bits);
        tally.cut += cutBeside(PsiDifferences(b, x, y, z), psi[z], halfWidth);
    }
}

template <int Width>
IGEO_INLINE void addAll(const openvdb::FloatTree& tree, double dx, double halfWidth, Leaves leaves,
                        PsiTally& tally) {
    LeafBlock block;
    const LeafBlock::Accessor psi(tree);
    for (const PsiTally::Leaf* leaf : leaves) {
        block.gather<Width>(psi, leaf->origin(), dx, LeafBlock::kEdges);
        for (int x = 0; x < 8; ++x)
            for (int y = 0; y < 8; ++y)
                addRow<Width>(block, leaf->origin(), x, y, halfWidth, tally);
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

void PsiRange::addLeaves(double dx, Leaves leaves) {
    const ShellLimits limits = shellLimits(dx);
#ifdef IGEO_AVX2
    if (eightAtATime()) return rangeByEight(dx, limits, leaves, *this);
#endif
    rangeByFour(dx, limits, leaves, *this);
}

void PsiRange::add(const PsiRange& o) {
    active += o.active, negative += o.negative, bad += o.bad;
    widest = std::max(widest, o.widest);
    shells.add(o.shells);
}

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
    ridges.insert(ridges.end(), o.ridges.begin(), o.ridges.end());
}

}  // namespace igeo
