/// psi around one leaf, gathered once so that stencils read an array. Internal.
#pragma once

#include <igeo/band/band.h>
#include <igeo/base/detail/registers.h>
#include <igeo/base/symmetric_eigen.h>
#include <igeo/base/types.h>
#include <openvdb/openvdb.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

namespace igeo {

/// psi of an inactive voxel.
constexpr float kMissingVoxel = std::numeric_limits<float>::quiet_NaN();

/// psi in voxel units at its active voxels.
struct PsiInVoxels {
    using Leaf = openvdb::FloatTree::LeafNodeType;
    double perDx;  ///< one over the voxel size

    IGEO_INLINE const float* valuesOf(const Leaf& leaf) const { return leaf.buffer().data(); }
    /// Bits: the voxels of a slice that have a value.
    IGEO_INLINE std::uint64_t sliceOf(const Leaf& leaf, int x) const {
        return leaf.valueMask().getWord<openvdb::Index64>(openvdb::Index(x));
    }
    IGEO_INLINE float scaled(float value) const { return float(value * perDx); }
    IGEO_INLINE auto scaled(const Registers<4>::Vector& four) const {
        typedef double Doubles __attribute__((vector_size(32)));
        const Doubles times = __builtin_convertvector(four, Doubles) * perDx;
        return __builtin_convertvector(times, Registers<4>::Vector);
    }
};

/// Copies voxels of a row as `from` scales them. Without branches: half of the rows have voxels of
/// both kinds.
/// @param active   bits: which of them are
/// @param missing  for those that are not
template <int Width, typename From>
IGEO_INLINE void copyLanes(const From& from, const float* values, unsigned active, float missing,
                           float* to) {
    using V = typename Registers<Width>::Vector;
    using Integers = typename Registers<Width>::Integers;
    V all;
    if constexpr (Width == 4)
        all = from.scaled(loadLanes<4>(values));
    else
        all =
            __builtin_shufflevector(from.scaled(loadLanes<4>(values)),
                                    from.scaled(loadLanes<4>(values + 4)), 0, 1, 2, 3, 4, 5, 6, 7);
    const Integers isActive = ((Integers{} + int(active)) & bitPerLane<Width>()) != 0;
    storeLanes(isActive ? all : V{} + missing, to);
}

/// From a value to the next along each axis.
using CellSteps = std::array<std::size_t, 3>;

/// The trilinear interpolant of values.
/// @param low  the one at the low corner of the cell
/// @param t    the place in the cell
inline double interpolate(const float* low, const CellSteps& step, const Vec3d& t) {
    auto along = [&](const float* from) {
        return double(*from) + t.z * (double(from[step[2]]) - double(*from));
    };
    auto across = [&](const float* from) {
        const double first = along(from);
        return first + t.y * (along(from + step[1]) - first);
    };
    const double first = across(low);
    return first + t.x * (across(low + step[0]) - first);
}

/// The 10^3 voxels of a leaf and one voxel around it.
class LeafBlock {
public:
    using Leaf = openvdb::FloatTree::LeafNodeType;
    using Accessor = openvdb::tree::ValueAccessor<const openvdb::FloatTree, false>;

    /// @param missing  of voxels without a value
    explicit LeafBlock(float missing = kMissingVoxel) : missing_(missing) {}

    /// How much is gathered beyond the leaf: enough for differences along the axes, for second
    /// differences in two axes, or all.
    enum Beyond { kFaces = 1, kEdges = 2, kCorners = 3 };
    /// psi in voxel units, `Width` voxels at a time.
    /// @param dx  voxel size in world units
    template <int Width = 4>
    IGEO_INLINE void gather(const Accessor& psi, const openvdb::Coord& origin, double dx,
                            Beyond beyond = kCorners) {
        gather<Width>(psi, origin, beyond, PsiInVoxels{1 / dx});
    }
    /// Other values of the leaves of psi.
    /// @param from  has what PsiInVoxels has
    template <int Width, typename From>
    IGEO_INLINE void gather(const Accessor& psi, const openvdb::Coord& origin, Beyond beyond,
                            const From& from) {
        for (int x = -1; x <= 1; ++x)
            for (int y = -1; y <= 1; ++y)
                if (const int off = std::abs(x) + std::abs(y); off <= beyond)
                    copyColumn<Width>(psi, origin.offsetBy(8 * x, 8 * y, 0), {x, y, 0},
                                      off < beyond, from);
    }

    /// The value at voxel (x, y, z) of the leaf, each in [-1, 8].
    double at(int x, int y, int z) const { return row(x, y)[z]; }
    /// Between them, each in [-1, 8).
    double at(const Vec3d& p) const {
        const Ijk cell = floorToIjk(p);
        return interpolate(row(cell.x, cell.y) + cell.z, {100, 10, 1}, p - Vec3d(cell));
    }
    /// Those at the voxels (x, y, -1) to (x, y, 8), at indices -1 to 8.
    const float* row(int x, int y) const {
        return &values_[std::size_t(100 * (x + 1) + 10 * (y + 1) + 1)];
    }
    /// Which of these voxels have one: bit z + 1.
    unsigned active(int x, int y) const { return active_[std::size_t(10 * (x + 1) + y + 1)]; }

private:
    /// Slice of the leaf at step s that lies in the block, as [begin, end) of leaf coordinates.
    static int first(int s) { return s < 0 ? 7 : 0; }
    static int last(int s) { return s > 0 ? 1 : 8; }

    /// A leaf, or voxels without values.
    template <typename From>
    struct Source {
        const float* values;
        const Leaf* leaf;
        const From& from;
        Source(const Leaf* l, const From& f) : leaf(l), from(f) {
            static constexpr std::array<float, 512> kEmpty{};
            values = l ? f.valuesOf(*l) : kEmpty.data();
        }
        std::uint64_t slice(int x) const { return leaf ? from.sliceOf(*leaf, x) : 0; }
    };

    /// Copies the rows of a leaf that lie in the block.
    /// @param s         steps from the leaf of the block
    /// @param withEnds  with the voxels before and after them, from the leaves there
    template <int Width, typename From>
    IGEO_INLINE void copyColumn(const Accessor& psi, const openvdb::Coord& origin, const Ijk& s,
                                bool withEnds, const From& from) {
        const Source<From> here(psi.probeConstLeaf(origin), from),
            low(withEnds ? psi.probeConstLeaf(origin.offsetBy(0, 0, -8)) : nullptr, from),
            high(withEnds ? psi.probeConstLeaf(origin.offsetBy(0, 0, 8)) : nullptr, from);
        for (int x = first(s.x); x < last(s.x); ++x) {
            int at = 10 * (x + 8 * s.x + 1) + first(s.y) + 8 * s.y + 1,
                begin = 64 * x + 8 * first(s.y);
            // From the row `begin` on.
            std::uint64_t slice = here.slice(x) >> (begin & 63),
                          lows = low.slice(x) >> (begin & 63) >> 7,
                          highs = high.slice(x) >> (begin & 63);
            for (int y = first(s.y); y < last(s.y);
                 ++y, ++at, begin += 8, slice >>= 8, lows >>= 8, highs >>= 8) {
                const auto bits = unsigned(slice & 0xff), isLow = unsigned(lows & 1),
                           isHigh = unsigned(highs & 1), active = bits << 1 | isLow | isHigh << 9;
                active_[std::size_t(at)] = std::uint16_t(active);
                float* row = &values_[std::size_t(10 * at)];
                for (int k = 0; k < 8; k += Width)
                    copyLanes<Width>(from, here.values + begin + k, bits >> k, missing_,
                                     row + 1 + k);
                std::array<float, 4> ends{low.values[begin + 7], high.values[begin]};
                copyLanes<4>(from, ends.data(), isLow | isHigh << 1, missing_, ends.data());
                row[0] = ends[0], row[9] = ends[1];
            }
        }
    }

    float missing_;
    std::array<float, 1000> values_;
    std::array<std::uint16_t, 100> active_;
};

/// Calls visit(value) for the active voxels of a leaf. OpenVDB's iterator is not inlined.
template <typename Visit>
IGEO_INLINE void forActive(const LeafBlock::Leaf& leaf, const Visit& visit) {
    const float* values = leaf.buffer().data();
    for (openvdb::Index x = 0; x < 8; ++x)
        for (auto bits = leaf.valueMask().getWord<openvdb::Index64>(x); bits; bits &= bits - 1)
            visit(values[64 * x + openvdb::Index(std::countr_zero(bits))]);
}

/// Eight numbers, one per voxel of a row.
using RowNumbers = std::array<float, 8>;

/// Bits: the voxels of a row with |value| < limit.
template <int Width>
IGEO_INLINE unsigned within(const float* values, float limit) {
    unsigned bits = 0;
    for (std::size_t k = 0; k < 8; k += Width)
        bits |= bitsOf<Width>(absolute(loadLanes<Width>(values + k)) < limit) << k;
    return bits;
}

/// Differences of psi at the eight voxels of a row, in single precision, `Width` at a time.
template <int Width = 4>
struct PsiRow {
    unsigned active, complete;  ///< bits by z; differences are valid for complete ones
    unsigned smooth;            ///< bits: the same as PsiDifferences::smooth, up to rounding
    RowNumbers dx, dy, dz;      ///< psi at the next voxel less psi at the one before
    RowNumbers slope;           ///< length of the central differences

    IGEO_INLINE PsiRow(const LeafBlock& b, int x, int y)
        : active(b.active(x, y) >> 1 & 0xff), complete(completeIn(b, x, y)), smooth(0) {
        const float *row = b.row(x, y), *x0 = b.row(x - 1, y), *x1 = b.row(x + 1, y),
                    *y0 = b.row(x, y - 1), *y1 = b.row(x, y + 1), *z0 = row - 1, *z1 = row + 1;
        for (std::size_t k = 0; k < 8; k += Width) {
            using V = typename Registers<Width>::Vector;
            const V alongX = loadLanes<Width>(x1 + k) - loadLanes<Width>(x0 + k),
                    alongY = loadLanes<Width>(y1 + k) - loadLanes<Width>(y0 + k),
                    alongZ = loadLanes<Width>(z1 + k) - loadLanes<Width>(z0 + k);
            V square = 0.25f * (alongX * alongX + alongY * alongY + alongZ * alongZ);
            smooth |= bitsOf<Width>(isSmooth(square)) << k;
            takeRoots<Width>(square);
            storeLanes(alongX, &dx[k]), storeLanes(alongY, &dy[k]), storeLanes(alongZ, &dz[k]),
                storeLanes(square, &slope[k]);
        }
        smooth &= complete;
    }
    /// Bits: the voxels of a row with all face neighbors.
    static IGEO_INLINE unsigned completeIn(const LeafBlock& b, int x, int y) {
        const unsigned here = b.active(x, y);
        return 0xff & here >> 1 & here & here >> 2 &
               (b.active(x - 1, y) & b.active(x + 1, y) & b.active(x, y - 1) &
                b.active(x, y + 1)) >>
                   1;
    }
    /// @param square  of the length of the central differences
    template <typename V>
    static IGEO_INLINE auto isSmooth(const V& square) {
        constexpr float kLeast = float((1 - kSmooth) * (1 - kSmooth)),
                        kMost = float((1 + kSmooth) * (1 + kSmooth));
        return (square > kLeast) & (square < kMost);
    }
    static constexpr double kSmooth = 0.1;
};

/// Differences of psi at a voxel of a block, along each axis.
struct PsiDifferences {
    Vec3d backward, forward;  ///< NaN where the neighbor is missing

    PsiDifferences(const LeafBlock& b, int x, int y, int z) {
        const double c = b.at(x, y, z);
        backward = {c - b.at(x - 1, y, z), c - b.at(x, y - 1, z), c - b.at(x, y, z - 1)};
        forward = {b.at(x + 1, y, z) - c, b.at(x, y + 1, z) - c, b.at(x, y, z + 1) - c};
    }
    bool complete() const { return !std::isnan(dot(backward, forward)); }
    Vec3d central() const { return 0.5 * (backward + forward); }
    /// Second difference along an axis, of |psi| where `side` is the sign of psi.
    double bend(int axis, double side) const { return side * (forward[axis] - backward[axis]); }
    /// Laplacian of |psi|: the curvature 1 / r + 1 / r' of its level set on the round side.
    double laplacian(double side) const { return bend(0, side) + bend(1, side) + bend(2, side); }
    /// Whether psi has no kink here: no crease, no medial axis.
    bool smooth() const {
        return complete() && std::abs(length(central()) - 1) < PsiRow<>::kSmooth;
    }
};

/// Largest |principal curvature| of S at the foot points of the eight voxels of a row, from the
/// Hessian H of psi: the eigenvalues of P H P, P = I - n n^T, moved from psi to 0 by
/// k / (1 - psi k). NaN where a neighbor is missing.
struct RowCurvatures {
    RowNumbers largest;

    IGEO_INLINE RowCurvatures(const LeafBlock& b, int x, int y) {
        const float *row = b.row(x, y), *x0 = b.row(x - 1, y), *x1 = b.row(x + 1, y),
                    *y0 = b.row(x, y - 1), *y1 = b.row(x, y + 1), *x0y0 = b.row(x - 1, y - 1),
                    *x0y1 = b.row(x - 1, y + 1), *x1y0 = b.row(x + 1, y - 1),
                    *x1y1 = b.row(x + 1, y + 1);
        RowNumbers half, apart2;  // half the trace of P H P; (k - k')^2 / 4
        for (int z = 0; z < 8; ++z) {
            const float c2 = 2 * row[z], gx = x1[z] - x0[z], gy = y1[z] - y0[z],
                        gz = row[z + 1] - row[z - 1], g2 = gx * gx + gy * gy + gz * gz;
            const float xx = x1[z] + x0[z] - c2, yy = y1[z] + y0[z] - c2,
                        zz = row[z + 1] + row[z - 1] - c2,
                        xy = 0.25f * (x1y1[z] - x1y0[z] - x0y1[z] + x0y0[z]),
                        xz = 0.25f * (x1[z + 1] - x1[z - 1] - x0[z + 1] + x0[z - 1]),
                        yz = 0.25f * (y1[z + 1] - y1[z - 1] - y0[z + 1] + y0[z - 1]);
            const float hx = xx * gx + xy * gy + xz * gz, hy = xy * gx + yy * gy + yz * gz,
                        hz = xz * gx + yz * gy + zz * gz;
            const float nhn = (gx * hx + gy * hy + gz * hz) / g2,
                        hn2 = (hx * hx + hy * hy + hz * hz) / g2;
            const float trace = xx + yy + zz - nhn,
                        squares = xx * xx + yy * yy + zz * zz +
                                  2 * (xy * xy + xz * xz + yz * yz - hn2) + nhn * nhn;
            half[std::size_t(z)] = 0.5f * trace;
            apart2[std::size_t(z)] = 0.5f * squares - 0.25f * trace * trace;
        }
        for (std::size_t z = 0; z < 8; ++z) {
            const float apart = std::sqrt(std::max(apart2[z], 0.0f));
            auto atFoot = [&](float k) { return std::abs(k) / std::max(1 - row[z] * k, 0.1f); };
            largest[z] = std::max(atFoot(half[z] - apart), atFoot(half[z] + apart));
        }
    }
};

/// Whether a neighbor is missing where the level set should have one: S is cut at this voxel.
/// @param psi, halfWidth  voxels
inline bool cutBeside(const PsiDifferences& d, double psi, double halfWidth) {
    return !d.complete() && std::abs(psi) + 1.01 < halfWidth;
}

/// grad psi by differences that belong to one face.
///
/// Central differences are of second order. Around a crease |psi| is convex on the side where its
/// level sets are round: their direction changes fast, but the central difference has the right
/// direction. On the other side |psi| has a concave kink, the medial axis. There a central
/// difference mixes two faces (|grad psi| < 1), so each axis takes the side for which the length of
/// the gradient is closest to 1. Where the kink is slight along an axis, that tells the faces apart
/// and the central difference is kept: it may be a curve. Where one neighbor is missing the other
/// side is used; an axis without either gives 0. A central difference longer than 1 belongs to no
/// distance: at the rim of an open surface psi grows beyond the rim too, and the axis takes one
/// side.
inline Vec3d psiGradient(const PsiDifferences& d, double psi) {
    const Vec3d central = d.central();
    if (d.smooth()) return central;

    // Changes of |grad psi| from one voxel to the next; kRim is 2.5 standard deviations of a noise
    // of 0.1 voxels.
    constexpr double kKink = 0.1, kRim = 0.6;
    constexpr double kLonger = 1.03;
    const bool longer = length(central) > kLonger;
    std::array<double, 3> bend;
    for (int a = 0; a < 3; ++a) bend[std::size_t(a)] = d.bend(a, psi < 0 ? -1 : 1);
    auto atRim = [&](std::size_t a) { return longer && bend[a] > kRim; };
    std::array<std::array<double, 3>, 3> options;
    for (int a = 0; a < 3; ++a) {
        const auto axis = std::size_t(a);
        const double none = std::numeric_limits<double>::quiet_NaN();
        options[axis] = {central[a], d.backward[a], d.forward[a]};
        if (bend[axis] >= 0 && !atRim(axis)) options[axis] = {central[a], none, none};
        if (std::isnan(d.backward[a]) && std::isnan(d.forward[a])) options[axis] = {0, none, none};
    }
    Vec3d best{};
    double bestMisfit = kInfinity;
    for (std::size_t choice = 0; choice < 27; ++choice) {
        // Central first on every axis: it wins ties. NaN never wins.
        const Vec3d g{options[0][choice / 9], options[1][choice / 3 % 3], options[2][choice % 3]};
        const double misfit = std::abs(length(g) - 1);
        if (misfit < bestMisfit) bestMisfit = misfit, best = g;
    }
    for (int a = 0; a < 3; ++a)
        if (bend[std::size_t(a)] > -kKink && !atRim(std::size_t(a))) best[a] = central[a];
    return best;
}

}  // namespace igeo
