/// psi around one leaf, gathered once so that stencils need no look-ups. Internal.
#pragma once

#include <igeo/types.h>
#include <openvdb/openvdb.h>

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
                for (int z = -1; z <= 1; ++z)
                    copyPart(psi.probeConstLeaf(origin.offsetBy(8 * x, 8 * y, 8 * z)), {x, y, z},
                             dx);
    }

    /// psi at voxel (x, y, z) of the leaf, each in [-1, 8].
    double at(int x, int y, int z) const {
        return values_[std::size_t(100 * (x + 1) + 10 * (y + 1) + z + 1)];
    }

private:
    /// Slice of the leaf at step s that lies in the block, as [begin, end) of leaf coordinates.
    static int first(int s) { return s < 0 ? 7 : 0; }
    static int last(int s) { return s > 0 ? 1 : 8; }

    void copyPart(const Leaf* leaf, const Ijk& s, double dx) {
        constexpr float kMissing = std::numeric_limits<float>::quiet_NaN();
        for (int x = first(s.x); x < last(s.x); ++x)
            for (int y = first(s.y); y < last(s.y); ++y)
                for (int z = first(s.z); z < last(s.z); ++z) {
                    const auto n = openvdb::Index(x << 6 | y << 3 | z);
                    values_[std::size_t(100 * (x + 8 * s.x + 1) + 10 * (y + 8 * s.y + 1) + z +
                                        8 * s.z + 1)] =
                        leaf && leaf->isValueOn(n) ? float(leaf->getValue(n) / dx) : kMissing;
                }
    }

    std::array<float, 1000> values_;
};

/// Differences of psi at a voxel of a block, along each axis.
struct PsiDifferences {
    Vec3d backward, forward;  ///< NaN where the neighbour is missing

    PsiDifferences(const LeafBlock& b, int x, int y, int z) {
        const double c = b.at(x, y, z);
        backward = {c - b.at(x - 1, y, z), c - b.at(x, y - 1, z), c - b.at(x, y, z - 1)};
        forward = {b.at(x + 1, y, z) - c, b.at(x, y + 1, z) - c, b.at(x, y, z + 1) - c};
    }
    bool complete() const { return !std::isnan(dot(backward, forward)); }
    Vec3d central() const { return 0.5 * (backward + forward); }
    /// No kink of psi here: no crease, no medial axis.
    bool smooth() const {
        constexpr double kSmooth = 0.1;
        return complete() && std::abs(length(central()) - 1) < kSmooth;
    }
};

/// grad psi by the differences whose length is nearest 1.
///
/// Central differences are of second order, but at a crease or a medial axis they mix two faces
/// (|grad psi| < 1); there each axis takes the side that makes the gradient's length come out best.
/// Missing neighbours leave the other side; an axis with neither gives 0.
inline Vec3d psiGradient(const PsiDifferences& d) {
    const Vec3d central = d.central();
    if (d.smooth()) return central;

    Vec3d best{};
    double bestMisfit = kInfinity;
    for (int choice = 0; choice < 27; ++choice) {
        // Central first on every axis: it wins ties.
        const std::array<int, 3> pick{choice / 9, choice / 3 % 3, choice % 3};
        Vec3d g{};
        bool valid = true;
        for (int a = 0; a < 3; ++a) {
            const double options[3] = {central[a], d.backward[a], d.forward[a]};
            double v = options[pick[std::size_t(a)]];
            if (std::isnan(v)) {
                const bool none = std::isnan(d.backward[a]) && std::isnan(d.forward[a]);
                if (none && pick[std::size_t(a)] == 0)
                    v = 0;
                else
                    valid = false;
            }
            g[a] = v;
        }
        if (!valid) continue;
        const double misfit = std::abs(length(g) - 1);
        if (misfit < bestMisfit) bestMisfit = misfit, best = g;
    }
    return best;
}

}  // namespace igeo
