/// What a level set shows of itself, counted leaf by leaf. Internal.
#pragma once

#include <igeo/surface/detail/histogram.h>
#include <igeo/surface/detail/leaf_block.h>
#include <igeo/surface/level_set.h>

#include <cstdint>
#include <span>

namespace igeo {

/// Counts of the voxels of a level set, row by row. Sums do not depend on the order.
class PsiTally {
public:
    using Leaf = LeafBlock::Leaf;

    /// @param s  the level set that the leaves belong to, with its voxel size and half-width
    void addLeaves(const LevelSet& s, std::span<const Leaf* const> leaves);
    void add(const PsiTally& other);
    /// Sets nearSurface, crossingShare, cutVoxels, gradientMedian, gradientShare, largestCurvature
    /// and reach.
    void summarize(LevelSetStats& stats) const;

private:
    template <int Width>
    IGEO_INLINE void addAll(const LevelSet& s, std::span<const Leaf* const> leaves);
    void addByFour(const LevelSet& s, std::span<const Leaf* const> leaves);
#ifdef IGEO_AVX2
    IGEO_AVX2 void addByEight(const LevelSet& s, std::span<const Leaf* const> leaves);
#endif
    template <int Width>
    IGEO_INLINE void addRow(const LeafBlock& b, int x, int y, double halfWidth);

    std::uint64_t nearSurface_ = 0, crossing_ = 0, cut_ = 0;
    Histogram gradient_, curvature_, meeting_;
};

}  // namespace igeo
