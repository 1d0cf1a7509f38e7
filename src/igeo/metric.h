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

/// A symmetric tensor in index axes. As a metric, G of M&S 5.1: the length of a curve C is the
/// integral of sqrt(G[C', C']), so G is the square of a cost per unit length.
struct Tensor {
    float xx = 1, yy = 1, zz = 1, xy = 0, xz = 0, yz = 0;
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
    /// The weight at a point of S, blended from the corners of its cell.
    double at(const BandCell& cell) const;
    /// What a step from a point of S costs, the metric blended from the corners of its cell.
    double stepCost(const BandCell& cell, const Vec3d& step) const {
        return at(cell) * length(step);
    }
    bool weighted() const { return !weight.empty(); }

    /// The least and the largest weight; 1 where there are none.
    double least() const {
        return weight.empty() ? 1.0 : double(*std::min_element(weight.begin(), weight.end()));
    }
    double largest() const {
        return weight.empty() ? 1.0 : double(*std::max_element(weight.begin(), weight.end()));
    }

    /// Multiplies with a weight per node.
    void multiply(const std::vector<float>& weights);

    /// Sets `obstacles` and finds the nodes inside and beside them. In parallel.
    void setObstacles(const Band& band, std::shared_ptr<const Obstacles> set);

    std::size_t insideCount() const {
        return std::size_t(std::count(sight.begin(), sight.end(), Inside));
    }
    bool inside(NodeIndex i) const { return !sight.empty() && sight[i] == Inside; }
    /// Whether no obstacle comes near the foot point of a node, so that nobody need ask.
    bool clear(NodeIndex i) const { return sight.empty() || sight[i] == Clear; }
    /// Whether an obstacle lies between two points of S, or around one of them; n: normal there.
    bool blocked(const Vec3d& a, const Vec3d& b, const Vec3d& n) const {
        return obstacles && obstacles->block(a, b, n);
    }
    /// The same between the foot points of two nodes, a few voxels apart at most.
    bool blocked(const Band& band, NodeIndex i, NodeIndex j) const {
        return !clear(i) && !clear(j) &&
               (inside(j) || obstacles->block(band.footPoint(i), band.footPoint(j),
                                              Vec3d(normalized(band.normal[i] + band.normal[j]))));
    }
    /// The same between a point of S, where its normal is n, and the foot point of a node.
    bool blocked(const Band& band, const Vec3d& pIndex, const Vec3d& n, NodeIndex j) const {
        return !clear(j) && (inside(j) || obstacles->block(pIndex, band.footPoint(j), n));
    }

    /// Takes the corners of a cell that obstacles hide from p, a point of S with normal n, out of
    /// it.
    void dropHiddenCorners(const Band& band, const Vec3d& pIndex, const Vec3d& n,
                           BandCell& cell) const;

    /// @throws Error  InvalidArgument unless there is one positive, finite weight for each of n
    /// nodes
    void check(std::size_t n) const;
};

/// Shared by a march and its Field; null: Euclidean.
using MetricPtr = std::shared_ptr<const Metric>;

}  // namespace igeo
