/// Foot points of nodes outside the core, side by side. Internal.
#pragma once

#include <igeo/base/detail/registers.h>
#include <igeo/march/detail/jet_corners.h>
#include <igeo/march/detail/leaf_numbers.h>

#include <array>

namespace igeo::jet {

/// The step from a leaf's origin to the voxel at an offset.
IGEO_INLINE Ijk stepOf(std::uint32_t offset) {
    return {std::int32_t(offset >> 6), std::int32_t(offset >> 3 & 7), std::int32_t(offset & 7)};
}

/// Up to eight nodes.
struct FootLanes {
    template <typename T>
    using PerLane = std::array<T, Lanes::kNodes>;
    Lanes x{}, y{}, z{};  ///< from the voxel to the foot point
    alignas(32) PerLane<std::int32_t> originX{}, originY{}, originZ{};  ///< of the leaves
    alignas(32) PerLane<std::uint32_t> offset{};                        ///< in these
    /// Of the cell around the foot point, in LeafNumbers<2> of the leaf; -1 where it does not hold
    /// the cell.
    alignas(32) PerLane<std::int32_t> cell;
    /// Of the core around them, no less than the straight line to the seed.
    alignas(32) PerLane<double> value;
    /// Flags: all corners have a jet and are of one smooth front, clearly beyond the start disc.
    alignas(32) PerLane<std::int32_t> plain;

    void setLeaf(std::size_t lane, const Ijk& origin) {
        originX[lane] = origin.x, originY[lane] = origin.y, originZ[lane] = origin.z;
    }
    void set(std::size_t lane, unsigned offsetInLeaf, const Vec3f& foot) {
        x[lane] = foot.x, y[lane] = foot.y, z[lane] = foot.z;
        offset[lane] = offsetInLeaf;
    }
};

/// Foot points may lie in a start disc up to values this much larger than those in it; voxels times
/// weight.
constexpr double kDiscMargin = 3;

/// Finds the cells around the foot points, and their places in these.
void findCells(FootLanes& feet, CellPoints& points);

/// Finds values, and which are plain, for one source at a point.
void findValues(const CoreJets& jets, const JetCorners& corners, const CarriedJets& carried,
                const Lanes& weight, FootLanes& feet);

}  // namespace igeo::jet
