/// psi around one leaf, gathered once so that stencils need no look-ups. Internal.
#pragma once

#include <igeo/band/band.h>
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

/// The 10^3 voxels of a leaf and one voxel around it, in voxel units; NaN where inactive.
class LeafBlock {
public:
    using Leaf = openvdb::FloatTree::LeafNodeType;
    using Accessor = openvdb::tree::ValueAccessor<const openvdb::FloatTree, false>;

    /// What is gathered beyond the leaf: enough for differences along the axes, for second ones of
    /// two axes, or all.
    enum Beyond { kFaces = 1, kEdges = 2, kCorners = 3 };
    /// @param dx divides the values: voxel size in world units
    void gather(const Accessor& psi, const openvdb::Coord& origin, double dx,
                Beyond beyond = kCorners) {
        for (int x = -1; x <= 1; ++x)
            for (int y = -1; y <= 1; ++y)
                for (int z = -1; z <= 1; ++z)
                    if (std::abs(x) + std::abs(y) + std::abs(z) <= beyond)
                        copyFrom(psi, origin, {x, y, z}, 1 / dx);
    }

    /// psi at voxel (x, y, z) of the leaf, each in [-1, 8].
    double at(int x, int y, int z) const { return row(x, y)[z]; }
    /// psi at the voxels (x, y, -1) to (x, y, 8), at -1 to 8.
    const float* row(int x, int y) const {
        return &values_[std::size_t(100 * (x + 1) + 10 * (y + 1) + 1)];
    }
    /// Which of them are active: bit z + 1.
    unsigned active(int x, int y) const { return active_[std::size_t(10 * (x + 1) + y + 1)]; }

private:
    static constexpr float kMissing = std::numeric_limits<float>::quiet_NaN();

    /// Slice of the leaf at step s that lies in the block, as [begin, end) of leaf coordinates.
    static int first(int s) { return s < 0 ? 7 : 0; }
    static int last(int s) { return s > 0 ? 1 : 8; }

    void copyFrom(const Accessor& psi, const openvdb::Coord& origin, const Ijk& s, double scale) {
        const Leaf* leaf = psi.probeConstLeaf(origin.offsetBy(8 * s.x, 8 * s.y, 8 * s.z));
        static constexpr std::array<float, 512> kEmpty{};
        const float* from = leaf ? leaf->buffer().data() : kEmpty.data();
        for (int x = first(s.x); x < last(s.x); ++x) {
            const std::uint64_t slice =
                leaf ? leaf->valueMask().getWord<openvdb::Index64>(openvdb::Index(x)) : 0;
            for (int y = first(s.y); y < last(s.y); ++y) {
                const float* in = from + 64 * x + 8 * y;
                const unsigned bits = slice >> (8 * y) & 0xff;
                const auto row = std::size_t(10 * (x + 8 * s.x + 1) + y + 8 * s.y + 1);
                float* to = &values_[10 * row + 1];
                if (s.z == 0) {
                    active_[row] = std::uint16_t((active_[row] & 0x201u) | bits << 1);
                    copyRow(in, bits, scale, to);
                } else if (s.z < 0) {
                    active_[row] = std::uint16_t((active_[row] & ~1u) | bits >> 7);
                    to[-1] = bits >> 7 ? float(in[7] * scale) : kMissing;
                } else {
                    active_[row] = std::uint16_t((active_[row] & ~0x200u) | (bits & 1) << 9);
                    to[8] = bits & 1 ? float(in[0] * scale) : kMissing;
                }
            }
        }
    }
    /// Per set of active voxels, ones where there is one.
    static constexpr auto kMasks = [] {
        std::array<std::array<std::uint32_t, 8>, 256> masks{};
        for (std::size_t set = 0; set < 256; ++set)
            for (std::size_t z = 0; z < 8; ++z) masks[set][z] = set >> z & 1 ? ~0u : 0u;
        return masks;
    }();
    /// Without branches: half of the rows hold voxels of both kinds.
    static void copyRow(const float* from, unsigned active, double scale, float* to) {
        constexpr auto kNaN = std::bit_cast<std::uint32_t>(kMissing);
        const std::array<std::uint32_t, 8>& mask = kMasks[active];
        std::array<float, 8> scaled;
        for (std::size_t z = 0; z < 8; ++z) scaled[z] = float(from[z] * scale);
        const auto bits = std::bit_cast<std::array<std::uint32_t, 8>>(scaled);
        std::array<std::uint32_t, 8> out;
        for (std::size_t z = 0; z < 8; ++z) out[z] = (bits[z] & mask[z]) | (kNaN & ~mask[z]);
        std::copy_n(std::bit_cast<std::array<float, 8>>(out).begin(), 8, to);
    }

    std::array<float, 1000> values_;
    std::array<std::uint16_t, 100> active_{};
};

/// Differences of psi at the eight voxels of a row, side by side: where they are complete, those of
/// PsiDifferences bit by bit.
struct PsiRow {
    unsigned active, complete;              ///< bits by z
    std::array<double, 8> x, y, z, slope2;  ///< central differences, squared length
    std::array<double, 8> laplacian;        ///< of psi

    PsiRow(const LeafBlock& b, int atX, int atY) {
        const unsigned here = b.active(atX, atY);
        active = here >> 1 & 0xff;
        complete = active & here & here >> 2 &
                   (b.active(atX - 1, atY) & b.active(atX + 1, atY) & b.active(atX, atY - 1) &
                    b.active(atX, atY + 1)) >>
                       1;
        if (active == 0) return;
        const float* row = b.row(atX, atY);
        for (std::size_t k = 0; k < 8; ++k) laplacian[k] = 0;
        addAxis(b.row(atX - 1, atY), row, b.row(atX + 1, atY), x);
        addAxis(b.row(atX, atY - 1), row, b.row(atX, atY + 1), y);
        addAxis(row - 1, row, row + 1, z);
        for (std::size_t k = 0; k < 8; ++k) slope2[k] = x[k] * x[k] + y[k] * y[k] + z[k] * z[k];
    }
    Vec3d central(std::size_t k) const { return {x[k], y[k], z[k]}; }
    double slope(std::size_t k) const { return std::sqrt(slope2[k]); }
    /// PsiDifferences::smooth.
    bool smooth(std::size_t k) const { return smooth(k, slope(k)); }
    bool smooth(std::size_t k, double itsSlope) const {
        return complete >> k & 1 && std::abs(itsSlope - 1) < kSmooth;
    }
    static constexpr double kSmooth = 0.1;

private:
    void addAxis(const float* before, const float* at, const float* after,
                 std::array<double, 8>& central) {
        for (std::size_t k = 0; k < 8; ++k) {
            const double v = at[k], back = v - before[k], ahead = after[k] - v;
            central[k] = 0.5 * (back + ahead);
            laplacian[k] += ahead - back;
        }
    }
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
    /// No kink of psi here: no crease, no medial axis.
    bool smooth() const { return complete() && std::abs(length(central()) - 1) < PsiRow::kSmooth; }
};

/// Calls visit(x, y, bits) for the rows of a leaf that hold nodes of the band, in their order.
template <typename Visit>
void forRows(const BandLeaf& leaf, const Visit& visit) {
    for (int x = 0; x < 8; ++x)
        for (int y = 0; y < 8; ++y)
            if (const unsigned bits = leaf.band.mask[std::size_t(x)] >> (8 * y) & 0xff)
                visit(x, y, bits);
}

/// Largest |principal curvature| of S at the foot point, from the Hessian of psi: the eigenvalues
/// on the tangent plane, moved from psi to 0 by k / (1 - psi k). NaN where a neighbor is missing.
/// @param n  the unit normal, of the central differences
inline double largestCurvature(const LeafBlock& b, int x, int y, int z, const Vec3d& n) {
    const float *row = b.row(x, y) + z, *x0 = b.row(x - 1, y) + z, *x1 = b.row(x + 1, y) + z,
                *y0 = b.row(x, y - 1) + z, *y1 = b.row(x, y + 1) + z;
    const double c = *row;
    auto d2 = [&](double after, double before) { return after - 2 * c + before; };
    auto mixed = [](double both, double first, double second, double neither) {
        return (both - first - second + neither) / 4;
    };
    const double xy = mixed(b.at(x + 1, y + 1, z), b.at(x + 1, y - 1, z), b.at(x - 1, y + 1, z),
                            b.at(x - 1, y - 1, z)),
                 xz = mixed(x1[1], x1[-1], x0[1], x0[-1]), yz = mixed(y1[1], y1[-1], y0[1], y0[-1]);
    const Vec3d hx{d2(*x1, *x0), xy, xz}, hy{xy, d2(*y1, *y0), yz}, hz{xz, yz, d2(row[1], row[-1])};
    // Trace and squared norm of P H P, P = I - n n^T.
    const Vec3d hn{dot(hx, n), dot(hy, n), dot(hz, n)};
    const double nhn = dot(n, hn);
    const double trace = hx.x + hy.y + hz.z - nhn;
    const double norm2 = dot(hx, hx) + dot(hy, hy) + dot(hz, hz) - 2 * dot(hn, hn) + nhn * nhn;
    double largest = 0;
    const std::array<double, 2> curvatures = eigenvaluesOfInvariants(trace, norm2);
    for (const double k : curvatures) {
        const double shift = 1 - c * k;
        largest = std::max(largest, std::abs(k) / std::max(shift, 0.1));
    }
    return std::isnan(curvatures[1]) ? std::numeric_limits<double>::quiet_NaN() : largest;
}

inline double largestCurvature(const LeafBlock& b, int x, int y, int z) {
    return largestCurvature(b, x, y, z, normalized(PsiDifferences(b, x, y, z).central()));
}

/// Whether a neighbor is missing that the level set has elsewhere: S is cut at this voxel.
/// @param psi, halfWidth  voxels
inline bool cutBeside(const PsiDifferences& d, double psi, double halfWidth) {
    return !d.complete() && std::abs(psi) + 1.01 < halfWidth;
}

/// grad psi by the differences that belong to one face.
///
/// Central differences are of second order. Around a crease |psi| is convex on the side where its
/// level sets are round (they turn fast, but they do not break: the direction of the central
/// difference holds), and has a concave kink on the other, the medial axis. There a central
/// difference mixes two faces (|grad psi| < 1), and each axis takes the side that makes the length
/// come out best. Missing neighbors leave the other side; an axis with neither gives 0.
inline Vec3d psiGradient(const PsiDifferences& d, double psi) {
    const Vec3d central = d.central();
    if (d.smooth()) return central;

    constexpr double kKink = 0.1;  // change of |grad psi| from one voxel to the next
    std::array<std::array<double, 3>, 3> options;
    for (int a = 0; a < 3; ++a) {
        const double bend = d.bend(a, psi < 0 ? -1 : 1);
        const double none = std::numeric_limits<double>::quiet_NaN();
        options[std::size_t(a)] = {central[a], d.backward[a], d.forward[a]};
        if (bend > -kKink) options[std::size_t(a)] = {central[a], none, none};
        if (std::isnan(d.backward[a]) && std::isnan(d.forward[a]))
            options[std::size_t(a)] = {0, none, none};
    }
    Vec3d best{};
    double bestMisfit = kInfinity;
    for (std::size_t choice = 0; choice < 27; ++choice) {
        // Central first on every axis: it wins ties. NaN never wins.
        const Vec3d g{options[0][choice / 9], options[1][choice / 3 % 3], options[2][choice % 3]};
        const double misfit = std::abs(length(g) - 1);
        if (misfit < bestMisfit) bestMisfit = misfit, best = g;
    }
    return best;
}

}  // namespace igeo
