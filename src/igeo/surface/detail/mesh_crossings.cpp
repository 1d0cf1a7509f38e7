#include <igeo/surface/detail/mesh_crossings.h>

#include <igeo/base/detail/box.h>
#include <igeo/base/nearest_on_triangle.h>
#include <igeo/base/parallel.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cmath>
#include <map>
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

/// The unit normal of a triangle; zero for one without area.
Vec3d normalOf(const Corners& t) {
    constexpr double kLeast = 1e-12;
    const Vec3d u = t[1] - t[0], v = t[2] - t[0], n = cross(u, v);
    return dot(n, n) > kLeast * kLeast * dot(u, u) * dot(v, v) ? normalized(n) : Vec3d{};
}

/// Whether two triangles overlap by more than a tolerance along an axis.
class Pair {
public:
    Pair(const Corners& a, const Corners& b, double tolerance)
        : a_(a),
          b_(b),
          tolerance_(tolerance),
          n_(normalOf(a)),
          m_(normalOf(b)),
          heightsOfB_(b, n_, a[0]),
          heightsOfA_(a, m_, b[0]) {}

    bool cross() const {
        if (n_ == Vec3d{} || m_ == Vec3d{}) return false;
        if (flat(heightsOfB_) || flat(heightsOfA_))
            return overlapAcross(a_, n_) && overlapAcross(b_, m_);
        return through(heightsOfB_) && through(heightsOfA_) && overlapAcrossEdges();
    }
    /// Whether a corner of one may lie on the other.
    bool mayTouch() const { return meets(heightsOfB_) && meets(heightsOfA_); }
    const Vec3d& normalOfFirst() const { return n_; }
    const Vec3d& normalOfSecond() const { return m_; }

private:
    bool flat(const Interval& heights) const {
        return std::max(-heights.low, heights.high) <= tolerance_;
    }
    bool through(const Interval& heights) const {
        return std::min(-heights.low, heights.high) > tolerance_;
    }
    bool meets(const Interval& heights) const {
        return heights.low <= tolerance_ && heights.high >= -tolerance_;
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
    Vec3d n_, m_;  ///< unit normals
    Interval heightsOfB_, heightsOfA_;
};

bool haveCommonCorner(const TriangleMesh::Triangle& t, const TriangleMesh::Triangle& u) {
    return std::find_first_of(t.begin(), t.end(), u.begin(), u.end()) != t.end();
}

double distanceToEdges(const Vec3d& p, const Corners& t) {
    return std::min({distanceToSegment(p, t[0], t[1]), distanceToSegment(p, t[1], t[2]),
                     distanceToSegment(p, t[2], t[0])});
}

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

MeshCrossings meshCrossings(const TriangleMesh& mesh, double tolerance, const Progress& progress) {
    // The pieces of a triangle with many points in an edge are long and beside each other, and all
    // boxes of two would meet.
    const auto& triangles = mesh.unsplit.empty() ? mesh.triangles : mesh.unsplit;
    const TriangleTree tree(mesh.points, triangles);
    const auto cornersOf = [&](std::uint32_t t) {
        const auto& [a, b, c] = triangles[t];
        return Corners{mesh.points[a], mesh.points[b], mesh.points[c]};
    };
    constexpr double kTouch = 0.01;  // of the tolerance
    const bool wasSplit = !mesh.unsplit.empty();
    const auto isOn = [&](const Vec3d& p, const Corners& t) {
        return length(nearestOnTriangle(p, t[0], t[1], t[2]).point - p) <= kTouch * tolerance &&
               !(wasSplit && distanceToEdges(p, t) <= tolerance);
    };
    std::atomic<std::size_t> pairs{0};
    std::vector<std::vector<MeshContact>> contacts(tree.runs());
    parallelFor(tree.runs(), 256, progress, [&](std::size_t begin, std::size_t end) {
        for (std::size_t r = begin; r < end && pairs < kMostCrossingPairs; ++r) {
            std::size_t found = 0;
            tree.forPairs(r, [&](std::uint32_t t, std::uint32_t u) {
                const Corners a = cornersOf(t), b = cornersOf(u);
                const Pair pair(a, b, tolerance);
                found += pair.cross();
                if (!pair.mayTouch() || haveCommonCorner(triangles[t], triangles[u])) return;
                for (std::size_t k = 0; k < 3; ++k) {
                    if (isOn(b[k], a))
                        contacts[r].push_back({triangles[u][k], pair.normalOfFirst()});
                    if (isOn(a[k], b))
                        contacts[r].push_back({triangles[t][k], pair.normalOfSecond()});
                }
            });
            if (found > 0) pairs += found;
        }
    });
    MeshCrossings crossings{std::min(pairs.load(), kMostCrossingPairs), {}};
    // Of a million pairs and more not all were looked at.
    if (crossings.pairs < kMostCrossingPairs)
        for (const auto& some : contacts)
            crossings.contacts.insert(crossings.contacts.end(), some.begin(), some.end());
    return crossings;
}

void separate(TriangleMesh& mesh, const std::vector<MeshContact>& contacts, double by) {
    constexpr double kLeastTilt = 0.1, kSamePlane = 1 - 1e-9;
    struct Point {
        Vec3d inward;
        std::vector<Vec3d> normals;
    };
    std::map<std::uint32_t, Point> points;
    for (const MeshContact& c : contacts) {
        std::vector<Vec3d>& normals = points[c.point].normals;
        if (std::none_of(normals.begin(), normals.end(),
                         [&](const Vec3d& n) { return std::abs(dot(n, c.normal)) > kSamePlane; }))
            normals.push_back(c.normal);
    }
    if (points.empty()) return;
    for (const TriangleMesh::Triangle& t : mesh.triangles)
        for (const std::uint32_t p : t)
            if (const auto at = points.find(p); at != points.end())
                for (const std::uint32_t q : t)
                    at->second.inward += mesh.points[q] - mesh.points[p];
    for (const auto& [p, point] : points)
        for (const Vec3d& n : point.normals) {
            const Vec3d along = normalized(point.inward);
            const double tilt = std::abs(dot(along, n));
            // Where its own triangles are in the plane, to one side.
            mesh.points[p] += tilt < kLeastTilt ? by * n : by / tilt * along;
        }
}

}  // namespace igeo
