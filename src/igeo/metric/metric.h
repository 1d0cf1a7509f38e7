/// The cost of steps along the surface, and obstacles.
#pragma once

#include <igeo/band/band.h>
#include <igeo/band/tangent_frame.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace igeo {

/// A closed part of space that no path may enter. Positions are in index space.
class Obstacles {
public:
    virtual ~Obstacles() = default;

    /// Whether the segment between two points of S, a few voxels apart at most, meets the
    /// obstacles; the same for both directions. With a = b: whether the point lies inside.
    /// @param normal of S near there, unit: an obstacle made of voxels also blocks just above and
    ///               below S
    virtual bool block(const Vec3d& a, const Vec3d& b, const Vec3d& normal) const = 0;

    /// False only if no obstacle comes within `radius` voxels of p. O(1).
    virtual bool mayBeNear(const Vec3d& p, double radius) const = 0;

    /// Whether a point of S lies inside: as block(p, p, normal), and O(1) far from all obstacles.
    bool contains(const Vec3d& p, const Vec3d& normal) const {
        return mayBeNear(p, 1) && block(p, p, normal);
    }

    /// A straight segment on S, or a point of S where both ends are equal.
    struct Line {
        Vec3d from, to;
    };
    /// Visits the parts without an area and the rims of the others, as far as they are known as
    /// lines: edges and vertices of a mesh.
    virtual void forLines(const std::function<void(const Line&)>&) const {}
    /// Visits the centers of the voxels that make up the rest.
    virtual void forVoxels(const std::function<void(const Vec3d&)>&) const {}
};

/// A symmetric tensor in index axes. As a metric, G of M&S 5.1: the length of a curve C is the
/// integral of sqrt(G[C', C']), so G is the square of a cost per unit length.
struct Tensor {
    float xx = 1, yy = 1, zz = 1, xy = 0, xz = 0, yz = 0;
};
/// G[a, b].
inline double product(const Tensor& g, const Vec3d& a, const Vec3d& b) {
    return g.xx * a.x * b.x + g.yy * a.y * b.y + g.zz * a.z * b.z + g.xy * (a.x * b.y + a.y * b.x) +
           g.xz * (a.x * b.z + a.z * b.x) + g.yz * (a.y * b.z + a.z * b.y);
}
/// Eigenvalues in rising order, to rounding of the largest.
std::array<double, 3> eigenvalues(const Tensor& g);

/// The cost of a step: the weight g of |grad d| = g (M&S (7)), or the tensor G of G^-1[grad d, grad
/// d] = 1 (M&S 5.1), both constant along normals (M&S (10)); infinite in obstacles.
struct Metric {
    std::vector<float> weight;  ///< cost per unit length per band node, > 0; empty: 1 everywhere
    /// Per band node, positive definite; empty: isotropic. Never together with `weight`. Marches
    /// along S use only its part in the tangent plane.
    std::vector<Tensor> tensor;

    std::shared_ptr<const Obstacles> obstacles;  ///< none: null
    /// Per band node, where there are obstacles: whether its foot point is clear of them, beside
    /// one or inside (setObstacles).
    enum ObstacleState : std::uint8_t { Clear, Beside, Inside };
    std::vector<ObstacleState> obstacleState;

    /// The weight; of a tensor the geometric mean of the costs along its three axes.
    double at(NodeIndex i) const {
        return !weight.empty() ? double(weight[i]) : tensor.empty() ? 1.0 : meanCost(tensor[i]);
    }
    /// The same at a point of S, blended from the corners of its cell.
    double at(const BandCell& cell) const;
    bool weighted() const { return !weight.empty() || !tensor.empty(); }
    bool anisotropic() const { return !tensor.empty(); }

    /// Cost of a short straight step, voxels: weight |step|, or sqrt(G[step, step]).
    double stepCost(NodeIndex i, const Vec3d& step) const {
        return !tensor.empty() ? std::sqrt(product(tensor[i], step, step)) : at(i) * length(step);
    }
    /// The same with the metric blended from the remaining corners of the cell; weight 1 where none
    /// remains. The step should be tangential: a tensor in space also prices a part along the
    /// normal.
    double stepCost(const BandCell& cell, const Vec3d& step) const;

    /// The metric in the tangent plane of a node, or of a point of S.
    PlaneMetric inPlane(const TangentFrame& frame, NodeIndex i) const {
        return inPlane(frame, tensor[i]);
    }
    PlaneMetric inPlane(const TangentFrame& frame, const BandCell& cell) const {
        return inPlane(frame, tensorAt(cell));
    }

    /// The least and the largest cost per unit length, 1 where all is Euclidean. For tensors over
    /// all directions in space: bounds of those along S. In parallel.
    double least() const;
    double largest() const;

    /// Multiplies the cost per unit length by a factor per band node: weights by w, tensors by w^2.
    /// @throws Error  InvalidArgument where there are more or fewer factors than costs
    void multiply(const std::vector<float>& factors);

    /// Sets `obstacles` and finds the nodes inside and beside them. In parallel.
    void setObstacles(const Band& band, std::shared_ptr<const Obstacles> set);

    std::size_t insideCount() const {
        return std::size_t(std::count(obstacleState.begin(), obstacleState.end(), Inside));
    }
    /// Whether obstacles block a node, a step between two nodes that share a face, or a bridge.
    /// O(n) if they block none.
    bool blocksAny(const Band& band) const;
    bool inside(NodeIndex i) const { return !obstacleState.empty() && obstacleState[i] == Inside; }
    /// Whether no obstacle comes near the foot point of a node, so that no test is needed.
    bool clear(NodeIndex i) const { return obstacleState.empty() || obstacleState[i] == Clear; }
    /// Whether an obstacle lies between two points of S or contains one of them; n: normal there.
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

    /// Removes the corners of a cell that obstacles hide from p, a point of S with normal n.
    void dropHiddenCorners(const Band& band, const Vec3d& pIndex, const Vec3d& n,
                           BandCell& cell) const;

    /// @throws Error  InvalidArgument unless there is one positive, finite weight per node, or one
    ///         finite, positive definite tensor (with the node's place and least eigenvalue)
    void check(const Band& band) const;

private:
    static double meanCost(const Tensor& g);
    static PlaneMetric inPlane(const TangentFrame& frame, const Tensor& g);
    Tensor tensorAt(const BandCell& cell) const;
};

/// For messages about metrics: a number with six digits, and the position of a node's foot point in
/// world space.
std::string shortText(double x);
std::string worldPlace(const Band& band, NodeIndex i);

/// Shared by a march and its Field; null: Euclidean.
using MetricPtr = std::shared_ptr<const Metric>;

}  // namespace igeo
