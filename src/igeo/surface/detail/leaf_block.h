/// psi around one leaf, gathered once so that stencils need no look-ups. Internal.
#pragma once

#include <igeo/band/band.h>
#include <igeo/base/symmetric_eigen.h>
#include <igeo/base/types.h>
#include <openvdb/openvdb.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace igeo {

/// The 10^3 voxels of a leaf and one voxel around it, in voxel units; NaN where inactive.
class LeafBlock {
public:
    using Leaf = openvdb::FloatTree::LeafNodeType;
    using Accessor = openvdb::tree::ValueAccessor<const openvdb::FloatTree, false>;

    /// @param dx divides the values: voxel size in world units
    void gather(const Accessor& psi, const openvdb::Coord& origin, double dx) {
        for (int x = -1; x <= 1; ++x)
            for (int y = -1; y <= 1; ++y)
                for (int z = -1; z <= 1; ++z) copyFrom(psi, origin, {x, y, z}, 1 / dx);
    }
    /// The same without edges and corners: enough for differences along the axes.
    void gatherCross(const Accessor& psi, const openvdb::Coord& origin, double dx) {
        copyFrom(psi, origin, {}, 1 / dx);
        for (int face = 0; face < 6; ++face) copyFrom(psi, origin, Band::faceStep(face), 1 / dx);
    }

    /// psi at voxel (x, y, z) of the leaf, each in [-1, 8].
    double at(int x, int y, int z) const {
        return values_[std::size_t(100 * (x + 1) + 10 * (y + 1) + z + 1)];
    }

private:
    /// Slice of the leaf at step s that lies in the block, as [begin, end) of leaf coordinates.
    static int first(int s) { return s < 0 ? 7 : 0; }
    static int last(int s) { return s > 0 ? 1 : 8; }

    void copyFrom(const Accessor& psi, const openvdb::Coord& origin, const Ijk& s, double scale) {
        constexpr float kMissing = std::numeric_limits<float>::quiet_NaN();
        const Leaf* leaf = psi.probeConstLeaf(origin.offsetBy(8 * s.x, 8 * s.y, 8 * s.z));
        const float* from = leaf ? leaf->buffer().data() : nullptr;
        for (int x = first(s.x); x < last(s.x); ++x)
            for (int y = first(s.y); y < last(s.y); ++y) {
                const auto row = std::size_t(x << 6 | y << 3);
                const unsigned active =
                    leaf ? leaf->valueMask().getWord<unsigned char>(openvdb::Index(row >> 3)) : 0;
                float* to =
                    &values_[std::size_t(100 * (x + 8 * s.x + 1) + 10 * (y + 8 * s.y + 1) + 1)];
                for (int z = first(s.z); z < last(s.z); ++z)
                    to[z + 8 * s.z] =
                        active >> z & 1 ? float(from[row + std::size_t(z)] * scale) : kMissing;
            }
    }

    std::array<float, 1000> values_;
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
    bool smooth() const {
        constexpr double kSmooth = 0.1;
        return complete() && std::abs(length(central()) - 1) < kSmooth;
    }
};

/// Largest |principal curvature| of S at the foot point, from the Hessian of psi: the eigenvalues
/// on the tangent plane, moved from psi to 0 by k / (1 - psi k). NaN where a neighbor is missing.
inline double largestCurvature(const LeafBlock& b, int x, int y, int z) {
    auto d2 = [&](int i, int j, int k) {
        return b.at(x + i, y + j, z + k) - 2 * b.at(x, y, z) + b.at(x - i, y - j, z - k);
    };
    auto mixed = [&](int i, int j, int k, int l, int m, int n) {
        return (b.at(x + i + l, y + j + m, z + k + n) - b.at(x + i - l, y + j - m, z + k - n) -
                b.at(x - i + l, y - j + m, z - k + n) + b.at(x - i - l, y - j - m, z - k - n)) /
               4;
    };
    const Vec3d n = normalized(PsiDifferences(b, x, y, z).central());
    const double xy = mixed(1, 0, 0, 0, 1, 0), xz = mixed(1, 0, 0, 0, 0, 1),
                 yz = mixed(0, 1, 0, 0, 0, 1);
    const Vec3d hx{d2(1, 0, 0), xy, xz}, hy{xy, d2(0, 1, 0), yz}, hz{xz, yz, d2(0, 0, 1)};
    // Trace and squared norm of P H P, P = I - n n^T.
    const Vec3d hn{dot(hx, n), dot(hy, n), dot(hz, n)};
    const double nhn = dot(n, hn);
    const double trace = hx.x + hy.y + hz.z - nhn;
    const double norm2 = dot(hx, hx) + dot(hy, hy) + dot(hz, hz) - 2 * dot(hn, hn) + nhn * nhn;
    const double psi = b.at(x, y, z);
    double largest = 0;
    const std::array<double, 2> curvatures = eigenvaluesOfInvariants(trace, norm2);
    for (const double k : curvatures) {
        const double shift = 1 - psi * k;
        largest = std::max(largest, std::abs(k) / std::max(shift, 0.1));
    }
    return std::isnan(curvatures[1]) ? std::numeric_limits<double>::quiet_NaN() : largest;
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
