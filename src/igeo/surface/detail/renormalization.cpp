#include <igeo/surface/detail/renormalization.h>

#include <igeo/base/parallel.h>
#include <igeo/surface/detail/hollow_edges.h>
#include <igeo/surface/detail/leaf_block.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <set>
#include <vector>

namespace igeo {

namespace {

using Tree = openvdb::FloatTree;
using Leaf = LeafBlock::Leaf;
using Four = Registers<4>::Vector;

constexpr double kOffset = kRenormalizedAbout;  ///< voxels: phi = psi - kOffset
constexpr float kShift = 1e-7f;                 ///< world units: what the step takes away at last
constexpr float kMissing = std::numeric_limits<float>::quiet_NaN();
constexpr float kLeastExcess = -0.05f;  ///< M, where it is less and
constexpr float kMostExcess = 0.5f;     ///< more

/// What the step has done to four voxels of a row, in one number each: M in its first 16 bits, |S|
/// and the share of the mean of M in a byte each. A sum of such numbers is one of M.
struct StepLanes {
    Four packed;  ///< NaN where a neighbor is missing

    /// @param from  the first of them
    /// @param zero  phi = 0, as psi in voxels
    IGEO_INLINE StepLanes(const LeafBlock& block, int x, int y, int from, float zero) {
        auto phi = [&](int i, int j, int k) {
            return loadLanes<4>(block.row(x + i, y + j) + from + k) - zero;
        };
        const Four here = phi(0, 0, 0), side = here > 0 ? Four{} + 1 : Four{} - 1;
        Four square{}, shares{}, all = here;
        auto add = [&](const Four& low, const Four& high) {
            const Four toLow = side * (here - low), toHigh = side * (here - high);
            const Four step = above(toLow > toHigh ? toLow : toHigh, 0);
            square += step * step, shares += step, all += low + high;
        };
        add(phi(-1, 0, 0), phi(1, 0, 0)), add(phi(0, -1, 0), phi(0, 1, 0));
        add(phi(0, 0, -1), phi(0, 0, 1));
        constexpr float kTiny = 1e-6f, kRoom = 0.1f;
        // phi at the upwind neighbors, in the mean.
        const Four upwind = here - side * square / above(shares, kTiny);
        Four gradient = square, root = here * here + square, upwindRoot = upwind * upwind + 1;
        takeRoots<4>(gradient), takeRoots<4>(root), takeRoots<4>(upwindRoot);
        const Four pull = absolute(here) / above(root, kTiny),
                   share = shares / above(gradient, kTiny),
                   fall = pull - absolute(upwind) / upwindRoot,
                   excess = side * (gradient - 1) / above(1 - share * fall, kRoom);
        // Where the mean stands for M; where psi contradicts itself, and stays as it is.
        constexpr float kSteep = 0.7f, kSteepest = 1, kSure = 0.3f, kFold = 1.0f, kDoubtful = 0.7f;
        const Four steep = (pull * share - kSteep) / (kSteepest - kSteep),
                   large = (excess - kSure) / (kMostExcess - kSure);
        const Four trust = below(above((kFold - excess) / (kFold - kDoubtful), 0), 1);
        const Four value = pack(below(above(excess, kLeastExcess), kMostExcess), trust * pull,
                                steep > large ? steep : large);
        packed = all == all ? value : Four{} + kMissing;
    }
    using Integers = Registers<4>::Integers;

    static IGEO_INLINE Four pull(const Four& packed) { return byte(packed, 8); }
    static IGEO_INLINE Four shareOfMean(const Four& packed) { return byte(packed, 0); }

private:
    static IGEO_INLINE Four above(const Four& v, float least) {
        return v > least ? v : Four{} + least;
    }
    static IGEO_INLINE Four below(const Four& v, float most) {
        return v < most ? v : Four{} + most;
    }
    static IGEO_INLINE Four byte(const Four& packed, int shift) {
        return __builtin_convertvector((loadAs<Integers>(&packed) >> shift) & 255, Four) *
               (1 / 255.0f);
    }
    static IGEO_INLINE Integers toByte(const Four& v) {
        return __builtin_convertvector(below(above(v, 0), 1) * 255.0f + 0.5f, Integers);
    }
    static IGEO_INLINE Four pack(const Four& excess, const Four& pull, const Four& share) {
        const Integers bits =
            (loadAs<Integers>(&excess) & ~0xffff) | toByte(pull) << 8 | toByte(share);
        return loadAs<Four>(&bits);
    }
};

/// Means over the 27 voxels around each of a leaf, weighted 1, 2, 1 along each axis; missing ones
/// do not count.
class Smoothed {
public:
    void of(const LeafBlock& block) {
        for (int x = 0; x < 10; ++x)
            for (int y = 0; y < 10; ++y) {
                const float* row = block.row(x - 1, y - 1);
                for (int k = 0; k < 8; k += 4) {
                    Four sum{}, weight{};
                    for (int z = -1; z <= 1; ++z) {
                        const Four v = loadLanes<4>(row + k + z), one = Four{} + (z ? 1.0f : 2.0f);
                        sum += v == v ? one * v : Four{};
                        weight += v == v ? one : Four{};
                    }
                    at(x, y, k) = {sum, weight};
                }
            }
        // In place: what is read lies ahead of what is written.
        for (int x = 0; x < 10; ++x)
            for (int y = 0; y < 8; ++y)
                for (int k = 0; k < 8; k += 4)
                    at(x, y, k) = at(x, y, k) + at(x, y + 1, k) + at(x, y + 1, k) + at(x, y + 2, k);
        for (int x = 0; x < 8; ++x)
            for (int y = 0; y < 8; ++y)
                for (int k = 0; k < 8; k += 4)
                    at(x, y, k) = at(x, y, k) + at(x + 1, y, k) + at(x + 1, y, k) + at(x + 2, y, k);
    }
    /// At four voxels of a row.
    IGEO_INLINE Four mean(int x, int y, int from) const {
        const Sums& s = sums_[indexOf(x, y, from)];
        return s.sum / (s.weight > 0 ? s.weight : Four{} + 1);
    }

private:
    struct Sums {
        Four sum, weight;
        IGEO_INLINE Sums operator+(const Sums& o) const { return {sum + o.sum, weight + o.weight}; }
    };
    static std::size_t indexOf(int x, int y, int k) {
        return std::size_t((x * 10 + y) * 2 + k / 4);
    }
    Sums& at(int x, int y, int k) { return sums_[indexOf(x, y, k)]; }

    std::array<Sums, 200> sums_;
};

/// Undoes the step: first what is known, then the rest.
class Undo {
public:
    Undo(Tree& psi, double dx) : psi_(psi), dx_(dx), zero_(float(kOffset - double(kShift) / dx)) {
        psi_.getNodes(leaves_);
        for (std::size_t l = 0; l < leaves_.size(); ++l)
            leaves_[l]->setTransientData(openvdb::Index32(l));
        resizeByAll(packed_, kPerLeaf * leaves_.size());
    }

    std::size_t run() {
        measureAll();
        const std::size_t count = restore();
        raiseAll();
        return count;
    }

private:
    static constexpr std::size_t kPerLeaf = 512;

    /// What StepLanes packs, or NaN, at the voxels of a leaf.
    float* packedOf(const Leaf& leaf) { return &packed_[kPerLeaf * leaf.transientData()]; }

    void measure(const LeafBlock& block, const Leaf& leaf) {
        for (int x = 0; x < 8; ++x)
            for (int y = 0; y < 8; ++y)
                for (int k = 0; k < 8; k += 4)
                    if (block.active(x, y) >> (k + 1) & 15)
                        storeLanes(StepLanes(block, x, y, k, zero_).packed,
                                   packedOf(leaf) + 64 * x + 8 * y + k);
    }
    void measureAll() {
        lowered_.resize(leaves_.size());
        parallelFor(leaves_.size(), 64, [&](std::size_t begin, std::size_t end) {
            const LeafBlock::Accessor accessor(psi_);
            const auto block = std::make_unique<LeafBlock>();
            HollowEdges edges(psi_, dx_);
            for (std::size_t l = begin; l < end; ++l) {
                const openvdb::Coord origin = leaves_[l]->origin();
                block->gather(accessor, origin, dx_, LeafBlock::kFaces);
                measure(*block, *leaves_[l]);
                edges.look(*block, origin, lowered_[l]);
            }
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
        for (const std::size_t l : beside) {
            block->gather(accessor, leaves_[l]->origin(), dx_, LeafBlock::kFaces);
            measure(*block, *leaves_[l]);
        }
        for (std::size_t l = 0; l < leaves_.size(); ++l)
            for (const LoweredVoxel& v : lowered_[l])
                packedOf(*leaves_[l])[Leaf::coordToOffset(v.at)] = kMissing;
        return restored;
    }
    /// Adds c to the voxels of a leaf, and what the step has taken away at last.
    void raise(const LeafBlock& excess, const Smoothed& smoothed, Leaf& psi) const {
        const auto dx = float(dx_);
        for (int x = 0; x < 8; ++x)
            for (int y = 0; y < 8; ++y)
                for (int k = 0; k < 8; k += 4) {
                    const int at = 64 * x + 8 * y + k;
                    const auto active = int(
                        psi.valueMask().getWord<openvdb::Index64>(openvdb::Index(x)) >> (at & 63) &
                        15);
                    if (!active) continue;
                    const Four own = loadLanes<4>(excess.row(x, y) + k),
                               share = StepLanes::shareOfMean(own),
                               all = share * smoothed.mean(x, y, k) + (1 - share) * own;
                    // NaN where M is missing.
                    const Four by = all > 0 ? StepLanes::pull(own) * all * dx : Four{};
                    float* const to = psi.buffer().data() + at;
                    const Four value = loadLanes<4>(to);
                    const StepLanes::Integers isActive =
                        ((StepLanes::Integers{} + active) & StepLanes::Integers{1, 2, 4, 8}) != 0;
                    storeLanes(isActive ? value + (by + kShift) : value, to);
                }
    }
    void raiseAll() {
        parallelFor(leaves_.size(), 64, [&](std::size_t begin, std::size_t end) {
            const LeafBlock::Accessor accessor(psi_);
            const auto block = std::make_unique<LeafBlock>();
            const auto smoothed = std::make_unique<Smoothed>();
            for (std::size_t l = begin; l < end; ++l) {
                block->gather(accessor, leaves_[l]->origin(), 1, LeafBlock::kCorners,
                              [&](const Leaf& leaf) { return packedOf(leaf); });
                smoothed->of(*block);
                raise(*block, *smoothed, *leaves_[l]);
            }
        });
    }

    Tree& psi_;
    double dx_;
    float zero_;
    std::vector<Leaf*> leaves_;  ///< their numbers are in their transient data
    std::vector<float> packed_;
    std::vector<std::vector<LoweredVoxel>> lowered_;  ///< by leaf
};

}  // namespace

bool isRenormalized(const openvdb::FloatGrid& psi) {
    // Among values with a tenth of the offset, which have three bits more, some coarse ones show
    // nothing.
    constexpr double kNear = 0.1, kAll = 0.99, kFew = 0.5;
    constexpr std::size_t kEnough = 16, kLeaves = 1000;
    const auto dx = float(psi.transform().voxelSize()[0]), offset = float(kOffset * double(dx)),
               back = offset - kShift;
    std::vector<const Leaf*> leaves;
    psi.tree().getNodes(leaves);
    std::size_t near = 0, fit = 0, coarse = 0;
    for (std::size_t l = 0; l < leaves.size(); l += leaves.size() / kLeaves + 1)
        for (auto it = leaves[l]->cbeginValueOn(); it; ++it) {
            const double value = double(*it), before = value - double(back);
            if (!(std::abs(value) < kNear * double(dx))) continue;
            const double coarsest = std::ldexp(16, std::ilogb(before) - 23);
            ++near;
            fit += double(float(before)) == before;
            coarse += std::fmod(value, coarsest) == 0;
        }
    return near >= kEnough && double(fit) > kAll * double(near) &&
           double(coarse) < kFew * double(near);
}

std::size_t undoRenormalization(openvdb::FloatGrid& psi, double dx) {
    return Undo(psi.tree(), dx).run();
}

}  // namespace igeo
