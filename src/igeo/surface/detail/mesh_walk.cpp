#include <igeo/surface/detail/mesh_walk.h>

#include <igeo/base/detail/box.h>
#include <igeo/base/detail/disjoint_sets.h>
#include <igeo/base/nearest_on_triangle.h>
#include <igeo/base/point_tree.h>

#include <algorithm>

namespace igeo {

namespace {

constexpr std::uint64_t kNoSide = std::numeric_limits<std::uint64_t>::max();
constexpr std::uint32_t kNoEdge = 3;

/// The point of a segment with the least sum of distances to two points.
Vec3d leastSum(const Vec3d& a, const Vec3d& b, const Vec3d& p, const Vec3d& q) {
    const Vec3d e = b - a;
    const double l2 = dot(e, e);
    if (!(l2 > 0)) return a;
    // Unfolded around the line: p and q on two sides of it, at their distances.
    const double s = dot(p - a, e) / l2, t = dot(q - a, e) / l2;
    const double hp = length(p - a - s * e), hq = length(q - a - t * e);
    const double at = hp + hq > 0 ? (s * hq + t * hp) / (hp + hq) : s;
    return a + std::clamp(at, 0.0, 1.0) * e;
}

}  // namespace

MeshAdjacency::MeshAdjacency(const TriangleMesh& mesh, const MeshTopology& topology)
    : mesh_(mesh), topology_(topology), atBoundary_(mesh.points.size()) {
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t)
        for (std::size_t k = 0; k < 3; ++k) {
            if (topology.neighbor[t][k] == MeshTopology::kMany) many_.emplace_back(edge(t, k), t);
            if (!isBoundary(t, k)) continue;
            atBoundary_[mesh.triangles[t][k]] = true;
            atBoundary_[mesh.triangles[t][(k + 1) % 3]] = true;
        }
    std::sort(many_.begin(), many_.end());
    if (topology.boundaryEdges > 0) findSeams();
    numberComponents();
}

bool MeshAdjacency::overlap(const Side& a, const Side& b, double tolerance) const {
    auto on = [&](const Vec3d& p, const Side& s) {
        return distanceToSegment(p, end(s, 0), end(s, 1)) <= tolerance;
    };
    int ends = 0;
    Vec3d first;
    for (std::size_t k = 0; k < 2; ++k)
        for (const auto& [p, s] : {std::pair(end(a, k), b), std::pair(end(b, k), a)}) {
            // Two ends at one point are a common corner.
            if (!on(p, s) || (ends > 0 && length(p - first) <= 2 * tolerance)) continue;
            if (ends++ == 0) first = p;
        }
    return ends >= 2;
}

void MeshAdjacency::findSeams() {
    constexpr double kTolerance = 1e-6;  // as weld
    const double tolerance = kTolerance * length(Box(mesh_.points).size());
    std::vector<Side> sides;
    std::vector<Vec3d> middles;
    auto halfOf = [&](const Side& s) { return length(end(s, 1) - end(s, 0)) / 2; };
    for (std::uint32_t t = 0; t < mesh_.triangles.size(); ++t)
        for (std::uint32_t k = 0; k < 3; ++k)
            if (isBoundary(t, k)) {
                sides.emplace_back(t, k);
                middles.push_back(0.5 * (end(sides.back(), 0) + end(sides.back(), 1)));
            }
    PointTree tree(middles);
    std::vector<double> reach;
    for (std::size_t k = 0; k < sides.size(); ++k)
        reach.push_back(halfOf(sides[tree.inputIndex(k)]));
    tree.setReach(std::move(reach));
    for (std::size_t k = 0; k < sides.size(); ++k)
        tree.forReaching(middles[k], halfOf(sides[k]) + tolerance, [&](PointTree::Index i) {
            const std::size_t other = tree.inputIndex(i);
            if (other <= k || !overlap(sides[k], sides[other], tolerance)) return;
            seams_.emplace_back(sides[k], sides[other].first);
            seams_.emplace_back(sides[other], sides[k].first);
        });
    std::sort(seams_.begin(), seams_.end());
}

void MeshAdjacency::numberComponents() {
    component_ = topology_.component;
    components_ = topology_.components;
    if (seams_.empty()) return;
    DisjointSets joined(components_);
    for (const auto& [side, u] : seams_) joined.join(component_[side.first], component_[u]);
    std::vector<std::uint32_t> number(components_);
    components_ = 0;
    for (std::uint32_t c = 0; c < number.size(); ++c)
        number[c] = joined.first(c) == c ? std::uint32_t(components_++) : number[joined.first(c)];
    for (std::uint32_t& c : component_) c = number[c];
}

std::vector<MeshAdjacency::AtEdge>::const_iterator MeshAdjacency::firstAtEdge(std::uint32_t t,
                                                                              std::size_t k) const {
    return std::lower_bound(many_.begin(), many_.end(), AtEdge(edge(t, k), 0));
}

bool MeshWalk::isNew(std::uint64_t side) {
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

void MeshWalk::leave(std::uint32_t triangle, const Vec3d& at, double walked, std::uint32_t entry,
                     std::size_t before) {
    const TriangleMesh& mesh = adjacency_.mesh();
    const auto& corner = mesh.triangles[triangle];
    for (std::uint32_t k = 0; k < 3; ++k) {
        if (k == entry) continue;
        const Vec3d next =
            leastSum(mesh.points[corner[k]], mesh.points[corner[(k + 1) % 3]], from_.at, to_.at);
        const double there = walked + igeo::length(next - at),
                     bound = there + igeo::length(to_.at - next);
        if (bound > most_) continue;
        heap_.push_back({bound, there, triangle, k, next, before});
        std::push_heap(heap_.begin(), heap_.end());
    }
}

double MeshWalk::length(const MeshPoint& from, const MeshPoint& to, double most) {
    const double straight = igeo::length(to.at - from.at);
    if (straight > most) return kInfinity;
    if (from.triangle == to.triangle) return straight;
    if (adjacency_.componentOf(from.triangle) != adjacency_.componentOf(to.triangle))
        return kInfinity;
    from_ = from, to_ = to, most_ = most;
    heap_.clear(), passed_.clear();
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
        adjacency_.forBeyond(stop.triangle, stop.edge, [&](std::uint32_t u) {
            arrived |= u == to_.triangle;
            if (arrived) return;
            const auto& in = adjacency_.mesh().triangles[u];
            const std::uint32_t a = adjacency_.mesh().triangles[stop.triangle][stop.edge],
                                b = adjacency_.mesh().triangles[stop.triangle][(stop.edge + 1) % 3];
            std::uint32_t entry = 0;
            while (entry < 3 && !((in[entry] == a && in[(entry + 1) % 3] == b) ||
                                  (in[entry] == b && in[(entry + 1) % 3] == a)))
                ++entry;
            leave(u, stop.at, stop.walked, entry, passed_.size() - 1);
        });
        if (arrived) return stop.bound;
    }
    return kInfinity;
}

double MeshWalk::tightLength(const MeshPoint& from, const MeshPoint& to, double most) {
    constexpr int kRounds = 20;
    constexpr double kSettled = 1e-4;
    const double loose = length(from, to, most);
    if (!(loose < kInfinity) || from.triangle == to.triangle) return loose;
    // The crossings, from the last to the first, between both ends.
    std::vector<Stop>& way = heap_;
    way.clear();
    for (std::size_t k = passed_.size() - 1; k != kNoStop; k = passed_[k].before)
        way.push_back(passed_[k]);
    const TriangleMesh& mesh = adjacency_.mesh();
    double tight = loose;
    for (int round = 0; round < kRounds && way.size() > 1; ++round) {
        double sum = 0;
        Vec3d last = to.at;
        for (std::size_t k = 0; k < way.size(); ++k) {
            const auto& corner = mesh.triangles[way[k].triangle];
            const Vec3d next = k + 1 < way.size() ? way[k + 1].at : from.at;
            way[k].at = leastSum(mesh.points[corner[way[k].edge]],
                                 mesh.points[corner[(way[k].edge + 1) % 3]], last, next);
            sum += igeo::length(way[k].at - last);
            last = way[k].at;
        }
        sum += igeo::length(last - from.at);
        if (tight - std::exchange(tight, std::min(tight, sum)) < kSettled) break;
    }
    return tight;
}

}  // namespace igeo
