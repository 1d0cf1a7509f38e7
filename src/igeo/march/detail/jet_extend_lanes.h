/// Foot points of nodes outside the core, side by side. Internal.
#pragma once

#include <igeo/march/detail/jet_corners.h>
#include <igeo/march/detail/leaf_numbers.h>

#include <array>

namespace igeo::jet {

/// Up to eight nodes.
struct FootLanes {
    template <typename T>
    using PerLane = std::array<T, Lanes::kNodes>;
    Lanes x{}, y{}, z{};  ///< from the voxel to the foot point
    alignas(32) PerLane<std::int32_t> voxelX{}, voxelY{}, voxelZ{};
    /// Of the cell around the foot point, in a LeafNumbers<2>; -1 where it does not hold the cell.
    alignas(32) PerLane<std::int32_t> cell;
    /// Of the core around them, and the straight line to the seed.
    alignas(32) PerLane<double> value, bound;

    void set(std::size_t lane, const Ijk& voxel, const Vec3f& foot) {
        x[lane] = foot.x, y[lane] = foot.y, z[lane] = foot.z;
        voxelX[lane] = voxel.x, voxelY[lane] = voxel.y, voxelZ[lane] = voxel.z;
    }
};

/// Finds the cells around the foot points, and their places in these.
/// @param origin  of the leaf of the numbers
void findCells(const Ijk& origin, FootLanes& feet, CellPoints& points);

/// Finds values and bounds, for one source at a point.
void findValues(const CoreJets& jets, const JetCorners& corners, const CarriedJets& carried,
                const Lanes& weight, FootLanes& feet);

}  // namespace igeo::jet
