#include <igeo/path/detail/triangle_walk.h>

#include <igeo/base/nearest_on_triangle.h>

#include <algorithm>
#include <numbers>
#include <vector>

namespace igeo {

namespace {

using Side = SurfaceTriangles::Side;
constexpr double kExactlyOn = 1e-9, kPi = std::numbers::pi;  // voxels

}  // namespace

TriangleWalk::TriangleWalk(const SurfaceTriangles& triangles, const Vec3d& p,
                           const Vec3d& direction)
    : triangles_(triangles) {
    const SurfaceTriangles::Place at = triangles.nearest(p);
    t_ = at.triangle;
    p_ = at.point;
    chooseTriangle(direction);
}

TriangleWalk::EdgeFrame TriangleWalk::frame(const Side& side) const {
    const Vec3d a = triangles_.corner(side.triangle, side.corner),
                along = normalized(triangles_.corner(side.triangle, side.corner + 1) - a),
                third = triangles_.corner(side.triangle, side.corner + 2) - a;
    return {along, normalized(tangential(third, along))};
}

bool TriangleWalk::leadsInto(std::uint32_t t, const Vec3d& along) const {
    for (unsigned k = 0; k < 3; ++k) {
        const Vec3d inward = frame({t, k}).inward;
        if (dot(p_ - triangles_.corner(t, k), inward) < kExactlyOn &&
            dot(along, inward) < -kExactlyOn)
            return false;
    }
    return true;
}

/// Of the triangles that contain the start, on an edge or a corner, chooses the one into which the
/// direction leads and which is nearest to it.
void TriangleWalk::chooseTriangle(const Vec3d& direction) {
    constexpr std::size_t kMost = 1000;
    // Within 0.6 degrees of the normal a direction is too uncertain.
    constexpr double kAlong = 0.01;
    const Vec3d unit = normalized(direction);
    std::vector<std::uint32_t> around{t_};
    double most = 0;
    for (std::size_t i = 0; i < around.size() && i < kMost; ++i) {
        const std::uint32_t t = around[i];
        const Vec3d along = tangential(unit, triangles_.normal(t));
        // Where the direction leads into no triangle, the nearest is chosen: the walk crosses its
        // edge.
        const double share = length(along) * (leadsInto(t, along) ? 1 : 1e-3);
        if (length(along) > kAlong && share > most)
            most = share, t_ = t, velocity_ = normalized(along);
        for (unsigned k = 0; k < 3; ++k)
            triangles_.forBeyond({t, k}, [&](const Side& beyond) {
                const std::uint32_t u = beyond.triangle;
                const Vec3d q = nearestOnTriangle(p_, triangles_.corner(u, 0),
                                                  triangles_.corner(u, 1), triangles_.corner(u, 2))
                                    .point;
                if (length(q - p_) < kExactlyOn &&
                    std::find(around.begin(), around.end(), u) == around.end())
                    around.push_back(u);
            });
    }
}

std::optional<double> TriangleWalk::advance(double most) {
    constexpr double kParallel = 1e-12;
    double way = kInfinity;
    unsigned exit = 0;
    for (unsigned k = 0; k < 3; ++k) {
        const Vec3d inward = frame({t_, k}).inward;
        const double speed = -dot(velocity_, inward);
        if (!(speed > kParallel)) continue;
        const double to = std::max(dot(p_ - triangles_.corner(t_, k), inward), 0.0) / speed;
        if (to < way) way = to, exit = k;
    }
    if (most < way) {
        p_ += most * velocity_;
        return most;
    }
    if (way < kExactlyOn) way = 0;  // no step at all, or rounding would keep a stuck walk going
    const Vec3d a = triangles_.corner(t_, exit), b = triangles_.corner(t_, exit + 1);
    p_ += way * velocity_;
    bool onward;
    if (length(p_ - a) < kExactlyOn)
        onward = passVertex(exit);
    else if (length(p_ - b) < kExactlyOn)
        onward = passVertex((exit + 1) % 3);
    else
        onward = crossEdge(exit);
    if (!onward && way == 0) return std::nullopt;
    return way;
}

bool TriangleWalk::crossEdge(unsigned corner) {
    const Side side{t_, corner};
    const EdgeFrame here = frame(side);
    const double along = dot(velocity_, here.along), out = -dot(velocity_, here.inward);
    double straightest = -2;
    Vec3d next;
    triangles_.forBeyond(side, [&](const Side& beyond) {
        const EdgeFrame there = frame(beyond);
        const Vec3d v = normalized(along * here.along + out * there.inward);
        if (dot(v, velocity_) <= straightest) return;
        straightest = dot(v, velocity_);
        t_ = beyond.triangle;
        next = v;
    });
    if (straightest > -2) velocity_ = next;
    return straightest > -2;
}

TriangleWalk::Turn TriangleWalk::turnAround(unsigned corner, unsigned first, double wanted,
                                            bool move) {
    const std::uint32_t vertex = triangles_[t_][corner];
    constexpr int kMost = 100000;
    /// The end of an edge that is not the vertex.
    auto otherEnd = [&](const Side& side) {
        const std::uint32_t a = triangles_[side.triangle][side.corner],
                            b = triangles_[side.triangle][(side.corner + 1) % 3];
        return triangles_.points()[a == vertex ? b : a];
    };
    const Vec3d center = triangles_.points()[vertex];
    Side side{t_, first};
    Turn turn{angleBetween(-velocity_, otherEnd(side) - center), false};
    for (int step = 0; step < kMost; ++step) {
        const auto beyond = triangles_.beyond(side);
        if (!beyond) return turn;
        if (beyond->triangle == t_) {
            // The angle on the other side of the path so far.
            turn.angle += angleBetween(otherEnd(*beyond) - center, -velocity_);
            turn.closed = true;
            return turn;
        }
        const unsigned k = triangles_[beyond->triangle][beyond->corner] == vertex
                               ? beyond->corner
                               : (beyond->corner + 1) % 3;
        side = {beyond->triangle, beyond->corner == k ? (k + 2) % 3 : k};
        const double angle = angleBetween(otherEnd(*beyond) - center, otherEnd(side) - center);
        if (move && turn.angle + angle >= wanted) {
            const double rest = std::max(wanted - turn.angle, 0.0);
            const Vec3d along = normalized(otherEnd(*beyond) - center);
            velocity_ = std::cos(rest) * along + std::sin(rest) * frame(*beyond).inward;
            t_ = beyond->triangle;
            return turn;
        }
        turn.angle += angle;
    }
    return turn;
}

bool TriangleWalk::passVertex(unsigned corner) {
    constexpr double kRoom = 1e-7;
    p_ = triangles_.corner(t_, corner);
    const Vec3d back = -velocity_;
    for (const unsigned side : {corner, (corner + 2) % 3}) {
        const Turn turn = turnAround(corner, side, kInfinity, false);
        const double wanted = turn.closed ? turn.angle / 2 : std::min(kPi, turn.angle);
        if (!turn.closed && turn.angle < kPi - kRoom) continue;
        const Vec3d edge = triangles_.corner(t_, side == corner ? corner + 1 : side) - p_;
        if (angleBetween(back, edge) >= wanted) {  // at the tip of a spike
            velocity_ =
                std::cos(wanted) * back + std::sin(wanted) * normalized(tangential(edge, back));
            return true;
        }
        // The other edge of the same triangle may come first, from its side.
        if (turnAround(corner, side, wanted, true).angle <= wanted) return true;
    }
    return false;
}

}  // namespace igeo
