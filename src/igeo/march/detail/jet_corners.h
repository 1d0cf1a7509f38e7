/// What core nodes at the corners of cells say at the foot points in them, for nodes outside the
/// core. Internal.
#pragma once

#include <igeo/march/detail/jet_fit.h>

#include <array>

namespace igeo {

/// Up to eight nodes side by side, each with the core nodes at the corners of the cell around its
/// foot point.
struct JetCorners {
    static constexpr std::size_t kMax = 8;  ///< corners of a node
    struct Corner {
        Lanes weight;      ///< trilinear
        Lanes x, y, z;     ///< the chord from the foot point of the corner
        Lanes mx, my, mz;  ///< normal there
        Lanes gx, gy, gz;  ///< direction of travel there
        Lanes u, mean;     ///< value over the weight here, and what a chord counts (meanWeight)
    };
    std::array<Corner, kMax> corner;
    Lanes nx, ny, nz;  ///< normals of the nodes
    std::array<std::uint32_t, Lanes::kNodes> count{};

    Vec3f chord(std::size_t lane, std::size_t k) const {
        return {corner[k].x[lane], corner[k].y[lane], corner[k].z[lane]};
    }
    Vec3f g(std::size_t lane, std::size_t k) const {
        return {corner[k].gx[lane], corner[k].gy[lane], corner[k].gz[lane]};
    }
    void setNormal(std::size_t lane, const Vec3f& n) {
        nx[lane] = n.x, ny[lane] = n.y, nz[lane] = n.z;
    }
    /// Sets the k-th corner of a node; `count` is left to the caller.
    void set(std::size_t lane, std::size_t k, float weight, const Vec3f& chord, const Vec3f& normal,
             const Vec3f& g, float u, float mean) {
        Corner& c = corner[k];
        c.weight[lane] = weight, c.u[lane] = u, c.mean[lane] = mean;
        c.x[lane] = chord.x, c.y[lane] = chord.y, c.z[lane] = chord.z;
        c.mx[lane] = normal.x, c.my[lane] = normal.y, c.mz[lane] = normal.z;
        c.gx[lane] = g.x, c.gy[lane] = g.y, c.gz[lane] = g.z;
    }
    /// Makes lanes as long as the longest, by corners without a weight.
    void pad();
};

/// The jets at the nodes: every corner carries its own there by the circular step (jet_fit.h) in
/// the mean direction; the values are blended.
struct CarriedJets {
    Lanes u, gx, gy, gz;
    /// Whether the corners are of one front, as jet_blend.h has it for neighbors.
    std::array<bool, Lanes::kNodes> spreads;   ///< which does not narrow
    std::array<bool, Lanes::kNodes> oneFront;  ///< which may narrow, but has no focus here
};
/// A node has the same bits in any lane, beside any others.
/// @param faceted  as Band::faceted
void carryFromCorners(const JetCorners& corners, bool faceted, CarriedJets& jets);

}  // namespace igeo
