#include <igeo/path/detail/triangle_strip.h>

#include <igeo/base/nearest_on_triangle.h>

#include <algorithm>
#include <numbers>
#include <queue>
#include <unordered_map>

namespace igeo {

namespace {

using Side = SurfaceTriangles::Side;
constexpr std::uint32_t kNone = SurfaceTriangles::kNone;

/// Positive where c lies to the left of the ray from a to b.
double leftOf(Vec2d a, Vec2d b, Vec2d c) { return cross(b - a, c - a); }

/// Searches for a strip between two points.
class StripSearch {
public:
    StripSearch(const SurfaceTriangles& triangles, const Vec3d& from, const Vec3d& to)
        : triangles_(triangles), from_(from), to_(to) {}

    TriangleStrip from(std::uint32_t start);

private:
    /// How the search reached a triangle.
    struct Reached {
        double cost = kInfinity;
        Vec3d at;
        Side by;  ///< the edge of the triangle before
        bool done = false;
    };
    struct Waiting {
        double least;  ///< least length of a curve through it
        std::uint32_t triangle;
        bool operator<(const Waiting& o) const {
            return least != o.least ? least > o.least : triangle > o.triangle;
        }
    };

    bool holdsEnd(std::uint32_t t) const {
        constexpr double kOn = 1e-6;
        const Vec3d q = nearestOnTriangle(to_, triangles_.corner(t, 0), triangles_.corner(t, 1),
                                          triangles_.corner(t, 2))
                            .point;
        return length(q - to_) <= kOn;
    }
    /// Where the shortest curve from a point to the end crosses an edge, with both sides laid flat.
    Vec3d crossing(const Vec3d& p, const Side& side) const {
        const Vec3d a = triangles_.corner(side.triangle, side.corner),
                    e = triangles_.corner(side.triangle, side.corner + 1) - a;
        const double l2 = dot(e, e);
        if (!(l2 > 0)) return a;
        const double sp = dot(p - a, e) / l2, se = dot(to_ - a, e) / l2,
                     hp = length(p - a - sp * e), he = length(to_ - a - se * e);
        const double s = hp + he > 0 ? (sp * he + se * hp) / (hp + he) : se;
        return a + std::clamp(s, 0.0, 1.0) * e;
    }
    TriangleStrip stripTo(std::uint32_t last) const;

    const SurfaceTriangles& triangles_;
    Vec3d from_, to_;
    std::unordered_map<std::uint32_t, Reached> reached_;
};

TriangleStrip StripSearch::from(std::uint32_t start) {
    // The ends are about a voxel apart; a strip around the rim of a thin plate is longer.
    const double limit = 3 * length(to_ - from_) + 2;
    std::priority_queue<Waiting> queue;
    reached_[start] = {0, from_, {}};
    queue.push({length(to_ - from_), start});
    while (!queue.empty()) {
        const std::uint32_t t = queue.top().triangle;
        queue.pop();
        if (std::exchange(reached_[t].done, true)) continue;
        if (holdsEnd(t)) return stripTo(t);
        const Reached here = reached_[t];
        for (unsigned k = 0; k < 3; ++k) {
            const Vec3d p = crossing(here.at, {t, k});
            const double cost = here.cost + length(p - here.at), least = cost + length(to_ - p);
            if (least > limit) continue;
            triangles_.forBeyond({t, k}, [&](const Side& beyond) {
                Reached& there = reached_[beyond.triangle];
                if (there.done || !(cost < there.cost)) return;
                there = {cost, p, {t, k}};
                queue.push({least, beyond.triangle});
            });
        }
    }
    return {from_, to_, {}, kNone};
}

TriangleStrip StripSearch::stripTo(std::uint32_t last) const {
    TriangleStrip strip{from_, to_, {}, last};
    for (Side by = reached_.at(last).by; by.triangle != kNone; by = reached_.at(by.triangle).by)
        strip.exits.push_back(by);
    std::reverse(strip.exits.begin(), strip.exits.end());
    return strip;
}

/// A strip laid flat, and the shortest curve in it.
class FlatStrip {
public:
    FlatStrip(const SurfaceTriangles& triangles, const TriangleStrip& strip);

    double curveLength() const { return length_; }
    std::vector<Vec3d> curve() const;
    /// Passes vertices on their other side where that makes the curve shorter.
    /// @return whether there are any
    bool turned(TriangleStrip& strip) const;

private:
    /// An edge between two triangles of the strip. The first and the last are the ends.
    struct Portal {
        std::array<std::uint32_t, 2> vertex{kNone, kNone};  ///< left, right
        std::array<Vec2d, 2> at;
    };
    /// A vertex around which the curve bends: an end of a portal.
    struct Bend {
        std::size_t portal;
        unsigned side;  ///< 0: left, 1: right
    };

    void layOut();
    void pullTight();
    Vec2d at(const Bend& b) const { return portals_[b.portal].at[b.side]; }
    Vec3d point(std::size_t portal, double share) const;
    double angleAt(std::uint32_t t, std::uint32_t vertex) const;
    Side otherSideAt(std::uint32_t t, std::uint32_t vertex, const Side& side) const;
    /// The edges of a path around the other side of a vertex.
    /// @return none where the triangles end there or the path is no shorter
    std::vector<Side> wayAround(std::size_t bend, std::size_t first, std::size_t last) const;

    const SurfaceTriangles& triangles_;
    const TriangleStrip& strip_;
    std::vector<Portal> portals_;
    std::vector<Bend> bends_;  ///< the start, the bends of the curve, the end
    double length_ = 0;
};

FlatStrip::FlatStrip(const SurfaceTriangles& triangles, const TriangleStrip& strip)
    : triangles_(triangles), strip_(strip), portals_(strip.exits.size() + 2) {
    if (strip.exits.empty()) {
        portals_[0].at = {Vec2d{}, Vec2d{}};
        const Vec2d to{length(strip.to - strip.from), 0};
        portals_[1].at = {to, to};
    } else {
        layOut();
    }
    pullTight();
    for (std::size_t k = 1; k < bends_.size(); ++k)
        length_ += length(at(bends_[k]) - at(bends_[k - 1]));
}

void FlatStrip::layOut() {
    const std::vector<Vec3d>& p = triangles_.points();
    /// A point beyond or before an edge, at the same distance from it as in space.
    auto beside = [&](const Portal& edge, const Vec3d& q, double side) {
        const Vec3d l = p[edge.vertex[0]], e = p[edge.vertex[1]] - l;
        const double width = length(e);
        const double along = width > 0 ? dot(q - l, e) / width : 0;
        const double off = side * (width > 0 ? length(cross(e, q - l)) / width : length(q - l));
        const Vec2d ends = edge.at[1] - edge.at[0];
        const double flat = length(ends);
        const Vec2d unit = flat > 0 ? Vec2d{ends.x / flat, ends.y / flat} : Vec2d{1, 0};
        return Vec2d{edge.at[0].x + along * unit.x - off * unit.y,
                     edge.at[0].y + along * unit.y + off * unit.x};
    };
    const SurfaceTriangles::Triangle& first = triangles_[strip_.exits[0].triangle];
    const unsigned k = strip_.exits[0].corner;
    Portal& one = portals_[1];
    one.vertex = {first[(k + 1) % 3], first[k]};
    one.at = {Vec2d{}, Vec2d{length(p[one.vertex[1]] - p[one.vertex[0]]), 0}};
    const Vec2d start = beside(one, strip_.from, -1);
    portals_[0].at = {start, start};
    for (std::size_t i = 1; i < strip_.exits.size(); ++i) {
        const Portal& before = portals_[i];
        Portal& next = portals_[i + 1] = before;
        const Side exit = strip_.exits[i];
        const SurfaceTriangles::Triangle& t = triangles_[exit.triangle];
        std::uint32_t apex = t[0];
        for (const std::uint32_t v : t)
            if (v != before.vertex[0] && v != before.vertex[1]) apex = v;
        const std::uint32_t a = t[exit.corner], b = t[(exit.corner + 1) % 3];
        const std::size_t replaced = a == before.vertex[0] || b == before.vertex[0] ? 1 : 0;
        next.vertex[replaced] = apex;
        next.at[replaced] = beside(before, p[apex], 1);
    }
    const Vec2d end = beside(portals_[portals_.size() - 2], strip_.to, 1);
    portals_.back().at = {end, end};
    // Ends at vertices.
    constexpr double kSame = 1e-9;
    for (Portal& portal : portals_)
        for (Vec2d& q : portal.at)
            for (const Vec2d& same : {start, end})
                if (length(q - same) < kSame) q = same;
}

void FlatStrip::pullTight() {
    bends_ = {{0, 0}};
    // Left and right border of the funnel from the last bend.
    std::array<Bend, 2> border{Bend{0, 0}, Bend{0, 1}};
    Vec2d apex = portals_[0].at[0];
    for (std::size_t i = 1; i < portals_.size(); ++i)
        for (unsigned side = 0; side < 2; ++side) {
            const double sign = side == 0 ? 1 : -1;
            const Vec2d p = portals_[i].at[side], own = at(border[side]),
                        other = at(border[1 - side]);
            if (sign * leftOf(apex, own, p) > 0) continue;  // wider: no change
            // From a start on an edge both ends lie in one line: rounding must not separate them.
            if (p == own || p == apex || p == other || other == apex ||
                sign * leftOf(apex, other, p) >= 0) {
                border[side] = {i, side};
                continue;
            }
            // Beyond the other border: the curve bends there.
            const Bend bend = border[1 - side];
            bends_.push_back(bend);
            apex = at(bend);
            border = {Bend{bend.portal, bend.side}, Bend{bend.portal, bend.side}};
            i = bend.portal;
            break;
        }
    bends_.push_back({portals_.size() - 1, 0});
}

Vec3d FlatStrip::point(std::size_t portal, double share) const {
    const Vec3d a = triangles_.points()[portals_[portal].vertex[0]],
                b = triangles_.points()[portals_[portal].vertex[1]];
    return share <= 0 ? a : share >= 1 ? b : a + share * (b - a);
}

std::vector<Vec3d> FlatStrip::curve() const {
    constexpr double kSame = 1e-9;
    std::vector<Vec3d> points{strip_.from};
    auto add = [&](const Vec3d& p) {
        if (length(p - points.back()) > kSame) points.push_back(p);
    };
    for (std::size_t k = 1; k < bends_.size(); ++k) {
        const Vec2d a = at(bends_[k - 1]), b = at(bends_[k]);
        for (std::size_t i = bends_[k - 1].portal + 1; i < bends_[k].portal; ++i) {
            const double left = leftOf(a, b, portals_[i].at[0]),
                         right = leftOf(a, b, portals_[i].at[1]);
            if (left > right) add(point(i, left / (left - right)));
        }
        if (k + 1 < bends_.size()) add(point(bends_[k].portal, bends_[k].side));
    }
    // The end itself, bit by bit.
    if (points.size() > 1 && length(points.back() - strip_.to) <= kSame) points.pop_back();
    points.push_back(strip_.to);
    return points;
}

double FlatStrip::angleAt(std::uint32_t t, std::uint32_t vertex) const {
    const unsigned k = triangles_[t][0] == vertex ? 0 : triangles_[t][1] == vertex ? 1 : 2;
    return triangles_.angle(t, k);
}

Side FlatStrip::otherSideAt(std::uint32_t t, std::uint32_t vertex, const Side& side) const {
    const unsigned k = triangles_[t][0] == vertex ? 0 : triangles_[t][1] == vertex ? 1 : 2;
    return {t, side.corner == k ? (k + 2) % 3 : k};
}

std::vector<Side> FlatStrip::wayAround(std::size_t bend, std::size_t first,
                                       std::size_t last) const {
    constexpr double kPi = std::numbers::pi, kLess = 1e-7;
    constexpr std::size_t kMost = 10000;
    const Bend& b = bends_[bend];
    const std::uint32_t vertex = portals_[b.portal].vertex[b.side];
    double around = 0;
    for (std::size_t i = first - 1; i <= last; ++i) around += angleAt(strip_.triangle(i), vertex);
    const std::uint32_t end = strip_.triangle(last);
    std::vector<Side> sides{
        otherSideAt(strip_.triangle(first - 1), vertex, strip_.exits[first - 1])};
    while (true) {
        const auto beyond = triangles_.beyond(sides.back());
        if (!beyond || sides.size() > kMost) return {};
        if (beyond->triangle == end) break;
        around += angleAt(beyond->triangle, vertex);
        sides.push_back(otherSideAt(beyond->triangle, vertex, *beyond));
    }
    const Vec2d in = at(b) - at(bends_[bend - 1]), out = at(bends_[bend + 1]) - at(b);
    const double turn = std::abs(std::atan2(cross(in, out), in.x * out.x + in.y * out.y));
    return around - kPi - turn < kPi - kLess ? sides : std::vector<Side>{};
}

bool FlatStrip::turned(TriangleStrip& strip) const {
    std::vector<Side> exits;
    std::size_t done = 0;  // number of exits of the old strip already processed
    bool any = false;
    for (std::size_t k = 1; k + 1 < bends_.size(); ++k) {
        const Bend& b = bends_[k];
        const std::uint32_t vertex = portals_[b.portal].vertex[b.side];
        std::size_t first = b.portal, last = b.portal;
        auto here = [&](std::size_t i) { return portals_[i].vertex[b.side] == vertex; };
        while (first > 1 && here(first - 1)) --first;
        while (last + 2 < portals_.size() && here(last + 1)) ++last;
        if (first <= done) continue;
        const std::vector<Side> sides = wayAround(k, first, last);
        if (sides.empty()) continue;
        exits.insert(exits.end(), strip_.exits.begin() + std::ptrdiff_t(done),
                     strip_.exits.begin() + std::ptrdiff_t(first - 1));
        exits.insert(exits.end(), sides.begin(), sides.end());
        done = last;
        any = true;
    }
    if (!any) return false;
    exits.insert(exits.end(), strip_.exits.begin() + std::ptrdiff_t(done), strip_.exits.end());
    const std::vector<TriangleStrip> one{{strip_.from, strip_.to, std::move(exits), strip_.last}};
    strip = strip_.winds ? joinedWinding(triangles_, one, 0, 1) : joined(one, 0, 1);
    return true;
}

/// Removes a turn around one vertex that has come back to triangle t, as a step there and back.
void cutTurn(const SurfaceTriangles& triangles, std::vector<Side>& exits, std::uint32_t t) {
    std::array<std::uint32_t, 2> shared{kNone, kNone};
    for (std::size_t k = exits.size(); k-- > 0;) {
        const SurfaceTriangles::Triangle& corners = triangles[exits[k].triangle];
        const std::uint32_t a = corners[exits[k].corner], b = corners[(exits[k].corner + 1) % 3];
        if (k + 1 == exits.size()) shared = {a, b};
        for (std::uint32_t& v : shared)
            if (v != a && v != b) v = kNone;
        if (shared[0] == kNone && shared[1] == kNone) return;
        if (exits[k].triangle == t) return exits.resize(k);
    }
}

}  // namespace

std::vector<TriangleStrip> stripsAlong(const SurfaceTriangles& triangles,
                                       const std::vector<Vec3d>& curve) {
    std::vector<TriangleStrip> strips;
    std::uint32_t at = kNone;
    for (std::size_t k = 1; k < curve.size(); ++k) {
        if (at == kNone) at = triangles.nearest(curve[k - 1]).triangle;
        strips.push_back(StripSearch(triangles, curve[k - 1], curve[k]).from(at));
        at = strips.back().last;
    }
    return strips;
}

TriangleStrip joinedWinding(const SurfaceTriangles& triangles,
                            const std::vector<TriangleStrip>& strips, std::size_t begin,
                            std::size_t end) {
    TriangleStrip all{strips[begin].from, strips[end - 1].to, {}, strips[end - 1].last, true};
    for (std::size_t s = begin; s < end; ++s)
        for (const Side& exit : strips[s].exits) {
            cutTurn(triangles, all.exits, exit.triangle);
            all.exits.push_back(exit);
        }
    cutTurn(triangles, all.exits, all.last);
    return all;
}

TriangleStrip joined(const std::vector<TriangleStrip>& strips, std::size_t begin, std::size_t end) {
    TriangleStrip all{strips[begin].from, strips[end - 1].to, {}, strips[end - 1].last};
    std::unordered_map<std::uint32_t, std::size_t> place;
    auto cutLoop = [&](std::uint32_t t) {
        const auto at = place.find(t);
        if (at == place.end()) return;
        const std::size_t first = at->second;
        for (std::size_t k = first; k < all.exits.size(); ++k) place.erase(all.exits[k].triangle);
        all.exits.resize(first);
    };
    for (std::size_t s = begin; s < end; ++s)
        for (const Side& exit : strips[s].exits) {
            cutLoop(exit.triangle);
            place[exit.triangle] = all.exits.size();
            all.exits.push_back(exit);
        }
    cutLoop(all.last);
    return all;
}

std::vector<Vec3d> shortestCurve(const SurfaceTriangles& triangles, TriangleStrip strip,
                                 const Progress& progress) {
    constexpr int kMostRounds = 1000;
    constexpr double kShorter = 1e-12;
    std::vector<Vec3d> curve;
    double least = kInfinity;
    for (int round = 0; round < kMostRounds; ++round) {
        progress.throwIfCancelled();
        const FlatStrip flat(triangles, strip);
        if (!(flat.curveLength() < least * (1 - kShorter))) break;
        least = flat.curveLength();
        curve = flat.curve();
        TriangleStrip next;
        if (!flat.turned(next)) break;
        strip = std::move(next);
    }
    return curve;
}

}  // namespace igeo
