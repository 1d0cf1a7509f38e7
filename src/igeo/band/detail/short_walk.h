/// Walks over the triangles of a mesh: the distance of two points along it. Internal.
#pragma once

#include <igeo/base/types.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

namespace igeo {

/// A point of a mesh.
struct MeshPoint {
    std::uint32_t triangle;
    Vec3d at;
};

/// The point of a segment with the least sum of distances to two points.
inline Vec3d leastSum(const Vec3d& a, const Vec3d& b, const Vec3d& p, const Vec3d& q) {
    const Vec3d e = b - a;
    const double l2 = dot(e, e);
    if (!(l2 > 0)) return a;
    // Unfolded around the line: p and q on two sides of it, at their distances.
    const double s = dot(p - a, e) / l2, t = dot(q - a, e) / l2;
    const double hp = length(p - a - s * e), hq = length(q - a - t * e);
    const double at = hp + hq > 0 ? (s * hq + t * hp) / (hp + hq) : s;
    return a + std::clamp(at, 0.0, 1.0) * e;
}

/// The ends of a walk.
struct WalkEnds {
    double length = kInfinity;          ///< of the walk; +infinity: there is none
    std::uint32_t first = 0, last = 0;  ///< the triangles in which it begins and ends
    Vec3d out, in;                      ///< unit directions of travel there; 0 for no length
    bool mirrored = false;  ///< the normals of the two triangles are on different sides of the walk
    bool straight = true;   ///< on its triangles laid flat

    /// The same walk from its end.
    WalkEnds reversed() const { return {length, last, first, -in, -out, mirrored, straight}; }
};

/// The longest walk where a straight one is looked for: before it is pulled tight, over the chord.
constexpr double kBeforeTight = 1.1;

/// The edge of a triangle that is an edge of another one, in either direction; 3: none.
template <typename Triangle>
std::uint32_t edgeShared(const Triangle& triangle, const Triangle& other, std::uint32_t edge) {
    const std::uint32_t a = other[edge], b = other[(edge + 1) % 3];
    std::uint32_t k = 0;
    while (k < 3 && !((triangle[k] == a && triangle[(k + 1) % 3] == b) ||
                      (triangle[k] == b && triangle[(k + 1) % 3] == a)))
        ++k;
    return k;
}

/// Searches for short walks. One per thread, reused.
/// @tparam Mesh  MeshAdjacency or SurfaceTriangles
template <typename Mesh>
class ShortWalk {
public:
    explicit ShortWalk(const Mesh& mesh) : mesh_(mesh) {}

    /// The length of a walk from one point to another, if it finds one of at most `most`; else
    /// +infinity.
    ///
    /// Crosses every edge at the point with the least sum of distances to both ends. Walks over one
    /// edge, or over faces in one plane, are the shortest; others are hardly longer. Time
    /// O(triangles that meet the ellipsoid of points with a sum up to `most`).
    double length(const MeshPoint& from, const MeshPoint& to, double most);
    /// The same with the walk pulled tight over its triangles, by moving each crossing between the
    /// two beside it, in up to 20 rounds. Over a few edges it is then the shortest.
    double tightLength(const MeshPoint& from, const MeshPoint& to, double most);
    /// The same with its directions at both ends.
    WalkEnds ends(const MeshPoint& from, const MeshPoint& to, double most);
    /// Calls visit(a, b, triangle) for each straight part of the walk that `ends` has found, from
    /// its end back to its start.
    template <typename Visit>
    void forSegments(const MeshPoint& from, const MeshPoint& to, Visit& visit) const {
        Vec3d last = to.at;
        std::uint32_t triangle = to.triangle;
        for (const Stop& crossing : heap_) {
            visit(last, crossing.at, triangle);
            last = crossing.at, triangle = crossing.triangle;
        }
        visit(last, from.at, triangle);
    }

private:
    struct Stop {
        double bound, walked;  ///< lower bound of the whole walk; length so far
        std::uint32_t triangle, edge;
        Vec3d at;
        std::size_t before;  ///< of the stops passed, or kNoStop
        bool operator<(const Stop& o) const { return bound > o.bound; }
    };
    static constexpr std::size_t kNoStop = std::numeric_limits<std::size_t>::max();
    static constexpr std::uint64_t kNoSide = std::numeric_limits<std::uint64_t>::max();
    static constexpr std::uint32_t kNoEdge = 3;
    /// Pushes the exits of a triangle onto the heap.
    void leave(std::uint32_t triangle, const Vec3d& at, double walked, std::uint32_t entry,
               std::size_t before);
    /// Whether this walk meets an edge of a triangle for the first time.
    bool isNew(std::uint64_t side);

    const Mesh& mesh_;
    MeshPoint from_{}, to_{};
    double most_ = 0;
    std::vector<Stop> heap_, passed_;  ///< once pulled tight: heap_ has the crossings, last first
    std::vector<std::uint64_t> seen_;  ///< sides of triangles met in this walk, open addressing
    std::size_t seenCount_ = 0;
};

template <typename Mesh>
bool ShortWalk<Mesh>::isNew(std::uint64_t side) {
    if (2 * seenCount_ >= seen_.size()) {
        std::vector<std::uint64_t> old(std::max<std::size_t>(64, 2 * seen_.size()), kNoSide);
        old.swap(seen_);
        seenCount_ = 0;
        for (const std::uint64_t s : old)
            if (s != kNoSide) isNew(s);
    }
    const std::size_t last = seen_.size() - 1;
    std::size_t slot = std::size_t(side * 0x9e3779b97f4a7c15ull >> 20) & last;
    for (; seen_[slot] != kNoSide; slot = (slot + 1) & last)
        if (seen_[slot] == side) return false;
    seen_[slot] = side;
    ++seenCount_;
    return true;
}

template <typename Mesh>
void ShortWalk<Mesh>::leave(std::uint32_t triangle, const Vec3d& at, double walked,
                            std::uint32_t entry, std::size_t before) {
    for (std::uint32_t k = 0; k < 3; ++k) {
        if (k == entry) continue;
        const Vec3d next =
            leastSum(mesh_.corner(triangle, k), mesh_.corner(triangle, k + 1), from_.at, to_.at);
        const double there = walked + igeo::length(next - at),
                     bound = there + igeo::length(to_.at - next);
        if (bound > most_) continue;
        heap_.push_back({bound, there, triangle, k, next, before});
        std::push_heap(heap_.begin(), heap_.end());
    }
}

template <typename Mesh>
double ShortWalk<Mesh>::length(const MeshPoint& from, const MeshPoint& to, double most) {
    heap_.clear(), passed_.clear();
    const double straight = igeo::length(to.at - from.at);
    if (straight > most) return kInfinity;
    if (from.triangle == to.triangle) return straight;
    if (!mesh_.mayJoin(from.triangle, to.triangle)) return kInfinity;
    from_ = from, to_ = to, most_ = most;
    std::fill(seen_.begin(), seen_.end(), kNoSide);
    seenCount_ = 0;
    leave(from.triangle, from.at, 0, kNoEdge, kNoStop);
    while (!heap_.empty()) {
        std::pop_heap(heap_.begin(), heap_.end());
        const Stop stop = heap_.back();
        heap_.pop_back();
        if (!isNew(3 * std::uint64_t(stop.triangle) + stop.edge)) continue;
        passed_.push_back(stop);
        bool arrived = false;
        mesh_.forBeyond(stop.triangle, stop.edge, [&](std::uint32_t u) {
            arrived |= u == to_.triangle;
            if (arrived) return;
            const std::uint32_t entry = edgeShared(mesh_[u], mesh_[stop.triangle], stop.edge);
            leave(u, stop.at, stop.walked, entry, passed_.size() - 1);
        });
        if (arrived) return stop.bound;
    }
    return kInfinity;
}

template <typename Mesh>
double ShortWalk<Mesh>::tightLength(const MeshPoint& from, const MeshPoint& to, double most) {
    constexpr int kRounds = 20;
    constexpr double kSettled = 1e-4;
    const double loose = length(from, to, most);
    if (!(loose < kInfinity) || from.triangle == to.triangle) return loose;
    std::vector<Stop>& way = heap_;
    way.clear();
    for (std::size_t k = passed_.size() - 1; k != kNoStop; k = passed_[k].before)
        way.push_back(passed_[k]);
    double tight = loose;
    for (int round = 0; round < kRounds && way.size() > 1; ++round) {
        double sum = 0;
        Vec3d last = to.at;
        for (std::size_t k = 0; k < way.size(); ++k) {
            const Vec3d next = k + 1 < way.size() ? way[k + 1].at : from.at;
            way[k].at = leastSum(mesh_.corner(way[k].triangle, way[k].edge),
                                 mesh_.corner(way[k].triangle, way[k].edge + 1), last, next);
            sum += igeo::length(way[k].at - last);
            last = way[k].at;
        }
        sum += igeo::length(last - from.at);
        if (tight - std::exchange(tight, std::min(tight, sum)) < kSettled) break;
    }
    return tight;
}

template <typename Mesh>
WalkEnds ShortWalk<Mesh>::ends(const MeshPoint& from, const MeshPoint& to, double most) {
    constexpr double kSame = 1e-6, kBend = 0.05;
    WalkEnds found;
    found.length = tightLength(from, to, most);
    found.first = from.triangle, found.last = to.triangle;
    if (!(found.length < kInfinity)) return found;
    // Crossings at the ends themselves count as inside of the triangle next to them.
    std::vector<Stop>& way = heap_;  // empty within one triangle
    std::size_t end = way.size(), begin = 0;
    auto isAt = [](const Vec3d& p, const Vec3d& q) { return igeo::length(p - q) < kSame; };
    while (begin < end && isAt(way[begin].at, to.at)) found.last = way[begin++].triangle;
    while (end > begin && isAt(way[end - 1].at, from.at)) --end;
    if (end < way.size()) found.first = end > 0 ? way[end - 1].triangle : to.triangle;
    if (begin == end) found.first = found.last;
    Vec3d before = from.at;
    for (std::size_t k = end; k-- > begin;) {
        const Vec3d at = way[k].at, next = k > begin ? way[k - 1].at : to.at;
        const Vec3d in = normalized(at - before), out = normalized(next - at),
                    e = normalized(mesh_.corner(way[k].triangle, way[k].edge + 1) -
                                   mesh_.corner(way[k].triangle, way[k].edge));
        if (k + 1 == end) found.out = in;
        found.in = out;
        const std::uint32_t beyond = k > begin ? way[k - 1].triangle : found.last;
        if (isAt(at, before) || isAt(next, at)) {
            found.straight = false;
        } else {
            found.straight &= std::abs(dot(in, e) - dot(out, e)) < kBend;
            const double left = dot(e, cross(mesh_.normal(way[k].triangle), in)),
                         leftBeyond = dot(e, cross(mesh_.normal(beyond), out));
            found.mirrored ^= left * leftBeyond < 0;
        }
        before = at;
    }
    if (begin == end) found.out = found.in = normalized(to.at - from.at);
    return found;
}

}  // namespace igeo
