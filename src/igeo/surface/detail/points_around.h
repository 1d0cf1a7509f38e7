/// Points of a tree near a small ball, for many queries in it. Internal.
#pragma once

#include <igeo/base/point_tree.h>

#include <cstddef>
#include <vector>

namespace igeo {

/// Finds the points around a ball once, so that the tree is not searched for each position in it.
/// The answers are those of the tree, bit by bit. One per thread, reused.
class PointsAround {
public:
    using Index = PointTree::Index;

    /// @param points  must outlive it, its reach set
    explicit PointsAround(const PointTree& points) : points_(points) {}

    /// Moves to another ball.
    /// @param beside  how far beyond it forReaching will look, its `more` included
    void moveTo(const Vec3d& middle, double radius, double beside);

    /// The kNearest points nearest to a position in the ball, nearest first; valid until the next
    /// call.
    const std::vector<PointTree::Found>& nearest(const Vec3d& p);
    static constexpr std::size_t kNearest = 5;
    /// Whether holds(i) for one of the points that nearest() may return in the ball.
    template <typename Holds>
    bool anyNear(const Holds& holds) const {
        for (const Near& n : near_)
            if (holds(n.index)) return true;
        return false;
    }

    /// The same as PointTree::forReaching; fast near the ball.
    template <typename Visit>
    void forReaching(const Vec3d& p, double more, const Visit& visit) {
        if (length(p - middle_) + more > reach_) return points_.forReaching(p, more, visit);
        if (!hasReaching_) findReaching();
        for (const Reaching& point : reaching_) {
            const Vec3d r = p - point.at;
            const double reach = point.reach + more;
            if (dot(r, r) < reach * reach) visit(point.index);
        }
    }

private:
    struct Near {
        double distance;  ///< to the center of the ball
        Vec3d at;
        Index index;
    };
    struct Reaching {
        Vec3d at;
        double reach;
        Index index;
    };
    void findReaching();

    const PointTree& points_;
    Vec3d middle_;
    double radius_ = 0, reach_ = 0;
    std::vector<Near> near_;          ///< by distance
    std::vector<Reaching> reaching_;  ///< all that reach a position within reach_ of the middle
    bool hasReaching_ = false;
    std::vector<PointTree::Found> found_;
};

}  // namespace igeo
