// Walks over meshes against an exact walk: triangles laid flat along the line, in long double.
#include <igeo/path/curve_normals.h>
#include <igeo/path/exponential_map.h>
#include <igeo/surface/mesh_band.h>
#include <support/catch.h>
#include <support/mesh_shapes.h>

#include <cstdio>
#include <map>
#include <numbers>
#include <random>

namespace igeo {
namespace {

using Real = long double;
using V3 = Vec3<Real>;
using Random = std::mt19937;

constexpr Real kOnLine = 1e-9L, kHalfTurn = std::numbers::pi_v<Real>;

struct V2 {
    Real x, y;
};

double uniform(Random& random, double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
}
std::size_t below(Random& random, std::size_t n) {
    return std::uniform_int_distribution<std::size_t>(0, n - 1)(random);
}

/// The exact walk over a mesh of edges with at most two triangles.
class ExactWalk {
public:
    struct End {
        V3 point;
        Real length;
    };

    explicit ExactWalk(const SurfaceTriangles& mesh) : mesh_(mesh) {
        for (std::uint32_t t = 0; t < mesh.size(); ++t)
            for (unsigned k = 0; k < 3; ++k) beside_[edge(t, k)].push_back(t);
    }

    V3 corner(std::uint32_t t, unsigned k) const { return V3(mesh_.corner(t, k)); }

    /// @param direction  in the plane of the triangle, leads into it
    End end(std::uint32_t t, V3 from, const V3& direction, Real length) const {
        const V3 x = normalized(direction),
                 up = cross(corner(t, 1) - corner(t, 0), corner(t, 2) - corner(t, 0)),
                 y = normalized(cross(up, x));
        Flat flat;
        for (unsigned k = 0; k < 3; ++k) {
            const V3 r = corner(t, k) - from;
            flat[k] = {dot(r, x), dot(r, y)};
        }
        Real walked = 0;
        for (;;) {
            const Hit hit = line(t, flat, from, length - walked);
            walked += hit.way;
            if (hit.corner == 3) return {hit.point, walked};
            from = hit.point;
            if (!past(hit, t, flat)) return {from, walked};
        }
    }

private:
    /// Where a line ends: at a vertex of the last triangle, or elsewhere (corner 3).
    struct Hit {
        std::uint32_t triangle;
        unsigned corner;
        Real way;
        V3 point, before;  ///< before: another point of the line in the last triangle
    };
    using Flat = std::array<V2, 3>;
    using Edge = std::pair<std::uint32_t, std::uint32_t>;

    Edge edge(std::uint32_t t, unsigned k) const {
        return std::minmax(mesh_[t][k % 3], mesh_[t][(k + 1) % 3]);
    }
    std::optional<std::uint32_t> beyond(std::uint32_t t, unsigned k) const {
        for (const std::uint32_t u : beside_.at(edge(t, k)))
            if (u != t) return u;
        return std::nullopt;
    }
    unsigned cornerOf(std::uint32_t t, std::uint32_t vertex) const {
        unsigned k = 0;
        while (mesh_[t][k] != vertex) ++k;
        return k;
    }
    Real angleAt(std::uint32_t t, unsigned k) const {
        return angleBetween(corner(t, k + 1) - corner(t, k), corner(t, k + 2) - corner(t, k));
    }

    /// Follows the x axis of the plane.
    Hit line(std::uint32_t t, Flat flat, const V3& from, Real length) const {
        unsigned entry = 3;
        V3 last = from;
        Real at = 0;
        for (;;) {
            for (unsigned k = 0; k < 3; ++k) {
                const bool isBehind = !(flat[k].x > at) || k == entry || (k + 2) % 3 == entry;
                if (std::abs(flat[k].y) > kOnLine || (isBehind && entry < 3) ||
                    !(flat[k].x > kOnLine))
                    continue;
                if (flat[k].x > length) return stop(last, corner(t, k), at, flat[k].x, length);
                return {t, k, flat[k].x, corner(t, k), last};
            }
            unsigned exit = 3;
            Real furthest = at;
            V3 point;
            for (unsigned k = 0; k < 3; ++k) {
                const V2 a = flat[k], b = flat[(k + 1) % 3];
                if (k == entry || (a.y > 0) == (b.y > 0)) continue;
                const Real s = a.y / (a.y - b.y), way = a.x + s * (b.x - a.x);
                if (exit < 3 && way < furthest) continue;
                exit = k, furthest = way;
                point = corner(t, k) + s * (corner(t, k + 1) - corner(t, k));
            }
            REQUIRE(exit < 3);
            if (furthest > length) return stop(last, point, at, furthest, length);
            last = point, at = furthest;
            const std::optional<std::uint32_t> next = beyond(t, exit);
            if (!next) return stop(last, last, at, at, at);
            const V2 a = flat[exit], b = flat[(exit + 1) % 3];
            const std::uint32_t va = mesh_[t][exit], vb = mesh_[t][(exit + 1) % 3];
            const V3 pa = corner(t, exit), pb = corner(t, exit + 1);
            const bool leftToRight = a.y > b.y;
            t = *next;
            const unsigned ka = cornerOf(t, va), kb = cornerOf(t, vb), kc = 3 - ka - kb;
            const V3 e = normalized(pb - pa), r = corner(t, kc) - pa;
            const Real along = dot(r, e), off = length3(cross(e, r)), l = length3(pb - pa);
            const V2 u{(b.x - a.x) / l, (b.y - a.y) / l};
            // Ahead of the edge.
            const Real side = leftToRight ? 1 : -1;
            flat[ka] = a, flat[kb] = b;
            flat[kc] = {a.x + along * u.x - side * off * u.y, a.y + along * u.y + side * off * u.x};
            entry = (ka + 1) % 3 == kb ? ka : kb;
        }
    }
    static Real length3(const V3& v) { return std::sqrt(dot(v, v)); }

    static Hit stop(const V3& a, const V3& b, Real from, Real to, Real length) {
        return {0, 3, length, to > from ? a + (length - from) / (to - from) * (b - a) : a, a};
    }

    /// Goes on from a vertex: as much angle on one side as on the other, or 180 degrees.
    bool past(const Hit& hit, std::uint32_t& t, Flat& flat) const {
        const std::uint32_t first = hit.triangle, vertex = mesh_[first][hit.corner];
        const V3 o = hit.point, back = hit.before - o;
        /// Of a turn, from one corner, or from the line, to the next.
        struct Part {
            std::uint32_t triangle;
            unsigned from, to;
            Real begin, end;  ///< angles from the line
        };
        for (const unsigned start : {1u, 2u}) {
            unsigned from = (hit.corner + 3 - start) % 3, to = (hit.corner + start) % 3;
            std::uint32_t now = first;
            Real sum = angleBetween(back, corner(first, to) - o);
            const Real own = angleBetween(corner(first, from) - o, corner(first, to) - o);
            std::vector<Part> parts{{first, from, to, sum - own, sum}};
            bool closed = false;
            while (!closed) {
                const unsigned k = cornerOf(now, vertex);
                const std::uint32_t end = mesh_[now][to];
                const auto next = beyond(now, (k + 1) % 3 == to ? k : to);
                if (!next) break;
                now = *next;
                from = cornerOf(now, end), to = 3 - from - cornerOf(now, vertex);
                closed = now == first;
                const Real angle = angleBetween(corner(now, from) - o, corner(now, to) - o);
                parts.push_back({now, from, to, sum, sum + angle});
                sum += closed ? angleBetween(corner(now, from) - o, back) : angle;
            }
            if (!closed && sum < kHalfTurn - 1e-7L) continue;
            const Real wanted = closed ? sum / 2 : std::min(sum, kHalfTurn);
            std::size_t n = 0;
            while (wanted > parts[n].end && n + 1 < parts.size()) ++n;
            const Part& part = parts[n];
            t = part.triangle;
            flat[cornerOf(t, vertex)] = {0, 0};
            for (const auto& [k, angle] : {std::pair{part.from, part.begin - wanted},
                                           std::pair{part.to, part.end - wanted}}) {
                const Real l = length3(corner(t, k) - o);
                flat[k] = {l * std::cos(angle), l * std::sin(angle)};
            }
            return true;
        }
        return false;
    }

    const SurfaceTriangles& mesh_;
    std::map<Edge, std::vector<std::uint32_t>> beside_;
};

TriangleMesh atRandom(const TriangleMesh& mesh, Random& random) {
    Vec3d x, y;
    do {
        for (int a = 0; a < 3; ++a) x[a] = uniform(random, -1, 1), y[a] = uniform(random, -1, 1);
        x = normalized(x), y = tangential(y, x);
    } while (!(length(y) > 0.1));
    y = normalized(y);
    const Vec3d z = cross(x, y), o{uniform(random, -1, 1), uniform(random, -1, 1), 0.3};
    return test::moved(mesh, [&](const Vec3d& p) { return o + p.x * x + p.y * y + p.z * z; });
}

/// An outline pulled along z, with the caps cut in triangles about its first point.
TriangleMesh extruded(const std::vector<std::array<double, 2>>& outline, double height) {
    TriangleMesh mesh;
    const auto n = std::uint32_t(outline.size());
    for (const double z : {0.0, height})
        for (const auto& p : outline) mesh.points.push_back({p[0], p[1], z});
    for (std::uint32_t a = 0; a < n; ++a) {
        const std::uint32_t b = (a + 1) % n;
        mesh.triangles.push_back({a, b, n + b});
        mesh.triangles.push_back({a, n + b, n + a});
        if (a == 0 || b == 0) continue;
        mesh.triangles.push_back({0, b, a});
        mesh.triangles.push_back({n, n + a, n + b});
    }
    return mesh;
}

TriangleMesh prismOf(unsigned sides, double radius, double height) {
    std::vector<std::array<double, 2>> outline;
    for (unsigned k = 0; k < sides; ++k) {
        const double turn = 2 * std::numbers::pi * k / sides;
        outline.push_back({radius * std::cos(turn), radius * std::sin(turn)});
    }
    return extruded(outline, height);
}

TriangleMesh hull(Random& random, std::size_t n) {
    TriangleMesh mesh;
    for (std::size_t k = 0; k < n; ++k) {
        Vec3d p;
        for (int a = 0; a < 3; ++a) p[a] = uniform(random, -1, 1);
        mesh.points.push_back(0.5 / length(p) * p);
    }
    const auto& p = mesh.points;
    for (std::uint32_t a = 0; a < n; ++a)
        for (std::uint32_t b = a + 1; b < n; ++b)
            for (std::uint32_t c = b + 1; c < n; ++c) {
                const Vec3d up = cross(p[b] - p[a], p[c] - p[a]);
                std::size_t above = 0;
                for (const Vec3d& q : p) above += dot(up, q - p[a]) > 1e-12;
                if (above == 0) mesh.triangles.push_back({a, b, c});
                if (above == n - 3) mesh.triangles.push_back({a, c, b});
            }
    return mesh;
}

/// Triangles without width, or nearly so, in edges: an edge gets a third point on one side of it.
/// @param off  how far off the edge
TriangleMesh withSlivers(TriangleMesh mesh, Random& random, double off) {
    const MeshTopology topology = meshTopology(mesh);
    std::vector<bool> isUsed(mesh.triangles.size());
    for (std::uint32_t t = 0; t < isUsed.size(); ++t) {
        const std::uint32_t u = topology.neighbor[t][0];
        if (u >= MeshTopology::kMany || isUsed[t] || isUsed[u]) continue;
        isUsed[t] = isUsed[u] = true;
        const std::uint32_t a = mesh.triangles[t][0], b = mesh.triangles[t][1],
                            c = std::uint32_t(mesh.points.size());
        const auto other = mesh.triangles[u];
        unsigned k = 0;
        while (other[k] == a || other[k] == b) ++k;
        if (other[(k + 1) % 3] != b) continue;
        Vec3d at = mesh.points[a] + uniform(random, 0.2, 0.8) * (mesh.points[b] - mesh.points[a]);
        for (int i = 0; i < 3; ++i) at[i] += uniform(random, -off, off);
        mesh.points.push_back(at);
        mesh.triangles[u] = {other[k], b, c};
        mesh.triangles.push_back({other[k], c, a});
        mesh.triangles.push_back({b, a, c});
    }
    return mesh;
}

struct Tally {
    int walks = 0, off = 0;
    double worst = 0;  ///< of the length
};

/// Walks that start inside a triangle, on an edge or at a vertex, towards any point or a vertex.
/// @param alongEdges  whether walks start along edges
void walkOver(const TriangleMesh& mesh, double dx, int walks, bool alongEdges, Random& random,
              Tally& tally) {
    const Band band = bandFromMesh(mesh, dx, test::kHalfWidth);
    const SurfaceTriangles& triangles = *band.triangles;
    const ExactWalk exact(triangles);
    for (int n = 0; n < walks; ++n) {
        std::uint32_t t;
        Real width;
        do {
            t = std::uint32_t(below(random, triangles.size()));
            const V3 a = exact.corner(t, 0), b = exact.corner(t, 1), c = exact.corner(t, 2);
            const V3 up = cross(b - a, c - a);
            width = std::sqrt(dot(up, up) /
                              std::max({dot(b - a, b - a), dot(c - a, c - a), dot(c - b, c - b)}));
        } while (width < 0.1L);
        const unsigned k = unsigned(below(random, 3));
        // Shares of the corners k, k + 1 and k + 2.
        const auto pointOf = [&](double a, double b, double c) {
            return Real(1) / (a + b + c) *
                   (Real(a) * exact.corner(t, k) + Real(b) * exact.corner(t, k + 1) +
                    Real(c) * exact.corner(t, k + 2));
        };
        const auto any = [&] { return uniform(random, 0.05, 1); };
        const int kind = n % 8;
        if (!alongEdges && (kind == 5 || kind == 6)) continue;
        V3 from = pointOf(any(), any(), any()), to = pointOf(any(), any(), any());
        if (kind == 1) from = pointOf(any(), any(), 0);  // on an edge
        if (kind == 2) from = pointOf(1, 0, 0);          // at a vertex
        if (kind == 3) to = pointOf(1, 0, 0);            // to a vertex
        if (kind == 4) from = pointOf(any(), any(), 0), to = pointOf(0, 0, 1);
        if (kind == 5) from = pointOf(1, 0, 0), to = pointOf(0, 1, 0);  // along an edge
        if (kind == 6) from = pointOf(any(), any(), 0), to = pointOf(0, 1, 0);
        const V3 direction = to - from;
        const Real length = uniform(random, 0.2, 3) / dx;
        const SurfacePoint start = nearestSurfacePoint(band, Vec3d(from));
        if (igeo::length(start.pIndex - Vec3d(from)) > 1e-9) continue;
        ++tally.walks;
        const ExactWalk::End end = exact.end(t, from, direction, length);
        const Path path = shoot(band, start, Vec3d(direction), double(length));
        const double off = igeo::length(path.vertices.back().pIndex - Vec3d(end.point)),
                     early = std::abs(path.length - double(end.length)),
                     share = std::max(off, early) / double(length);
        tally.worst = std::max(tally.worst, share);
        tally.off += share > 1e-6;
    }
}

TEST_CASE("shoot: as an exact walk over the triangles laid flat", "[mesh]") {
    Random random(5);
    std::map<std::string, Tally> tallies;
    for (int pass = 0; pass < 4; ++pass) {
        const auto over = [&](const char* name, const TriangleMesh& mesh, bool alongEdges = true) {
            walkOver(atRandom(mesh, random), 1.0 / 24, 48, alongEdges, random, tallies[name]);
        };
        const Vec3d size{uniform(random, 0.5, 1), uniform(random, 0.5, 1), uniform(random, 0.3, 1)};
        over("box", test::boxMesh(size));
        over("sphere", test::sphereMesh({0, 0, 0}, 0.5, pass % 3));
        over("prism", prismOf(3 + unsigned(below(random, 6)), 0.5, uniform(random, 0.4, 1)));
        over("cylinder", prismOf(24 + unsigned(below(random, 20)), 0.4, 0.8));
        over("octahedron", [&] {
            TriangleMesh mesh;
            for (int a = 0; a < 3; ++a)
                for (const double s : {0.5, -0.5}) {
                    Vec3d p;
                    p[a] = s * uniform(random, 0.8, 1.2);
                    mesh.points.push_back(p);
                }
            for (std::uint32_t x : {0u, 1u})
                for (std::uint32_t y : {2u, 3u})
                    for (std::uint32_t z : {4u, 5u})
                        (x + y + z) % 2 ? mesh.triangles.push_back({x, z, y})
                                        : mesh.triangles.push_back({x, y, z});
            return mesh;
        }());
        const double turn = uniform(random, 5, 25) * std::numbers::pi / 180;
        over("wedge", extruded({{0, 0}, {1, 0}, {std::cos(turn), std::sin(turn)}}, 0.6));
        over("part", extruded({{0, 0}, {1, 0}, {1, 0.3}, {0.4, 0.2}, {0.3, 0.9}, {0, 0.7}}, 0.5));
        over("hull", hull(random, 8 + below(random, 12)));
        over("sheet", test::sheet(5, 4, [](double u, double v) {
                 return Vec3d{u, v, 0.15 * std::sin(5 * u) * std::sin(4 * v)};
             }));
        over("moebius", test::moebius(0.4, 0.3, 9 + below(random, 20)));
        for (const double off : {0.0, 1e-12, 1e-7}) {
            // A direction along an edge may lie in a sliver folded over it as well.
            const auto overSlivers = [&](const char* name, const TriangleMesh& mesh) {
                over(name, withSlivers(mesh, random, off), off == 0);
            };
            overSlivers("box with slivers", test::boxMesh(size));
            overSlivers("hull with slivers", hull(random, 12));
            overSlivers("cylinder with slivers", prismOf(20, 0.4, 0.8));
        }
    }
    Tally all;
    for (const auto& [name, t] : tallies) {
        INFO("over a " << name << ": " << t.off << " of " << t.walks << " off");
        CHECK(t.off == 0);  // before, 729 of the 1440 over slivers
        all.walks += t.walks, all.worst = std::max(all.worst, t.worst);
    }
    std::printf("%d walks over meshes: ends off by up to %.2g of the length\n", all.walks,
                all.worst);
    CHECK(all.walks > 3300);
    CHECK(all.worst < 6.9e-14);  // measured 4.6e-14
}

TEST_CASE("shoot: from edges and vertices as if it came to them over the plane of the direction",
          "[mesh]") {
    const Vec3d size{1, 0.7, 0.5};
    for (const double off : {0.0, 1e-12}) {
        Random random(3);
        const TriangleMesh box =
            off > 0 ? withSlivers(test::boxMesh(size), random, off) : test::boxMesh(size);
        const Band band = bandFromMesh(box, 1.0 / 24, test::kHalfWidth);
        for (const Vec3d& from :
             {Vec3d{1, 0.3, 0.5}, Vec3d{0, 0.3, 0.5}, Vec3d{0.4, 0.7, 0.5}, size, Vec3d{0, 0, 0.5}})
            for (const Vec3d& direction :
                 {Vec3d{1, 0.3, 0}, Vec3d{1, -0.2, 0}, Vec3d{0.1, 1, 0}, Vec3d{-1, -0.4, 0}}) {
                const Vec3d d = normalized(direction), before = from - 0.05 * d;
                // Inside of the top, and before no other edge.
                if (std::min({before.x, before.y, size.x - before.x, size.y - before.y}) <= 0)
                    continue;
                const auto end = [&](const Vec3d& p, double way) {
                    const SurfacePoint at =
                        nearestSurfacePoint(band, band.transform.indexFromWorld(p));
                    return shoot(band, at, d, way * 24).vertices.back().pIndex;
                };
                CAPTURE(off, from.x, from.y, d.x, d.y);
                CHECK(length(end(from, 0.7) - end(before, 0.75)) < 1e-9);
            }
    }
}

TEST_CASE("normalAt: on triangles without area that of the faces beside them", "[mesh]") {
    const TriangleMesh box = test::boxMesh({1, 0.7, 0.5});
    const Band plain = bandFromMesh(box, 1.0 / 24, test::kHalfWidth);
    double worst = 0;
    for (const double off : {0.0, 1e-12, 1e-8}) {
        Random random(7);
        const Band band = bandFromMesh(withSlivers(box, random, off), 1.0 / 24, test::kHalfWidth);
        for (int n = 0; n < 40; ++n) {
            const Vec3d from{uniform(random, 0.1, 0.9), uniform(random, 0.1, 0.6), 0.5},
                along{uniform(random, -1, 1), uniform(random, -1, 1), 0};
            const SurfacePoint start =
                nearestSurfacePoint(band, band.transform.indexFromWorld(from));
            for (const PathVertex& v : shoot(band, start, along, 50).vertices)
                worst = std::max(worst,
                                 angleBetween(normalAt(band, v.pIndex), normalAt(plain, v.pIndex)));
        }
    }
    std::printf("normals on triangles without area: off by %.2g\n", worst);
    CHECK(worst < 1e-7);  // measured 6.4e-8; before, 180 degrees
}

}  // namespace
}  // namespace igeo
