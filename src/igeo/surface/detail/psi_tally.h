/// What a level set shows of itself, counted leaf by leaf. Internal.
#pragma once

#include <igeo/surface/detail/histogram.h>
#include <igeo/surface/detail/leaf_block.h>
#include <igeo/surface/detail/psi_shells.h>

#include <cstdint>
#include <span>
#include <vector>

namespace igeo {

/// What the values of active voxels show, each for itself. Sums do not depend on the order.
struct PsiRange {
    using Leaf = LeafBlock::Leaf;

    std::uint64_t active = 0;
    std::uint64_t negative = 0;  ///< of these
    std::uint64_t bad = 0;       ///< NaN or infinite
    float widest = 0;            ///< largest |psi| that is neither
    Shells shells;

    /// @param dx  voxel size
    void addLeaves(double dx, std::span<const Leaf* const> leaves);
    void add(const PsiRange& other);
};

/// Counts of the voxels of a level set, row by row. Sums do not depend on the order; that of the
/// ridges does.
struct PsiTally {
    using Leaf = LeafBlock::Leaf;
    static constexpr double kGradientRange = 4;  ///< gradient holds |grad psi| / kGradientRange
    static constexpr double kReachRange = 16;    ///< meeting holds |psi| / kReachRange, voxels

    std::uint64_t nearSurface = 0;       ///< |psi| < 1
    std::uint64_t crossing = 0;          ///< of these: a face neighbor has the other sign
    std::uint64_t cut = 0;               ///< of these: S is cut there (cutBeside)
    Histogram gradient;                  ///< of voxels with all face neighbors
    Histogram curvature;                 ///< of nearSurface: CurvatureBins
    Histogram meeting;                   ///< where sheets meet
    std::vector<openvdb::Coord> ridges;  ///< voxels where |psi| has a sharp convex kink

    /// @param dx         voxel size
    /// @param halfWidth  of the level set, voxels
    void addLeaves(const openvdb::FloatTree& psi, double dx, double halfWidth,
                   std::span<const Leaf* const> leaves);
    void add(const PsiTally& other);
};

}  // namespace igeo
