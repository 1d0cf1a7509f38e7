/// Foot points of nodes outside the core side by side, and core nodes around one. Internal.
#pragma once

#include <igeo/base/detail/registers.h>
#include <igeo/march/detail/jet_corners.h>
#include <igeo/march/detail/leaf_numbers.h>

#include <array>
#include <bit>

namespace igeo::jet {

/// The step from a leaf's origin to the voxel at an offset.
IGEO_INLINE Ijk stepOf(std::uint32_t offset) {
    return {std::int32_t(offset >> 6), std::int32_t(offset >> 3 & 7), std::int32_t(offset & 7)};
}

/// Up to eight nodes.
struct FootLanes {
    template <typename T>
    using PerLane = std::array<T, Lanes::kNodes>;
    Lanes psi{};
    Lanes x{}, y{}, z{};  ///< from the voxel to the foot point
    alignas(32) PerLane<std::int32_t> originX{}, originY{}, originZ{};  ///< of the leaves
    alignas(32) PerLane<std::uint32_t> offset{};                        ///< in these
    /// Of the cell around the foot point, in LeafNumbers<2> of the leaf; -1 where it does not hold
    /// the cell.
    alignas(32) PerLane<std::int32_t> cell;
    /// No less than the straight line to the seed.
    alignas(32) PerLane<double> value;
    /// Flags: all corners have a jet and are of one smooth front, clearly beyond the start disc.
    alignas(32) PerLane<std::int32_t> plain;

    void setLeaf(std::size_t lane, const Ijk& origin) {
        originX[lane] = origin.x, originY[lane] = origin.y, originZ[lane] = origin.z;
    }
    void setFoot(std::size_t lane, const Vec3f& foot) {
        x[lane] = foot.x, y[lane] = foot.y, z[lane] = foot.z;
    }
};

/// Foot points may lie in a start disc up to values this much larger than those in it; voxels times
/// weight.
constexpr double kDiscMargin = 3;

/// Finds the cells around the foot points, and their places in these.
/// @param fromPsi  foot points are -psi times the normal, and set by this; else given
void findCells(FootLanes& feet, bool fromPsi, CellPoints& points);

/// Finds values, and which are plain, for one source at a point.
void findValues(const CoreJets& jets, const JetCorners& corners, const CarriedJets& carried,
                const Lanes& weight, FootLanes& feet);

/// Finds the values of eight core nodes in a row, of which the last may be missing, as those of the
/// feet, for one source at a point.
/// @param feet  of which offset and origin are set
void findCoreValues(const CoreJets& jets, const LiftedJets& lifted, NodeIndex first,
                    FootLanes& feet);

/// The core nodes of a box around a foot point, side by side.
struct BoxLanes {
    static constexpr std::size_t kMax = 128;
    template <typename T>
    using PerNode = std::array<T, kMax>;

    std::size_t count = 0;
    alignas(32) PerNode<NodeIndex> node;
    alignas(32) PerNode<std::uint32_t> step;  ///< LeafNumbers::boxStep from the middle of the box

    // What layOut() finds.
    alignas(32) PerNode<float> x, y, z;  ///< chord to the foot point
    alignas(32) PerNode<float> cosine;   ///< between the normals
    /// In the chart of the foot point over smooth parts of S, with an isotropic metric
    /// (JetNeighbor).
    alignas(32) PerNode<float> ax, ay, gx, gy;
    std::array<std::uint64_t, kMax / 64>
        onSheet;  ///< bits: of this sheet, within a cell's diagonal

    void add(NodeIndex core, const Ijk& fromMiddle) {
        node[count] = core, step[count++] = LeafNumbers<2>::boxStep(fromMiddle);
    }
    /// Calls visit(k) for those on the sheet.
    template <typename Visit>
    IGEO_INLINE void forOnSheet(const Visit& visit) const {
        for (std::size_t first = 0; first < kMax; first += 64)
            for (std::uint64_t bits = onSheet[first / 64]; bits; bits &= bits - 1)
                visit(first + std::size_t(std::countr_zero(bits)));
    }
    Vec3f chord(std::size_t k) const { return {x[k], y[k], z[k]}; }
    /// From the middle.
    Ijk stepOf(std::size_t k) const {
        return {int(step[k] >> 6) - 2, int(step[k] >> 3 & 7) - 2, int(step[k] & 7) - 2};
    }
};
/// Lays the nodes out in the chart of the foot point.
/// @param lifted     liftedOf(jets), or empty: directions are not set
/// @param foot       from its voxel
/// @param middle     of the box, from the same voxel
void layOut(const JetCore& core, const LiftedJets& lifted, const Vec3f& foot, const Ijk& middle,
            const LocalFrame& local, BoxLanes& box);

}  // namespace igeo::jet
