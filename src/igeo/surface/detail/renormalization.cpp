#include <igeo/surface/detail/renormalization.h>

#include <igeo/base/parallel.h>
#include <igeo/surface/detail/hollow_edges.h>
#include <igeo/surface/detail/leaf_block.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <memory>
#include <numeric>
#include <optional>
#include <set>
#include <utility>
#include <vector>

namespace igeo {

namespace {

using Tree = openvdb::FloatTree;
using Leaf = LeafBlock::Leaf;

constexpr double kOffset = kRenormalizedAbout;  ///< voxels: phi = psi - kOffset
constexpr float kShift = 1e-7f;                 ///< world units: what the step takes away at last
constexpr float kLeastExcess = -0.05f;          ///< M, where it is less and
constexpr float kMostExcess = 0.5f;             ///< more

/// What the step has done to some voxels of a row, in one number each: M in its first 16 bits, |S|
/// and the share of the mean of M in a byte each. A sum of such numbers is one of M.
template <int Width>
struct StepLanes {
    using V = typename Registers<Width>::Vector;
    using Integers = typename Registers<Width>::Integers;

    V packed;  ///< of voxels with all face neighbors

    /// @param from  the first of them
    /// @param zero  phi = 0, as psi in voxels
    IGEO_INLINE StepLanes(const LeafBlock& block, int x, int y, int from, float zero) {
        // Inlined always: Clang passes registers of eight to a lambda otherwise than it takes them.
        auto phi = [&](int i, int j, int k) __attribute__((always_inline)) {
            return loadLanes<Width>(block.row(x + i, y + j) + from + k) - zero;
        };
        const V here = phi(0, 0, 0), side = here > 0 ? V{} + 1 : V{} - 1;
        V square{}, shares{};
        auto add = [&](const V& low, const V& high) __attribute__((always_inline)) {
            const V toLow = side * (here - low), toHigh = side * (here - high);
            const V step = above(toLow > toHigh ? toLow : toHigh, 0);
            square += step * step, shares += step;
        };
        add(phi(-1, 0, 0), phi(1, 0, 0)), add(phi(0, -1, 0), phi(0, 1, 0));
        add(phi(0, 0, -1), phi(0, 0, 1));
        constexpr float kTiny = 1e-6f, kRoom = 0.1f;
        // phi at the upwind neighbors, in the mean.
        const V upwind = here - side * square / above(shares, kTiny);
        V gradient = square, root = here * here + square, upwindRoot = upwind * upwind + 1;
        takeRoots<Width>(gradient), takeRoots<Width>(root), takeRoots<Width>(upwindRoot);
        const V pull = absolute(here) / above(root, kTiny), share = shares / above(gradient, kTiny),
                fall = pull - absolute(upwind) / upwindRoot,
                excess = side * (gradient - 1) / above(1 - share * fall, kRoom);
        // Where the mean stands for M; where psi contradicts itself, and stays as it is.
        constexpr float kSteep = 0.7f, kSteepest = 1, kSure = 0.3f, kFold = 1.0f, kDoubtful = 0.7f;
        const V steep = (pull * share - kSteep) / (kSteepest - kSteep),
                large = (excess - kSure) / (kMostExcess - kSure);
        const V trust = below(above((kFold - excess) / (kFold - kDoubtful), 0), 1);
        packed = pack(below(above(excess, kLeastExcess), kMostExcess), trust * pull,
                      steep > large ? steep : large);
    }
    static IGEO_INLINE V pull(const V& packed) { return byte(packed, 8); }
    static IGEO_INLINE V shareOfMean(const V& packed) { return byte(packed, 0); }

private:
    static IGEO_INLINE V above(const V& v, float least) { return v > least ? v : V{} + least; }
    static IGEO_INLINE V below(const V& v, float most) { return v < most ? v : V{} + most; }
    static IGEO_INLINE V byte(const V& packed, int shift) {
        return __builtin_convertvector((loadAs<Integers>(&packed) >> shift) & 255, V) *
               (1 / 255.0f);
    }
    static IGEO_INLINE Integers toByte(const V& v) {
        return __builtin_convertvector(below(above(v, 0), 1) * 255.0f + 0.5f, Integers);
    }
    static IGEO_INLINE V pack(const V& excess, const V& pull, const V& share) {
        const Integers bits =
            (loadAs<Integers>(&excess) & ~0xffff) | toByte(pull) << 8 | toByte(share);
        return loadAs<V>(&bits);
    }
};

/// Eight small numbers, a byte each from the lowest on: they are added at once.
using EightBytes = std::uint64_t;

/// The weights 1, 2, 1 that eight voxels of a row get from the known ones of ten, by their bits.
constexpr auto kWeightsAlongZ = [] {
    std::array<EightBytes, 1024> all{};
    for (std::uint64_t known = 0; known < all.size(); ++known)
        for (unsigned z = 0; z < 8; ++z)
            all[known] |= ((known >> z & 1) + (known >> z & 2) + (known >> (z + 2) & 1)) << 8 * z;
    return all;
}();

/// Means over the 27 voxels around each of a leaf, weighted 1, 2, 1 along each axis; those without
/// a value do not count.
template <int Width>
class Smoothed {
    using V = typename Registers<Width>::Vector;

public:
    /// @param block  with 0 for voxels without a value
    IGEO_INLINE void of(const LeafBlock& block) {
        for (int x = 0; x < 10; ++x) {
            for (int k = 0; k < 8; k += Width)
                acrossY(
                    [&](int y) __attribute__((always_inline)) {
                        const float* row = block.row(x - 1, y) + k;
                        const V own = loadLanes<Width>(row);
                        return (loadLanes<Width>(row - 1) + (own + own)) +
                               loadLanes<Width>(row + 1);
                    },
                    [&](int y, const V& sum) __attribute__((always_inline)) {
                        storeLanes(sum, &sums_[indexOf(x, y) + std::size_t(k)]);
                    });
            acrossY([&](int y) { return kWeightsAlongZ[block.active(x - 1, y)]; },
                    [&](int y, EightBytes sum) { weights_[indexOf(x, y) / 8] = sum; });
        }
    }
    /// At some voxels of a row.
    IGEO_INLINE V mean(int x, int y, int from) const {
        auto sum = [&](int i) __attribute__((always_inline)) {
            return loadLanes<Width>(&sums_[indexOf(x + i, y) + std::size_t(from)]);
        };
        auto weight = [&](int i) { return weights_[indexOf(x + i, y) / 8]; };
        const EightBytes bytes = weight(0) + 2 * weight(1) + weight(2);
        const V all = numbersOf(bytes, from);
        return (((sum(0) + sum(1)) + sum(1)) + sum(2)) / (all > 0 ? all : V{} + 1);
    }

private:
    /// Sums weighted 1, 2, 1 of what ten rows have.
    template <typename RowAt, typename Put>
    static IGEO_INLINE void acrossY(const RowAt& rowAt, const Put& put) {
        auto before = rowAt(-1), here = rowAt(0);
        for (int y = 0; y < 8; ++y) {
            const auto after = rowAt(y + 1);
            put(y, ((before + here) + here) + after);
            before = here, here = after;
        }
    }
    /// Some of eight bytes, each less than 128.
    static IGEO_INLINE V numbersOf(EightBytes bytes, int from) {
        using Integers = typename Registers<Width>::Integers;
        const std::int32_t low = std::int32_t(bytes >> (8 * from)),
                           high = std::int32_t(bytes >> 32);
        V shift;
        Integers at, four;
        if constexpr (Width == 4) {
            four = Integers{} + low;
            at = Integers{0xff, 0xff00, 0xff0000, 0x7f000000};
            shift = V{1, 0x1p-8f, 0x1p-16f, 0x1p-24f};
        } else {
            four = Integers{low, low, low, low, high, high, high, high};
            at = Integers{0xff, 0xff00, 0xff0000, 0x7f000000, 0xff, 0xff00, 0xff0000, 0x7f000000};
            shift = V{1, 0x1p-8f, 0x1p-16f, 0x1p-24f, 1, 0x1p-8f, 0x1p-16f, 0x1p-24f};
        }
        return __builtin_convertvector(four & at, V) * shift;
    }
    static constexpr std::size_t indexOf(int x, int y) { return std::size_t(64 * x + 8 * y); }

    std::array<float, 640> sums_;
    std::array<EightBytes, 80> weights_;
};

/// The packed voxels of a level set, leaf by leaf.
struct PackedVoxels {
    static constexpr std::size_t kPerLeaf = 512;
    std::unique_ptr<float[]> all;
    std::vector<std::array<std::uint64_t, 8>> known;  ///< bits: the voxels that are packed

    void resize(std::size_t leaves) {
        all = std::make_unique_for_overwrite<float[]>(kPerLeaf * leaves);
        touchPages(all.get(), kPerLeaf * leaves * sizeof(float));
        known.resize(leaves);
    }
    /// @param leaf  with its number in the transient data
    float* valuesOf(const Leaf& leaf) const { return &all[kPerLeaf * leaf.transientData()]; }
    std::uint64_t sliceOf(const Leaf& leaf, int x) const {
        return known[leaf.transientData()][std::size_t(x)];
    }
    static IGEO_INLINE float scaled(float value) { return value; }
    static IGEO_INLINE auto scaled(const Registers<4>::Vector& four) { return four; }
};

/// Gathers psi around a leaf, and packs what the step has done to its voxels with all face
/// neighbors.
/// @param zero  phi = 0, as psi in voxels
template <int Width>
IGEO_INLINE void measureHere(const LeafBlock::Accessor& psi, double dx, float zero,
                             const Leaf& leaf, LeafBlock& block, PackedVoxels& packed) {
    block.gather<Width>(psi, leaf.origin(), dx, LeafBlock::kFaces);
    float* to = packed.valuesOf(leaf);
    for (int x = 0; x < 8; ++x) {
        std::uint64_t known = 0;
        for (int y = 0; y < 8; ++y, to += 8) {
            const unsigned complete = PsiRow<Width>::completeIn(block, x, y);
            known |= std::uint64_t(complete) << (8 * y);
            for (int k = 0; k < 8; k += Width)
                if (complete >> k & ((1u << Width) - 1))
                    storeLanes(StepLanes<Width>(block, x, y, k, zero).packed, to + k);
        }
        packed.known[leaf.transientData()][std::size_t(x)] = known;
    }
}

/// Adds c to the voxels of a leaf, and what the step has taken away at last.
/// @return how many of them are negative then
template <int Width>
IGEO_INLINE unsigned raiseHere(const LeafBlock::Accessor& accessor, const PackedVoxels& packed,
                               float dx, LeafBlock& excess, Leaf& psi) {
    using Step = StepLanes<Width>;
    using V = typename Step::V;
    using Integers = typename Step::Integers;
    const Integers bits = bitPerLane<Width>();
    excess.gather<Width>(accessor, psi.origin(), LeafBlock::kCorners, packed);
    Smoothed<Width> smoothed;
    smoothed.of(excess);
    unsigned negative = 0;
    for (int x = 0; x < 8; ++x)
        for (int y = 0; y < 8; ++y)
            for (int k = 0; k < 8; k += Width) {
                const int at = 64 * x + 8 * y + k;
                const auto active =
                    int(psi.valueMask().getWord<openvdb::Index64>(openvdb::Index(x)) >> (at & 63)) &
                    ((1 << Width) - 1);
                if (!active) continue;
                const V own = loadLanes<Width>(excess.row(x, y) + k),
                        share = Step::shareOfMean(own),
                        all = share * smoothed.mean(x, y, k) + (1 - share) * own;
                const V by = all > 0 ? Step::pull(own) * all * dx : V{};
                float* const to = psi.buffer().data() + at;
                const V value = loadLanes<Width>(to), raised = value + (by + kShift);
                const Integers isActive = ((Integers{} + active) & bits) != 0;
                storeLanes(isActive ? raised : value, to);
                negative += unsigned(std::popcount(bitsOf<Width>(isActive & (raised < 0))));
            }
    return negative;
}

void measureByFour(const LeafBlock::Accessor& psi, double dx, float zero, const Leaf& leaf,
                   LeafBlock& block, PackedVoxels& packed) {
    measureHere<4>(psi, dx, zero, leaf, block, packed);
}
unsigned raiseByFour(const LeafBlock::Accessor& accessor, const PackedVoxels& packed, float dx,
                     LeafBlock& excess, Leaf& psi) {
    return raiseHere<4>(accessor, packed, dx, excess, psi);
}
#ifdef IGEO_AVX2
IGEO_AVX2 void measureByEight(const LeafBlock::Accessor& psi, double dx, float zero,
                              const Leaf& leaf, LeafBlock& block, PackedVoxels& packed) {
    measureHere<8>(psi, dx, zero, leaf, block, packed);
}
IGEO_AVX2 unsigned raiseByEight(const LeafBlock::Accessor& accessor, const PackedVoxels& packed,
                                float dx, LeafBlock& excess, Leaf& psi) {
    return raiseHere<8>(accessor, packed, dx, excess, psi);
}
#endif

/// Measures what the step did, and undoes it: first what is known, then the rest.
class Undo {
public:
    Undo(Tree& psi, double dx) : psi_(psi), dx_(dx), zero_(float(kOffset - double(kShift) / dx)) {
        psi_.getNodes(leaves_);
        for (std::size_t l = 0; l < leaves_.size(); ++l)
            leaves_[l]->setTransientData(openvdb::Index32(l));
        packed_.resize(leaves_.size());
        measureAll();
    }

    Undone run() {
        Undone done;
        done.lowered = restore();
        done.negative = raiseAll();
        return done;
    }
    /// Whether psi in front of hollow edges is what the step makes of the planes of their faces.
    bool isShownByEdges() const {
        constexpr std::size_t kEnough = 16;
        constexpr float kExact = 1e-3f;  // voxels
        constexpr double kMost = 0.5;
        std::size_t all = 0, exact = 0;
        for (const auto& part : lowered_)
            for (const LoweredVoxel& v : part) ++all, exact += v.off < kExact;
        return exact >= kEnough && double(exact) > kMost * double(all);
    }

private:
    void measure(const LeafBlock::Accessor& accessor, const Leaf& leaf, LeafBlock& block) {
#ifdef IGEO_AVX2
        if (eightAtATime()) return measureByEight(accessor, dx_, zero_, leaf, block, packed_);
#endif
        measureByFour(accessor, dx_, zero_, leaf, block, packed_);
    }
    void measureAll() {
        std::vector<HollowEdges::Shown> shown(leaves_.size());
        parallelFor(leaves_.size(), 64, [&](std::size_t begin, std::size_t end) {
            const LeafBlock::Accessor accessor(psi_);
            const auto block = std::make_unique<LeafBlock>();
            for (std::size_t l = begin; l < end; ++l) {
                measure(accessor, *leaves_[l], *block);
                shown[l] = HollowEdges::shownBy(*block);
            }
        });
        lowered_.resize(leaves_.size());
        parallelFor(leaves_.size(), 64, [&](std::size_t begin, std::size_t end) {
            HollowEdges edges(psi_, dx_, shown);
            for (std::size_t l = begin; l < end; ++l) edges.look(*leaves_[l], lowered_[l]);
        });
    }
    /// Gives voxels in front of hollow edges what they had, and measures M beside them again.
    std::size_t restore() {
        std::set<std::size_t> beside;  // leaves
        std::size_t restored = 0;
        for (const auto& part : lowered_)
            for (const LoweredVoxel& v : part) {
                psi_.setValueOnly(v.at, v.was);
                ++restored;
                for (int face = 0; face < 6; ++face) {
                    openvdb::Coord next = v.at;
                    next[face / 2] += face % 2 ? 1 : -1;
                    if (const Leaf* leaf = psi_.probeConstLeaf(next))
                        beside.insert(leaf->transientData());
                }
            }
        const LeafBlock::Accessor accessor(psi_);
        const auto block = std::make_unique<LeafBlock>();
        for (const std::size_t l : beside) measure(accessor, *leaves_[l], *block);
        for (std::size_t l = 0; l < leaves_.size(); ++l)
            for (const LoweredVoxel& v : lowered_[l]) {
                const openvdb::Index at = Leaf::coordToOffset(v.at);
                packed_.known[l][at / 64] &= ~(std::uint64_t(1) << at % 64);
            }
        return restored;
    }
    unsigned raise(const LeafBlock::Accessor& accessor, Leaf& leaf, LeafBlock& block) {
#ifdef IGEO_AVX2
        if (eightAtATime()) return raiseByEight(accessor, packed_, float(dx_), block, leaf);
#endif
        return raiseByFour(accessor, packed_, float(dx_), block, leaf);
    }
    /// @return how many voxels are negative then
    std::uint64_t raiseAll() {
        std::vector<unsigned> negative(leaves_.size());
        parallelFor(leaves_.size(), 64, [&](std::size_t begin, std::size_t end) {
            const LeafBlock::Accessor accessor(psi_);
            const auto block = std::make_unique<LeafBlock>(0.0f);  // what is missing adds nothing
            for (std::size_t l = begin; l < end; ++l)
                negative[l] = raise(accessor, *leaves_[l], *block);
        });
        return std::accumulate(negative.begin(), negative.end(), std::uint64_t(0));
    }

    Tree& psi_;
    double dx_;
    float zero_;
    std::vector<Leaf*> leaves_;  ///< their numbers are in their transient data
    PackedVoxels packed_;
    std::vector<std::vector<LoweredVoxel>> lowered_;  ///< by leaf
};

constexpr std::size_t kEnoughValues = 16;
constexpr double kWithin = 0.4;  ///< voxels: how near to S values are looked at

/// A thousand leaves, or a few more, spread over the tree.
std::vector<const Leaf*> leavesToLookAt(const openvdb::FloatGrid& psi) {
    constexpr std::size_t kLeaves = 1000;
    std::vector<const Leaf*> leaves, some;
    psi.tree().getNodes(leaves);
    for (std::size_t l = 0; l < leaves.size(); l += leaves.size() / kLeaves + 1)
        some.push_back(leaves[l]);
    return some;
}

/// Whether values are as a distance that was computed in single precision: roots less a radius,
/// multiples of the last place of the root. Of what conversions had before their last addition
/// every other value is odd, or all are as far from a multiple: planes whose places have few bits.
/// @param back  what that added
bool areRootsLess(std::vector<float> values, double back) {
    constexpr double kFewOdd = 1 / 8.0, kAlmostAll = 7 / 8.0;
    constexpr unsigned kPlaces = 16;
    std::sort(values.begin(), values.end());
    values.erase(std::unique(values.begin(), values.end()), values.end());
    if (values.size() < kEnoughValues) return false;
    std::size_t odd = 0;
    std::array<std::size_t, kPlaces> off{};  // numbers of values by their place above a multiple
    for (const float value : values) {
        const double place = std::ldexp(1, std::ilogb(double(value) - back) - 23),
                     over = std::fmod(double(value), kPlaces * place) / place;
        odd += std::fmod(over, 2) != 0;
        ++off[unsigned(over + kPlaces) % kPlaces];
    }
    const std::size_t most = *std::max_element(off.begin() + 1, off.end());
    const auto all = double(values.size());
    return double(odd) < kFewOdd * all && double(most) < kAlmostAll * all;
}

}  // namespace

bool isRenormalized(const openvdb::FloatGrid& psi) {
    // Among values with a tenth of the offset, which have three bits more, some coarse ones show
    // nothing.
    constexpr double kNear = 0.1, kAll = 0.99, kFew = 0.5;
    const auto dx = float(psi.transform().voxelSize()[0]), offset = float(kOffset * double(dx)),
               back = offset - kShift;
    std::size_t near = 0, fit = 0, coarse = 0;
    std::vector<float> within;
    for (const Leaf* leaf : leavesToLookAt(psi))
        forActive(*leaf, [&](float at) {
            const double value = double(at), before = value - double(back);
            if (std::abs(value) < kWithin * double(dx) && before < 0) within.push_back(at);
            if (!(std::abs(value) < kNear * double(dx))) return;
            const double coarsest = std::ldexp(16, std::ilogb(before) - 23);
            ++near;
            fit += double(float(before)) == before;
            coarse += std::fmod(value, coarsest) == 0;
        });
    return near >= kEnoughValues && double(fit) > kAll * double(near) &&
           double(coarse) < kFew * double(near) && !areRootsLess(std::move(within), double(back));
}

bool repeatsValues(const openvdb::FloatGrid& psi) {
    constexpr std::size_t kMost = 64;
    const double within = kWithin * psi.transform().voxelSize()[0];
    std::set<float> values;
    for (const Leaf* leaf : leavesToLookAt(psi)) {
        forActive(*leaf, [&](float value) {
            if (std::abs(double(value)) < within && values.size() <= kMost) values.insert(value);
        });
        if (values.size() > kMost) return false;
    }
    return true;
}

bool isInHalfPrecision(const openvdb::FloatGrid& psi) {
    constexpr int kPlaces = 10, kLeastExponent = -14;
    for (const Leaf* leaf : leavesToLookAt(psi)) {
        bool all = true;
        forActive(*leaf, [&](float value) {
            const int exponent = std::max(std::ilogb(value), kLeastExponent);
            all = all && std::fmod(double(value), std::ldexp(1, exponent - kPlaces)) == 0;
        });
        if (!all) return false;
    }
    return !repeatsValues(psi);
}

Undone undoRenormalization(openvdb::FloatGrid& psi, double dx) {
    return Undo(psi.tree(), dx).run();
}

std::optional<Undone> undoIfEdgesShow(openvdb::FloatGrid& psi, double dx) {
    Undo undo(psi.tree(), dx);
    return undo.isShownByEdges() ? std::optional(undo.run()) : std::nullopt;
}

}  // namespace igeo
