/// The lines from a point of a mesh, on its triangles laid flat. Internal.
#pragma once

#include <igeo/band/detail/short_walk.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <numbers>
#include <optional>
#include <queue>
#include <tuple>
#include <unordered_map>
#include <vector>

namespace igeo {

/// The triangles that hold a point: more than one where it is on an edge or a vertex.
/// @param on  a point this close to an edge is on it, voxels
template <typename Mesh>
std::vector<std::uint32_t> trianglesAt(const Mesh& mesh, const MeshPoint& p, double on = 1e-5) {
    std::vector<std::uint32_t> around{p.triangle};
    for (std::size_t n = 0; n < around.size(); ++n) {
        const std::uint32_t t = around[n];
        for (std::uint32_t k = 0; k < 3; ++k) {
            const Vec3d a = mesh.corner(t, k), e = mesh.corner(t, k + 1) - a;
            const double l2 = dot(e, e), s = l2 > 0 ? dot(p.at - a, e) / l2 : 0;
            if (length(a + std::clamp(s, 0.0, 1.0) * e - p.at) > on) continue;
            mesh.forBeyond(t, k, [&](std::uint32_t u) {
                if (std::find(around.begin(), around.end(), u) == around.end()) around.push_back(u);
            });
        }
    }
    return around;
}

/// What becomes of lines that come to a vertex.
enum class AtVertex {
    End,
    GoAround,  ///< where that is shorter than all straight lines: in the shadow of a vertex with
               ///< more than a full turn of faces, or at a boundary
};

/// All straight lines from a point up to a length, and lines that go around vertices: straight
/// from each to the next. The origin of the plane is the point, or the last vertex.
/// @tparam Mesh  MeshAdjacency or SurfaceTriangles
template <typename Mesh>
class MeshFan {
public:
    /// A triangle, as the lines that come over one of its edges meet it.
    struct Part {
        std::uint32_t triangle;
        std::array<Vec2d, 3> corner;
        Vec2d right, left;     ///< the outermost of the lines
        std::size_t before;    ///< the part that they leave, or kNoPart
        std::uint32_t entry;   ///< the edge over which they come; 3: none
        bool mirrored;         ///< laid out clockwise, unlike the first
        std::uint32_t origin;  ///< number of the vertex that they come around; 0: the point itself
        std::uint8_t forks = 0;  ///< edges with several triangles beyond that they have crossed

        /// Whether the lines between two of them come, not those in all directions.
        bool isSector() const { return before != kNoPart || origin > 0; }
    };
    static constexpr std::size_t kNoPart = std::size_t(-1);

    /// Time and memory O(parts), of which there are about as many as triangles that lines meet.
    MeshFan(const Mesh& mesh, const MeshPoint& from, double most,
            AtVertex atVertex = AtVertex::End);

    const std::vector<Part>& parts() const { return parts_; }
    /// Whether a line leads to a point of the triangle of part k.
    /// @return it in the last argument
    bool sees(std::size_t k, const Vec3d& to, WalkEnds& way) const;
    /// The points at which the line to a point of part k crosses edges or goes around vertices, the
    /// last first.
    std::vector<Vec3d> crossings(std::size_t k, const Vec3d& to) const;
    /// Calls visit(a, b, triangle) for each straight part of that line, the last first.
    template <typename Visit>
    void forSegments(std::size_t k, const Vec3d& to, Visit& visit) const {
        Vec3d last = to;
        for (const Vec3d& crossing : crossings(k, to)) {
            visit(last, crossing, parts_[k].triangle);
            last = crossing, k = beforeOf(k);
        }
        visit(last, from_, parts_[k].triangle);
    }

    /// Whether a line as long as the fan has a direction that isIn(direction) accepts; eight are
    /// asked in each part.
    template <typename IsIn>
    bool leads(const IsIn& isIn) const;

private:
    /// A vertex that lines go around.
    struct Origin {
        Vec3d at;
        double walked;        ///< to it
        std::size_t part;     ///< in which lines come to it; kNoPart: the point itself
        std::uint32_t first;  ///< the triangle in which these start
        Vec3d out;            ///< unit direction there
    };
    /// A vertex that lines of a length come to in some part.
    struct Reached {
        double walked;
        std::uint32_t vertex;
        std::size_t part;
        std::uint32_t corner;
        bool operator>(const Reached& o) const {
            return std::tie(walked, vertex, part) > std::tie(o.walked, o.vertex, o.part);
        }
    };
    /// A triangle at a vertex, met as it is gone around from some direction.
    struct Turn {
        std::uint32_t triangle, corner;
        bool fromNext;         ///< over the edge to the next corner; else over that from the last
        double before, angle;  ///< gone so far, and of the triangle
    };

    static constexpr std::size_t kMostParts = 20000;
    /// Lines end at a further fork: where a surface is given twice, with other triangles, every
    /// edge is one.
    static constexpr int kMostForks = 3;
    static constexpr double kOn = 1e-5;  ///< voxels
    void begin(const MeshPoint& from);
    /// Whether several triangles are beyond an edge of a triangle.
    bool isFork(std::uint32_t t, std::uint32_t edge) const {
        int sheets = 0;
        mesh_.forBeyond(t, edge, [&](std::uint32_t) { ++sheets; });
        return sheets > 1;
    }
    void leave(std::size_t k);
    /// Lays the triangle beyond an edge of part k flat.
    void enter(std::size_t k, std::uint32_t edge, std::uint32_t beyond, Vec2d right, Vec2d left);
    double walkedTo(const Part& part) const { return origins_[part.origin].walked; }
    /// Takes down that lines come to a corner of part k, if they do.
    void reach(std::size_t k, std::uint32_t corner);
    /// Whether all lines to a part are longer than others around a corner of it.
    bool isBehindOthers(const Part& part) const;
    /// Goes on around the next vertex; false: there is none.
    bool goAround();
    /// The triangles around corner c of a triangle, over the edge to the next corner or the other
    /// one, up to a boundary or the triangle itself.
    /// @return whether it comes back to the triangle
    bool turnAround(std::uint32_t t, std::uint32_t c, bool overNext, double angle,
                    std::vector<Turn>& turns) const;
    /// Adds what lies between two angles in the triangles around a vertex.
    void addTurns(const std::vector<Turn>& turns, double from, double to);
    /// Whether a point of the plane is between the lines of a part.
    static bool isBetween(const Part& part, Vec2d at) {
        return !(cross(part.right, at) < -kOn * igeo::length(part.right) ||
                 cross(at, part.left) < -kOn * igeo::length(part.left));
    }
    /// The part that lines to a part leave, or in which they come to the vertex that they go
    /// around.
    std::size_t beforeOf(std::size_t k) const {
        return parts_[k].before != kNoPart ? parts_[k].before : origins_[parts_[k].origin].part;
    }
    /// The part in which the lines to part k start, or go around a vertex.
    std::size_t firstOf(std::size_t k) const {
        while (parts_[k].before != kNoPart) k = parts_[k].before;
        return k;
    }
    /// Whether lines to a point end there before they come into a part: at a vertex of its entry.
    static bool endsBefore(const Part& part, Vec2d at) {
        return part.before != kNoPart &&
               (igeo::length(at - part.corner[part.entry]) < kOn ||
                igeo::length(at - part.corner[(part.entry + 1) % 3]) < kOn);
    }
    /// The distance from the origin to the part of an edge between two lines.
    static double nearest(Vec2d a, Vec2d b);
    Vec2d flat(const Part& part, const Vec3d& p) const;
    Vec3d inSpace(const Part& part, Vec2d v) const;

    const Mesh& mesh_;
    const Vec3d from_;
    double most_;
    AtVertex atVertex_;
    std::vector<Part> parts_;
    std::vector<Origin> origins_;
    std::unordered_map<std::uint32_t, double> shortest_;  ///< to the vertices reached
    std::priority_queue<Reached, std::vector<Reached>, std::greater<>> reached_;
};

/// The coordinates of a point of a triangle: p = corner 0 + u (corner 1 - corner 0) + v (corner 2 -
/// corner 0). Without area, those on its longest edge.
template <typename Mesh>
std::array<double, 2> coordinatesIn(const Mesh& mesh, std::uint32_t t, const Vec3d& p) {
    constexpr double kThin = 1e-8, kFlat = 1e-20;  // the second as in TriangleCorners
    const Vec3d o = mesh.corner(t, 0), a = mesh.corner(t, 1) - o, b = mesh.corner(t, 2) - o,
                r = p - o;
    const double aa = dot(a, a), ab = dot(a, b), bb = dot(b, b), d = aa * bb - ab * ab;
    if (d > kThin * aa * bb)
        return {(dot(r, a) * bb - dot(r, b) * ab) / d, (dot(r, b) * aa - dot(r, a) * ab) / d};
    // There d is little more than rounding.
    const Vec3d area = cross(a, b), e = b - a;
    const double square = dot(area, area), ee = dot(e, e), longest = std::max({aa, bb, ee});
    if (square > kFlat * longest * longest)
        return {dot(cross(r, b), area) / square, dot(cross(a, r), area) / square};
    if (!(longest > 0)) return {0, 0};
    if (longest == aa) return {dot(r, a) / aa, 0};
    if (longest == bb) return {0, dot(r, b) / bb};
    const double v = dot(r - a, e) / ee;
    return {1 - v, v};
}

template <typename Mesh>
Vec2d MeshFan<Mesh>::flat(const Part& part, const Vec3d& p) const {
    const auto [u, v] = coordinatesIn(mesh_, part.triangle, p);
    const Vec2d o = part.corner[0], a = part.corner[1] - o, b = part.corner[2] - o;
    return o + u * a + v * b;
}

template <typename Mesh>
Vec3d MeshFan<Mesh>::inSpace(const Part& part, Vec2d v) const {
    const Vec2d a = part.corner[1] - part.corner[0], b = part.corner[2] - part.corner[0];
    const double d = cross(a, b);
    if (d == 0) return {};
    const Vec3d o = mesh_.corner(part.triangle, 0);
    return normalized(cross(v, b) / d * (mesh_.corner(part.triangle, 1) - o) +
                      cross(a, v) / d * (mesh_.corner(part.triangle, 2) - o));
}

template <typename Mesh>
MeshFan<Mesh>::MeshFan(const Mesh& mesh, const MeshPoint& from, double most, AtVertex atVertex)
    : mesh_(mesh), from_(from.at), most_(most), atVertex_(atVertex) {
    origins_.push_back({from.at, 0, kNoPart, from.triangle, {}});
    begin(from);
    std::size_t k = 0;
    do {
        for (; k < parts_.size() && parts_.size() < kMostParts; ++k) leave(k);
    } while (parts_.size() < kMostParts && goAround());
}

template <typename Mesh>
void MeshFan<Mesh>::begin(const MeshPoint& from) {
    // On an edge or a vertex lines start in all triangles around.
    const std::vector<std::uint32_t> around = trianglesAt(mesh_, from);
    for (const std::uint32_t t : around) {
        const Vec3d x = normalized(mesh_.corner(t, 1) - mesh_.corner(t, 0)),
                    y = cross(mesh_.normal(t), x);
        if (y == Vec3d{}) continue;
        std::array<Vec2d, 3> corner;
        for (std::uint32_t k = 0; k < 3; ++k) {
            const Vec3d r = mesh_.corner(t, k) - from.at;
            corner[k] = {dot(r, x), dot(r, y)};
        }
        parts_.push_back({t, corner, {}, {}, kNoPart, 3, false, 0});
        for (std::uint32_t k = 0; k < 3; ++k) reach(parts_.size() - 1, k);
    }
}

template <typename Mesh>
void MeshFan<Mesh>::reach(std::size_t k, std::uint32_t corner) {
    if (atVertex_ == AtVertex::End) return;
    const Part& part = parts_[k];
    const Vec2d at = part.corner[corner];
    const double walked = walkedTo(part) + igeo::length(at);
    if (walked > most_ || (part.isSector() && !isBetween(part, at))) return;
    const std::uint32_t vertex = mesh_[part.triangle][corner];
    const auto [known, isNew] = shortest_.try_emplace(vertex, walked);
    if (!isNew && !(walked < known->second)) return;
    known->second = walked;
    reached_.push({walked, vertex, k, corner});
}

template <typename Mesh>
bool MeshFan<Mesh>::isBehindOthers(const Part& part) const {
    // Xin and Wang, Improving Chen and Han's algorithm on the discrete geodesic problem, 2009.
    const double walked = walkedTo(part) - kOn;
    const double right = walked + igeo::length(part.right), left = walked + igeo::length(part.left);
    Vec2d a = part.corner[part.entry], b = part.corner[(part.entry + 1) % 3];
    std::uint32_t atA = mesh_[part.triangle][part.entry],
                  atB = mesh_[part.triangle][(part.entry + 1) % 3];
    if (cross(a, b) < 0) std::swap(a, b), std::swap(atA, atB);
    auto isShorter = [&](std::uint32_t vertex, Vec2d at, Vec2d end, double walkedThere) {
        const auto known = shortest_.find(vertex);
        return known != shortest_.end() && known->second + igeo::length(at - end) < walkedThere;
    };
    return isShorter(atA, a, part.left, left) || isShorter(atB, b, part.right, right) ||
           isShorter(mesh_[part.triangle][(part.entry + 2) % 3], part.corner[(part.entry + 2) % 3],
                     part.right, right);
}

template <typename Mesh>
bool MeshFan<Mesh>::goAround() {
    constexpr double kTurn = 2 * std::numbers::pi, kRounding = 1e-6;
    if (reached_.empty()) return false;
    const Reached next = reached_.top();
    reached_.pop();
    const Part from = parts_[next.part];
    const Vec2d at = from.corner[next.corner];
    if (next.walked > shortest_[next.vertex] || !(igeo::length(at) > kOn)) return true;
    auto angleTo = [&](std::uint32_t corner) {
        const Vec2d e = from.corner[corner % 3] - at;
        return std::abs(std::atan2(cross(e, at), -dot(e, at)));
    };
    const double toNext = angleTo(next.corner + 1), toLast = angleTo(next.corner + 2);
    std::vector<Turn> one, other;
    const bool closed = turnAround(from.triangle, next.corner, true, toNext, one);
    double end = kInfinity;
    if (closed) {
        end = (one.empty() ? toNext : one.back().before + one.back().angle) + toLast - kTurn / 2;
        if (end < kTurn / 2 + kRounding) return true;
    } else {
        turnAround(from.triangle, next.corner, false, toLast, other);
    }
    const std::size_t first = parts_[firstOf(next.part)].triangle;
    Origin origin{
        mesh_.corner(from.triangle, next.corner), next.walked, next.part, std::uint32_t(first), {}};
    if (from.origin > 0)
        origin.first = origins_[from.origin].first, origin.out = origins_[from.origin].out;
    else
        origin.out = inSpace(parts_[firstOf(next.part)], 1 / igeo::length(at) * at);
    origins_.push_back(origin);
    addTurns(one, kTurn / 2, end);
    addTurns(other, kTurn / 2, end);
    return true;
}

template <typename Mesh>
bool MeshFan<Mesh>::turnAround(std::uint32_t t, std::uint32_t c, bool overNext, double angle,
                               std::vector<Turn>& turns) const {
    const std::uint32_t start = t, vertex = mesh_[t][c];
    while (true) {
        const std::uint32_t edge = overNext ? c : (c + 2) % 3;
        std::optional<std::uint32_t> beyond;
        std::size_t count = 0;
        mesh_.forBeyond(t, edge, [&](std::uint32_t u) { beyond = u, ++count; });
        if (count != 1) return false;
        const std::uint32_t entry = edgeShared(mesh_[*beyond], mesh_[t], edge);
        if (entry == 3) return false;
        if (*beyond == start) return true;
        t = *beyond;
        c = mesh_[t][entry] == vertex ? entry : (entry + 1) % 3;
        const Vec3d p = mesh_.corner(t, c);
        const bool fromNext = c == entry;
        const double here = angleBetween(mesh_.corner(t, c + 1) - p, mesh_.corner(t, c + 2) - p);
        turns.push_back({t, c, fromNext, angle, here});
        angle += here;
        overNext = !fromNext;
    }
}

template <typename Mesh>
void MeshFan<Mesh>::addTurns(const std::vector<Turn>& turns, double from, double to) {
    for (const Turn& turn : turns) {
        const double low = std::max(from - turn.before, 0.0),
                     high = std::min(to - turn.before, turn.angle);
        if (!(low < high)) continue;
        const std::uint32_t c = turn.corner;
        const Vec3d p = mesh_.corner(turn.triangle, c);
        auto inDirection = [](double angle, double far) {
            return Vec2d{far * std::cos(angle), far * std::sin(angle)};
        };
        Part part{turn.triangle,
                  {},
                  inDirection(turn.fromNext ? low : turn.angle - high, 1),
                  inDirection(turn.fromNext ? high : turn.angle - low, 1),
                  kNoPart,
                  3,
                  false,
                  std::uint32_t(origins_.size() - 1),
                  parts_[origins_.back().part].forks};
        part.corner[(c + 1) % 3] =
            inDirection(0, igeo::length(mesh_.corner(turn.triangle, c + 1) - p));
        part.corner[(c + 2) % 3] =
            inDirection(turn.angle, igeo::length(mesh_.corner(turn.triangle, c + 2) - p));
        parts_.push_back(part);
        reach(parts_.size() - 1, (c + 1) % 3);
        reach(parts_.size() - 1, (c + 2) % 3);
    }
}

template <typename Mesh>
double MeshFan<Mesh>::nearest(Vec2d a, Vec2d b) {
    const Vec2d e = b - a;
    const double l2 = dot(e, e), s = l2 > 0 ? std::clamp(-dot(a, e) / l2, 0.0, 1.0) : 0;
    return igeo::length(a + s * e);
}

template <typename Mesh>
void MeshFan<Mesh>::leave(std::size_t k) {
    const Part part = parts_[k];
    for (std::uint32_t edge = 0; edge < 3; ++edge) {
        if (edge == part.entry) continue;
        Vec2d right = part.corner[edge], left = part.corner[(edge + 1) % 3];
        if (part.mirrored) std::swap(right, left);
        // Edges are seen counter-clockwise; one through the origin is not seen.
        if (!(cross(right, left) > kOn * igeo::length(left - right))) continue;
        if (part.isSector()) {
            const Vec2d a = right, e = left - right;
            auto cut = [&](Vec2d line) {
                const double d = cross(line, e);
                return d != 0 ? std::clamp(-cross(line, a) / d, 0.0, 1.0) : 0.0;
            };
            if (cross(part.left, right) >= 0 || cross(part.right, left) <= 0) continue;
            if (cross(part.right, right) < 0) right = a + cut(part.right) * e;
            if (cross(left, part.left) < 0) left = a + cut(part.left) * e;
        }
        if (walkedTo(part) + nearest(right, left) > most_) continue;
        if (part.forks == kMostForks && isFork(part.triangle, edge)) continue;
        const std::size_t first = parts_.size();
        int sheets = 0;
        mesh_.forBeyond(part.triangle, edge, [&](std::uint32_t u) {
            ++sheets;
            enter(k, edge, u, right, left);
        });
        for (std::size_t n = first; sheets > 1 && n < parts_.size(); ++n) ++parts_[n].forks;
    }
}

template <typename Mesh>
void MeshFan<Mesh>::enter(std::size_t k, std::uint32_t edge, std::uint32_t beyond, Vec2d right,
                          Vec2d left) {
    const Part from = parts_[k];
    const std::uint32_t entry = edgeShared(mesh_[beyond], mesh_[from.triangle], edge);
    if (entry == 3) return;  // a seam
    const bool alike = mesh_[beyond][entry] == mesh_[from.triangle][(edge + 1) % 3];
    Part part{beyond, {}, right, left, k, entry, from.mirrored != !alike, from.origin, from.forks};
    const Vec2d fa = from.corner[edge], fb = from.corner[(edge + 1) % 3], e = fb - fa;
    const double width = igeo::length(e);
    if (!(width > 0)) return;
    const Vec3d pa = mesh_.corner(from.triangle, edge),
                pe = mesh_.corner(from.triangle, edge + 1) - pa,
                apex = mesh_.corner(beyond, entry + 2) - pa;
    const double along = dot(apex, pe) / dot(pe, pe),
                 off = igeo::length(cross(pe, apex)) / igeo::length(pe);
    // Away from the triangle that is left: to the right of the edge of one laid counter-clockwise.
    const double side = from.mirrored ? 1 : -1;
    part.corner[entry] = alike ? fb : fa;
    part.corner[(entry + 1) % 3] = alike ? fa : fb;
    part.corner[(entry + 2) % 3] = {fa.x + along * e.x - side * off / width * e.y,
                                    fa.y + along * e.y + side * off / width * e.x};
    if (part.origin > 0 && isBehindOthers(part)) return;
    parts_.push_back(part);
    reach(parts_.size() - 1, (entry + 2) % 3);
}

template <typename Mesh>
bool MeshFan<Mesh>::sees(std::size_t k, const Vec3d& to, WalkEnds& way) const {
    const Part& part = parts_[k];
    const Vec2d at = flat(part, to);
    const double far = igeo::length(at);
    if (walkedTo(part) + far > most_ || endsBefore(part, at)) return false;
    if (part.isSector() && !isBetween(part, at)) return false;
    const Origin& origin = origins_[part.origin];
    const std::size_t first = firstOf(k);
    way = {};
    way.length = origin.walked + far;
    way.straight = part.origin == 0;
    way.first = way.straight ? parts_[first].triangle : origin.first, way.last = part.triangle;
    way.mirrored = part.mirrored;
    way.out = origin.out;
    if (far > 0) {
        if (way.straight) way.out = inSpace(parts_[first], 1 / far * at);
        way.in = inSpace(part, 1 / far * at);
    }
    return true;
}

template <typename Mesh>
template <typename IsIn>
bool MeshFan<Mesh>::leads(const IsIn& isIn) const {
    constexpr int kLines = 8;
    /// How far a line in a direction stays in what is known of it.
    auto leaves = [&](const Part& part, Vec2d v) {
        double far = 0;
        for (std::uint32_t edge = 0; edge < 3; ++edge) {
            if (edge == part.entry) continue;
            const Vec2d a = part.corner[edge], e = part.corner[(edge + 1) % 3] - a;
            const double d = cross(v, e), s = d != 0 ? -cross(v, a) / d : -1;
            const Vec2d at = a + s * e;
            if (s >= 0 && s <= 1 && dot(at, v) > 0) far = std::max(far, igeo::length(at));
        }
        return far;
    };
    auto unit = [](Vec2d v) { return 1 / igeo::length(v) * v; };
    for (std::size_t k = 0; k < parts_.size(); ++k) {
        const Part& part = parts_[k];
        const std::size_t first = firstOf(k);
        for (int line = 0; line < kLines; ++line) {
            const double t = (line + 0.5) / kLines, angle = 2 * std::numbers::pi * t;
            const Vec2d v = first == k ? Vec2d{std::cos(angle), std::sin(angle)}
                                       : t * unit(part.left) - (t - 1) * unit(part.right);
            if (leaves(part, v) >= most_ && isIn(inSpace(parts_[first], v))) return true;
        }
    }
    return false;
}

template <typename Mesh>
std::vector<Vec3d> MeshFan<Mesh>::crossings(std::size_t k, const Vec3d& to) const {
    Vec2d at = flat(parts_[k], to);
    std::vector<Vec3d> points;
    while (true) {
        const Part& part = parts_[k];
        const std::size_t before = beforeOf(k);
        if (before == kNoPart) return points;
        if (part.before == kNoPart) {
            points.push_back(origins_[part.origin].at);
            at = flat(parts_[before], points.back());
        } else {
            const Vec2d a = part.corner[part.entry], e = part.corner[(part.entry + 1) % 3] - a;
            const double d = cross(at, e), s = d != 0 ? std::clamp(-cross(at, a) / d, 0.0, 1.0) : 0;
            const Vec3d p = mesh_.corner(part.triangle, part.entry);
            points.push_back(p + s * (mesh_.corner(part.triangle, part.entry + 1) - p));
        }
        k = before;
    }
}

}  // namespace igeo
