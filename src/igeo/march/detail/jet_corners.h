/// What core nodes at the corners of cells say at points in them: at foot points of nodes outside
/// the core, and at any points of S. Internal.
#pragma once

#include <igeo/march/detail/jet_fit.h>
#include <igeo/march/detail/jet_state.h>
#include <igeo/march/detail/leaf_corners.h>

#include <array>
#include <span>

namespace igeo {

/// Points of S, up to eight side by side, and the core nodes around them.
struct CellPoints {
    Lanes x{}, y{}, z{};     ///< from the low corner of its cell, in [0, 1)
    Lanes nx{}, ny{}, nz{};  ///< normal of S
    Lanes weight{};          ///< cost; not 0
    /// Corner (a, b, c) of the cells at 4 a + 2 b + c; kNoNode where there is none.
    std::array<std::array<NodeIndex, Lanes::kNodes>, 8> node;

    CellPoints() { weight = {1, 1, 1, 1, 1, 1, 1, 1}; }
    void setPlace(std::size_t lane, const Vec3f& place) {
        x[lane] = place.x, y[lane] = place.y, z[lane] = place.z;
    }
    void setNormal(std::size_t lane, const Vec3f& normal) {
        nx[lane] = normal.x, ny[lane] = normal.y, nz[lane] = normal.z;
    }
    void clearNodes(std::size_t lane) {
        for (auto& corner : node) corner[lane] = kNoNode;
    }
};

/// Up to eight cells side by side: their low corners, in voxels from that of a leaf.
struct CellPlaces {
    template <typename T>
    using PerLane = std::array<T, Lanes::kNodes>;
    PerLane<LeafIndex> leaf{};
    alignas(32) PerLane<std::int32_t> x{}, y{}, z{};
};
/// Sets the core nodes around the points.
/// @param wanted  bits: the points to look for. The others, and those in cells that are not wholly
///                in the band, have no nodes around them.
void findCorners(const Band& band, const CellPlaces& cells, unsigned wanted, CellPoints& points);

/// What the nodes at the corners of the cells say.
struct JetCorners {
    static constexpr std::size_t kMax = 8;  ///< corners of a cell
    /// The first corner of each point, the second of each, and so on. Where a point has fewer than
    /// one beside it, `weight`, `g` and `u` are 0.
    struct Corner {
        Lanes weight;      ///< trilinear
        Lanes x, y, z;     ///< the chord from the foot point of the corner
        Lanes mx, my, mz;  ///< normal there
        Lanes gx, gy, gz;  ///< direction of travel there
        Lanes u, mean;     ///< value over the weight here, and what a chord counts (meanWeight)
    };
    std::array<Corner, kMax> corner;
    alignas(32) std::array<std::array<NodeIndex, Lanes::kNodes>, kMax> node;  ///< of the core
    Lanes nx, ny, nz;  ///< normals of the points
    template <typename T>
    using PerLane = std::array<T, Lanes::kNodes>;
    alignas(32) PerLane<std::uint32_t> count;   ///< corners of the point
    alignas(32) PerLane<std::uint32_t> bucket;  ///< from where the values of its corners count
    /// Whether all its corners have a jet, and normals within 37 degrees of its own.
    alignas(32) PerLane<std::int32_t> smooth;
    /// Whether one of them has links that are severed around it, or lies at an obstacle.
    alignas(32) PerLane<std::int32_t> hindered;

    Vec3f chord(std::size_t lane, std::size_t k) const {
        return {corner[k].x[lane], corner[k].y[lane], corner[k].z[lane]};
    }
    Vec3f g(std::size_t lane, std::size_t k) const {
        return {corner[k].gx[lane], corner[k].gy[lane], corner[k].gz[lane]};
    }
};

/// What many reads of a core node need: its gradient, out of its chart, and JetState::rest.
struct LiftedJet {
    Vec3f g;  ///< over the weight; 0 where there is no jet
    float rest;
};
/// Those of all nodes of a core, where fronts meet by rays. In parallel.
using LiftedJets = std::vector<LiftedJet>;
LiftedJets liftedOf(const CoreJets& jets);

/// Bits, per point: the corners at which a node is of a trilinear weight of at least a hundredth.
void findCornersThatCount(const CellPoints& points, JetCorners::PerLane<std::uint32_t>& bits);

/// Reads the nodes at the corners that count.
/// @param lifted  liftedOf(jets), or empty: those that are needed are computed
void gatherCorners(const CoreJets& jets, const LiftedJets& lifted, const CellPoints& points,
                   JetCorners& corners);
/// The same where the corners that count are known.
/// @param lifted  liftedOf(jets)
void gatherCorners(const CoreJets& jets, const LiftedJets& lifted, const CellPoints& points,
                   std::span<const CornerSlot> slots, JetCorners& corners);
/// The same as the march has left the nodes, also where fronts meet.
void gatherMarched(const CoreJets& jets, const CellPoints& points, JetCorners& corners);
/// The same but for directions of travel, which are not set.
void gatherCornersOfS(const CoreJets& jets, const CellPoints& points, JetCorners& corners);

/// The jets at the points: every corner carries its own there by the circular step (jet_fit.h) in
/// the mean direction; the values are blended.
struct CarriedJets {
    Lanes u, gx, gy, gz;
    /// 1 where the corners are of one front, as jet_blend.h has it for neighbors; else 0.
    alignas(32) JetCorners::PerLane<std::int32_t> spreads;   ///< which does not narrow
    alignas(32) JetCorners::PerLane<std::int32_t> oneFront;  ///< which may, but has no focus here
};
/// A point has the same bits in any lane, beside any others.
/// @param faceted  as Band::faceted
void carryFromCorners(const JetCorners& corners, bool faceted, CarriedJets& jets);

}  // namespace igeo
