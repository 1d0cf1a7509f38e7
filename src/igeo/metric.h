/// What a step along the surface costs, and where there is no way.
#pragma once

#include <igeo/band.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace igeo {

/// A closed part of space that no path may enter. Positions are in index space.
class Obstacles {
public:
    virtual ~Obstacles() = default;

    /// Whether the straight way between two points of S, a few voxels apart at most, meets the
    /// obstacles; the same for both directions. With a = b: whether the point lies inside.
    /// @param normal of S about there, unit: what lies just above or below S counts as well where
    ///               an obstacle is made of voxels
    virtual bool block(const Vec3d& a, const Vec3d& b, const Vec3d& normal) const = 0;

    /// False only if no obstacle comes within `radius` voxels of p. O(1).
    virtual bool mayBeNear(const Vec3d& p, double radius) const = 0;
};

/// An isotropic metric: the weight g of |grad d| = g, constant along normals (M&S (10)), and
/// obstacles, where g is infinite.
struct Metric {
    std::vector<float> weight;  ///< cost per unit length per band node, > 0; empty: 1 everywhere

    std::shared_ptr<const Obstacles> obstacles;  ///< none: null
    /// Per band node, where there are obstacles: what of them its foot point sees (setObstacles).
    enum Sight : std::uint8_t { Clear, Beside, Inside };
    std::vector<Sight> sight;

    double at(NodeIndex i) const { return weight.empty() ? 1.0 : double(weight[i]); }
    bool weighted() const { return !weight.empty(); }

    /// The least and the largest weight; 1 where there are none.
    double least() const {
        return weight.empty() ? 1.0 : double(*std::min_element(weight.begin(), weight.end()));
    }
    double largest() const {
        return weight.empty() ? 1.0 : double(*std::max_element(weight.begin(), weight.end()));
    }

    /// Sets `obstacles` and finds the nodes inside and beside them. In parallel.
    void setObstacles(const Band& band, std::shared_ptr<const Obstacles> set);

    bool inside(NodeIndex i) const { return !sight.empty() && sight[i] == Inside; }
    /// Whether no obstacle comes near the foot point of a node, so that nobody need ask.
    bool clear(NodeIndex i) const { return sight.empty() || sight[i] == Clear; }
    /// Whether an obstacle lies between two points of S, a few voxels apart at most.
    bool blocked(const Vec3d& a, const Vec3d& b, const Vec3d& normal) const {
        return obstacles && obstacles->block(a, b, normal);
    }

    /// @throws Error  InvalidArgument unless there is one positive, finite weight for each of n
    /// nodes
    void check(std::size_t n) const;
};

}  // namespace igeo
