/// Nearest points: a k-d tree in flat arrays.
#pragma once

#include <igeo/base/types.h>

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace igeo {

/// A balanced k-d tree over distinct points.
///
/// The tree stores the points in an order of its own, which depends on their positions only. Work
/// in that order gives the same bytes for a shuffled input.
class PointTree {
public:
    using Index = std::uint32_t;
    struct Found {
        double squared;  ///< distance
        Index point;     ///< in the tree's order
        bool operator<(const Found& b) const {
            return squared != b.squared ? squared < b.squared : point < b.point;
        }
    };

    PointTree() = default;
    /// @param points finite; fewer than 2^32
    /// Time O(n log n), in parallel; memory besides the points: 4 bytes per point and 12 for the
    /// boxes.
    explicit PointTree(const std::vector<Vec3d>& points);

    std::size_t size() const { return points_.size(); }
    const Vec3d& operator[](std::size_t i) const { return points_[i]; }
    /// The number that point i had in the input.
    Index inputIndex(std::size_t i) const { return order_[i]; }

    /// The point nearest to p; on ties the one with the lower number. The tree must not be empty.
    Found nearest(const Vec3d& p) const;
    /// The `count` points nearest to p, nearest first; fewer if fewer are within a distance.
    void nearest(const Vec3d& p, std::size_t count, std::vector<Found>& found,
                 double within = kInfinity) const;

    /// Gives each point a radius, for forReaching.
    void setReach(std::vector<double> reach);
    double reach(std::size_t i) const { return reach_[i]; }
    /// Calls visit(i) for all points i with |point(i) - p| < reach(i) + more, in the order of i.
    template <typename Visit>
    void forReaching(const Vec3d& p, double more, const Visit& visit) const;

private:
    struct Box {
        Vec3d low, high;
        double reach = 0;  ///< the largest in it

        double squaredDistance(const Vec3d& p) const {
            double sum = 0;
            for (int a = 0; a < 3; ++a) {
                const double d = std::max({low[a] - p[a], p[a] - high[a], 0.0});
                sum += d * d;
            }
            return sum;
        }
    };
    static constexpr std::size_t kBucket = 8;  ///< points in a leaf at most

    /// Points [begin, end) of box k of 2^level at a level.
    std::size_t edge(unsigned level, std::size_t k) const { return k * size() >> level; }

    std::vector<Vec3d> points_;
    std::vector<Index> order_;
    std::vector<Box> boxes_;  ///< level by level: 2^level - 1 boxes come before a level
    std::vector<double> reach_;
    unsigned levels_ = 0;  ///< below the root
};

template <typename Visit>
void PointTree::forReaching(const Vec3d& p, double more, const Visit& visit) const {
    // A stack of (level, box); the lower half comes off first.
    std::pair<unsigned, std::size_t> stack[64];
    std::size_t top = 0;
    if (size() > 0) stack[top++] = {0, 0};
    while (top > 0) {
        const auto [level, k] = stack[--top];
        const Box& box = boxes_[(std::size_t(1) << level) - 1 + k];
        const double most = box.reach + more;
        if (box.squaredDistance(p) >= most * most) continue;
        if (level < levels_) {
            stack[top++] = {level + 1, 2 * k + 1};
            stack[top++] = {level + 1, 2 * k};
            continue;
        }
        for (std::size_t i = edge(level, k); i < edge(level, k + 1); ++i) {
            const Vec3d r = p - points_[i];
            const double reach = reach_[i] + more;
            if (dot(r, r) < reach * reach) visit(Index(i));
        }
    }
}

}  // namespace igeo
