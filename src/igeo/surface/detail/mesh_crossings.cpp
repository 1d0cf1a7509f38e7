#include <igeo/surface/detail/mesh_crossings.h>

#include <igeo/base/detail/box.h>
#include <igeo/base/parallel.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <utility>

namespace igeo {

namespace {

using Corners = std::array<Vec3d, 3>;

struct Interval {
    double low = kInfinity, high = -kInfinity;

    Interval(const Corners& t, const Vec3d& axis, const Vec3d& origin) {
        for (const Vec3d& p : t) {
            const double d = dot(p - origin, axis);
            low = std::min(low, d), high = std::max(high, d);
        }
    }
    /// The least shift that separates the two.
    double depth(const Interval& o) const { return std::min(high - o.low, o.high - low); }
};

/// Whether two triangles overlap by more than a tolerance along an axis.
class Pair {
public:
    Pair(const Corners& a, const Corners& b, double tolerance)
        : a_(a), b_(b), tolerance_(tolerance) {}

    bool cross() const {
        const Vec3d n = normal(a_), m = normal(b_);
        if (n == Vec3d{} || m == Vec3d{}) return false;
        const Interval heightsOfB(b_, n, a_[0]), heightsOfA(a_, m, b_[0]);
        if (flat(heightsOfB) || flat(heightsOfA))
            return overlapAcross(a_, n) && overlapAcross(b_, m);
        return through(heightsOfB) && through(heightsOfA) && overlapAcrossEdges();
    }

private:
    static Vec3d normal(const Corners& t) {
        constexpr double kLeast = 1e-12;
        const Vec3d u = t[1] - t[0], v = t[2] - t[0], n = igeo::cross(u, v);
        return dot(n, n) > kLeast * kLeast * dot(u, u) * dot(v, v) ? normalized(n) : Vec3d{};
    }
    bool flat(const Interval& heights) const {
        return std::max(-heights.low, heights.high) <= tolerance_;
    }
    bool through(const Interval& heights) const {
        return std::min(-heights.low, heights.high) > tolerance_;
    }
    bool overlapAlong(const Vec3d& axis) const {
        return Interval(a_, axis, a_[0]).depth(Interval(b_, axis, a_[0])) > tolerance_;
    }
    /// Tests the axes in the plane of t that are normal to its edges.
    bool overlapAcross(const Corners& t, const Vec3d& n) const {
        for (std::size_t k = 0; k < 3; ++k)
            if (!overlapAlong(normalized(igeo::cross(t[(k + 1) % 3] - t[k], n)))) return false;
        return true;
    }
    bool overlapAcrossEdges() const {
        constexpr double kParallel = 1e-9;
        for (std::size_t i = 0; i < 3; ++i)
            for (std::size_t j = 0; j < 3; ++j) {
                const Vec3d u = a_[(i + 1) % 3] - a_[i], v = b_[(j + 1) % 3] - b_[j],
                            axis = igeo::cross(u, v);
                if (!(dot(axis, axis) > kParallel * kParallel * dot(u, u) * dot(v, v))) continue;
                if (!overlapAlong(normalized(axis))) return false;
            }
        return true;
    }

    const Corners &a_, &b_;
    double tolerance_;
};

/// A box in single precision, relative to the middle of the mesh: its error is below the tolerance.
struct FloatBox {
    Vec3f low{kFar, kFar, kFar}, high{-kFar, -kFar, -kFar};

    void include(const Vec3f& from, const Vec3f& to) {
        for (int a = 0; a < 3; ++a)
            low[a] = std::min(low[a], from[a]), high[a] = std::max(high[a], to[a]);
    }
    bool meets(const FloatBox& o) const {
        return low.x <= o.high.x && o.low.x <= high.x && low.y <= o.high.y && o.low.y <= high.y &&
               low.z <= o.high.z && o.low.z <= high.z;
    }

private:
    static constexpr float kFar = std::numeric_limits<float>::max();
};

/// Triangles along a Morton curve, with the boxes of a complete binary tree over runs of kRun.
class TriangleTree {
public:
    TriangleTree(const std::vector<Vec3d>& points,
                 const std::vector<TriangleMesh::Triangle>& triangles);

    std::size_t runs() const { return (box_.size() + kRun - 1) / kRun; }
    /// Calls visit(a, b) once for each pair of triangles whose boxes meet, the first in run r.
    template <typename Visit>
    void forPairs(std::size_t r, const Visit& visit) const;

private:
    static constexpr std::size_t kRun = 4;

    template <typename Visit>
    void forPairsOfRuns(std::size_t r, std::size_t s, const Visit& visit) const {
        for (std::size_t i = r * kRun; i < std::min((r + 1) * kRun, box_.size()); ++i)
            for (std::size_t j = r == s ? i + 1 : s * kRun;
                 j < std::min((s + 1) * kRun, box_.size()); ++j)
                if (box_[i].meets(box_[j])) visit(triangle_[i], triangle_[j]);
    }

    std::vector<std::uint32_t> triangle_;
    std::vector<FloatBox> box_;   ///< per triangle, in that order
    std::vector<FloatBox> node_;  ///< the children of k are 2 k and 2 k + 1; runs come last
    std::size_t firstRun_ = 1;    ///< in node_
};

/// Spreads 21 bits, with two zeros after each.
std::uint64_t spread(std::uint64_t x) {
    x = (x | x << 32) & 0x1f00000000ffff;
    x = (x | x << 16) & 0x1f0000ff0000ff;
    x = (x | x << 8) & 0x100f00f00f00f00f;
    x = (x | x << 4) & 0x10c30c30c30c30c3;
    return (x | x << 2) & 0x1249249249249249;
}

TriangleTree::TriangleTree(const std::vector<Vec3d>& points,
                           const std::vector<TriangleMesh::Triangle>& triangles) {
    const std::size_t n = triangles.size();
    const Box all(points);
    const Vec3d middle = 0.5 * (all.low + all.high);
    const double cells = double((1 << 21) - 1) / std::max(all.longestSide(), 1e-300);
    std::vector<std::pair<std::uint64_t, std::uint32_t>> order(n);
    parallelFor(n, 4096, [&](std::size_t begin, std::size_t end) {
        for (std::size_t t = begin; t < end; ++t) {
            const auto& [a, b, c] = triangles[t];
            const Vec3d p = ((points[a] + points[b] + points[c]) * (1.0 / 3) - all.low) * cells;
            order[t] = {spread(std::uint64_t(p.x)) << 2 | spread(std::uint64_t(p.y)) << 1 |
                            spread(std::uint64_t(p.z)),
                        std::uint32_t(t)};
        }
    });
    std::sort(order.begin(), order.end());
    box_.resize(n);
    triangle_.resize(n);
    parallelFor(n, 4096, [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) {
            triangle_[k] = order[k].second;
            for (const std::uint32_t v : triangles[triangle_[k]]) {
                const Vec3f p(points[v] - middle);
                box_[k].include(p, p);
            }
        }
    });
    firstRun_ = std::bit_ceil(std::max<std::size_t>(runs(), 1));
    node_.resize(2 * firstRun_);
    for (std::size_t k = 0; k < n; ++k)
        node_[firstRun_ + k / kRun].include(box_[k].low, box_[k].high);
    for (std::size_t k = firstRun_ - 1; k > 0; --k)
        for (const std::size_t child : {2 * k, 2 * k + 1})
            node_[k].include(node_[child].low, node_[child].high);
}

template <typename Visit>
void TriangleTree::forPairs(std::size_t r, const Visit& visit) const {
    const std::size_t self = firstRun_ + r;
    forPairsOfRuns(r, r, visit);
    // Later runs: below the right-hand siblings on the path up.
    for (std::size_t up = self; up > 1; up /= 2) {
        if (up % 2 == 1) continue;
        std::array<std::size_t, 64> open{up + 1};
        for (std::size_t size = 1; size > 0;) {
            const std::size_t k = open[--size];
            if (!node_[k].meets(node_[self])) continue;
            if (k >= firstRun_)
                forPairsOfRuns(r, k - firstRun_, visit);
            else
                open[size++] = 2 * k, open[size++] = 2 * k + 1;
        }
    }
}

}  // namespace

std::size_t crossingPairs(const TriangleMesh& mesh, double tolerance, const Progress& progress) {
    // The pieces of a triangle with many points in an edge are long and beside each other, and all
    // boxes of two would meet.
    const auto& triangles = mesh.unsplit.empty() ? mesh.triangles : mesh.unsplit;
    const TriangleTree tree(mesh.points, triangles);
    const auto cornersOf = [&](std::uint32_t t) {
        const auto& [a, b, c] = triangles[t];
        return Corners{mesh.points[a], mesh.points[b], mesh.points[c]};
    };
    std::atomic<std::size_t> pairs{0};
    parallelFor(tree.runs(), 256, progress, [&](std::size_t begin, std::size_t end) {
        for (std::size_t r = begin; r < end && pairs < kMostCrossingPairs; ++r) {
            std::size_t found = 0;
            tree.forPairs(r, [&](std::uint32_t t, std::uint32_t u) {
                found += Pair(cornersOf(t), cornersOf(u), tolerance).cross();
            });
            if (found > 0) pairs += found;
        }
    });
    return std::min(pairs.load(), kMostCrossingPairs);
}

}  // namespace igeo
