#include <igeo/path/detail/triangle_walk.h>

#include <igeo/base/nearest_on_triangle.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace igeo {

namespace {

constexpr double kExactlyOn = 1e-9;  // voxels

Vec2d unitVector(const Vec2d& v) { return 1 / length(v) * v; }

}  // namespace

TriangleWalk::TriangleWalk(const SurfaceTriangles& triangles, const Vec3d& p,
                           const Vec3d& direction)
    : triangles_(triangles) {
    const SurfaceTriangles::Place at = triangles.nearest(p);
    chooseTriangle(normalized(direction), at.triangle, at.point);
}

TriangleWalk::Flat TriangleWalk::laidFlat(const Side& side) const {
    const Vec3d a = triangles_.corner(side.triangle, side.corner),
                ab = triangles_.corner(side.triangle, side.corner + 1) - a,
                ac = triangles_.corner(side.triangle, side.corner + 2) - a, x = normalized(ab),
                up = tangential(ac, x);
    return {{Vec2d{}, Vec2d{length(ab), 0}, Vec2d{dot(ac, x), length(up)}}, x, normalized(up)};
}

void TriangleWalk::enter(const Side& side, const Vec2d& at, const Vec2d& velocity) {
    side_ = side, flat_ = laidFlat(side);
    at_ = at, velocity_ = velocity;
}

std::pair<TriangleWalk::Side, Vec2d> TriangleWalk::placeIn(std::uint32_t t, const Vec3d& p) const {
    Side side{t, 0};
    for (unsigned k = 0; k < 3; ++k) {
        const Vec3d r = p - triangles_.corner(t, k);
        if (length(r) < kExactlyOn) return {{t, k}, {}};
        if (std::abs(dot(r, laidFlat({t, k}).y)) < kExactlyOn) side = {t, k};
    }
    const Flat flat = laidFlat(side);
    const Vec3d r = p - triangles_.corner(t, side.corner);
    const double up = dot(r, flat.y);
    return {side, {dot(r, flat.x), std::abs(up) < kExactlyOn ? 0 : up}};
}

void TriangleWalk::chooseTriangle(const Vec3d& direction, std::uint32_t first, const Vec3d& p) {
    constexpr std::size_t kMost = 1000;
    // Within 0.6 degrees of the normal a direction is too uncertain. One within 1e-4 radians of a
    // plane lies in it. Triangles narrower than 1e-6 voxels have no certain plane.
    constexpr double kAlong = 0.01, kInPlane = 1 - 1e-8 / 2, kNarrow = 1e-6, kOut = 1e-9;
    std::vector<std::uint32_t> around{first};
    double most = 0;
    bool comesToVertex = false;
    for (std::size_t i = 0; i < around.size() && i < kMost; ++i) {
        const std::uint32_t t = around[i];
        const auto [side, at] = placeIn(t, p);
        const Flat flat = laidFlat(side);
        const bool onEdge = at.y == 0, atCorner = at == Vec2d{};
        auto leadsInto = [&](const Vec2d& v) {
            return (!onEdge || v.y > -kOut) &&
                   (!atCorner || cross(v, unitVector(flat.corner[2])) > -kOut);
        };
        const Vec2d along{dot(direction, flat.x), dot(direction, flat.y)};
        const bool leads = leadsInto(along), comes = !leads && leadsInto(-1 * along);
        const double size = length(along), score = size * (leads   ? 1
                                                           : comes ? 2e-3
                                                                   : 1e-3) +
                                                   (size > kInPlane);
        if (flat.corner[2].y > kNarrow && size > kAlong && score > most) {
            most = score;
            enter(side, at, unitVector(along));
            comesToVertex = atCorner && comes;
        }
        for (unsigned k = 0; k < 3; ++k)
            triangles_.forBeyond({t, k}, [&](const Side& beyond) {
                const std::uint32_t u = beyond.triangle;
                const Vec3d q = nearestOnTriangle(p, triangles_.corner(u, 0),
                                                  triangles_.corner(u, 1), triangles_.corner(u, 2))
                                    .point;
                if (length(q - p) < kExactlyOn &&
                    std::find(around.begin(), around.end(), u) == around.end())
                    around.push_back(u);
            });
    }
    if (comesToVertex) ended_ = !passVertex(0);
}

std::optional<double> TriangleWalk::advance(double most) {
    if (ended_) return std::nullopt;
    std::array<double, 3> left;  // of the line, voxels
    std::array<bool, 3> isLeft;
    unsigned nearest = 0, vertex = 3;
    double way = kInfinity;
    for (unsigned k = 0; k < 3; ++k) {
        const Vec2d to = flat_.corner[k] - at_;
        left[k] = cross(velocity_, to), isLeft[k] = left[k] > 0;
        if (std::abs(left[k]) < std::abs(left[nearest])) nearest = k;
        const double ahead = dot(velocity_, to);
        if (std::abs(left[k]) < kExactlyOn && ahead > 0 && ahead < way) way = ahead, vertex = k;
    }
    if (vertex < 3 && way < most + kExactlyOn) {
        ended_ = !passVertex(vertex);
        return std::min(way, most);
    }
    unsigned exit = 0;
    double share = 0;
    if (vertex == 3) {
        // A line through a corner has the others on one side.
        if (isLeft[0] == isLeft[1] && isLeft[1] == isLeft[2]) isLeft[nearest] = !isLeft[nearest];
        while (isLeft[exit] || !isLeft[(exit + 1) % 3]) ++exit;
        const double from = left[exit], to = left[(exit + 1) % 3];
        share = from != to ? std::clamp(from / (from - to), 0.0, 1.0) : 0;
        const Vec2d a = flat_.corner[exit], b = flat_.corner[(exit + 1) % 3];
        way = std::max(dot(velocity_, a + share * (b - a) - at_), 0.0);
    }
    if (most < way) {
        at_ = at_ + most * velocity_;
        return most;
    }
    ended_ = !crossEdge(exit, share);
    return way;
}

/// @param exit   the first corner of the edge, in flat_
/// @param share  of the edge, where the walk crosses it
bool TriangleWalk::crossEdge(unsigned exit, double share) {
    const Vec2d a = flat_.corner[exit], b = flat_.corner[(exit + 1) % 3], edge = unitVector(b - a);
    const double along = dot(velocity_, edge), out = cross(velocity_, edge);
    const Vec3d before = flat_.inSpace(velocity_);
    const Side side{side_.triangle, (side_.corner + exit) % 3};
    const std::uint32_t first = triangles_[side.triangle][side.corner];
    double straightest = -2;
    // Where it ends if there is nothing beyond.
    at_ = a + share * (b - a);
    triangles_.forBeyond(side, [&](const Side& beyond) {
        const bool alike = triangles_[beyond.triangle][beyond.corner] == first;
        const Flat there = laidFlat(beyond);
        const Vec2d v = unitVector({alike ? along : -along, out});
        const double straight = dot(there.inSpace(v), before);
        if (straight <= straightest) return;
        straightest = straight;
        enter(beyond, {(alike ? share : 1 - share) * there.corner[1].x, 0}, v);
    });
    return straightest > -2;
}

TriangleWalk::Turn TriangleWalk::turnFrom(const Sector& first) const {
    const auto [own, vertexCorner] = first.side;
    const std::uint32_t vertex = triangles_[own][vertexCorner];
    Turn turn{{first}, false};
    for (std::size_t n = 0; n < triangles_.size(); ++n) {
        const Sector& last = turn.sectors.back();
        const auto [t, k] = last.side;
        const auto beyond = triangles_.beyond({t, last.sense < 0 ? k : (k + 2) % 3});
        if (!beyond) break;
        const bool atFirst = triangles_[beyond->triangle][beyond->corner] == vertex;
        const Side side{beyond->triangle, atFirst ? beyond->corner : (beyond->corner + 1) % 3};
        const double whole = triangles_.angle(side.triangle, side.corner);
        turn.closed = side.triangle == own;
        turn.sectors.push_back({side, atFirst ? 0 : whole,
                                turn.closed ? whole - first.angle : whole, atFirst ? 1.0 : -1.0});
        if (turn.closed) break;
    }
    return turn;
}

/// @param corner  in flat_
bool TriangleWalk::passVertex(unsigned corner) {
    constexpr double kRoom = 1e-7, kPi = std::numbers::pi;
    const Side side{side_.triangle, (side_.corner + corner) % 3};
    const Vec2d edge = flat_.corner[(corner + 1) % 3] - flat_.corner[corner];
    const double whole = triangles_.angle(side.triangle, side.corner),
                 turned = std::atan2(cross(velocity_, edge), -dot(velocity_, edge)),
                 back = std::clamp(turned < -kPi / 2 ? turned + 2 * kPi : turned, 0.0, whole);
    at_ = flat_.corner[corner];
    for (const double sense : {-1.0, 1.0}) {
        const Turn turn = turnFrom({side, back, sense < 0 ? back : whole - back, sense});
        double sum = 0;
        for (const Sector& s : turn.sectors) sum += s.angle;
        if (!turn.closed && sum < kPi - kRoom) continue;
        double rest = turn.closed ? sum / 2 : std::min(kPi, sum);
        for (const Sector& s : turn.sectors) {
            if (rest > s.angle && &s != &turn.sectors.back()) {
                rest -= s.angle;
                continue;
            }
            const double angle = s.from + s.sense * std::min(rest, s.angle);
            enter(s.side, {}, {std::cos(angle), std::sin(angle)});
            return true;
        }
    }
    return false;
}

}  // namespace igeo
