#include <igeo/band/detail/mesh_fan.h>
#include <igeo/band/surface_triangles.h>
#include <igeo/io/triangle_mesh.h>
#include <support/catch.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace igeo {
namespace {

/// Three faces of a cube around its corner at the origin, of two triangles each.
SurfaceTriangles cubeCorner() {
    TriangleMesh mesh;
    mesh.points = {{0, 0, 0}, {9, 0, 0}, {9, 9, 0}, {0, 9, 0}, {9, 0, 9}, {0, 0, 9}, {0, 9, 9}};
    mesh.triangles = {{0, 3, 2}, {0, 2, 1}, {0, 1, 4}, {0, 4, 5}, {0, 5, 6}, {0, 6, 3}};
    return SurfaceTriangles(mesh.points, mesh.triangles, meshTopology(mesh).neighbor);
}

/// A floor of three quadrants around the origin; the fourth is free, or a block is on it, of
/// which two walls are there: five right angles around the origin.
SurfaceTriangles floorAround(bool block) {
    TriangleMesh mesh;
    mesh.points = {{0, 0, 0},  {0, 9, 0}, {-9, 9, 0}, {-9, 0, 0}, {-9, -9, 0}, {0, -9, 0},
                   {9, -9, 0}, {9, 0, 0}, {9, 0, 9},  {0, 0, 9},  {0, 9, 9}};
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {0, 4, 5}, {0, 5, 6}, {0, 6, 7}};
    if (block)
        mesh.triangles.insert(mesh.triangles.end(), {{0, 7, 8}, {0, 8, 9}, {0, 9, 10}, {0, 10, 1}});
    return SurfaceTriangles(mesh.points, mesh.triangles, meshTopology(mesh).neighbor);
}

/// The lines of a fan to a point.
std::vector<WalkEnds> linesTo(const SurfaceTriangles& triangles,
                              const MeshFan<SurfaceTriangles>& fan, const Vec3d& to) {
    const std::vector<std::uint32_t> on =
        trianglesAt(triangles, {triangles.nearest(to).triangle, to});
    std::vector<WalkEnds> lines;
    for (std::size_t k = 0; k < fan.parts().size(); ++k) {
        WalkEnds line;
        if (std::find(on.begin(), on.end(), fan.parts()[k].triangle) != on.end() &&
            fan.sees(k, to, line))
            lines.push_back(line);
    }
    return lines;
}
/// The shortest of them.
WalkEnds shortest(const std::vector<WalkEnds>& lines) {
    REQUIRE(!lines.empty());
    return *std::min_element(lines.begin(), lines.end(), [](const WalkEnds& a, const WalkEnds& b) {
        return a.length < b.length;
    });
}

TEST_CASE("MeshFan: lines over triangles without area are as long as the edge that these lie in") {
    // Below a line of four points one triangle, above it three, and between them two without area.
    constexpr int kTurns = 100;
    double least = kInfinity, most = 0;
    for (int n = 0; n < kTurns; ++n) {
        TriangleMesh mesh;
        const double a = 0.37 * n, b = 0.61 * n;
        for (const Vec2d& p :
             {Vec2d{0, 0}, {3, 0}, {7, 0}, {9, 0}, {9, -9}, {0, -9}, {0, 9}, {9, 9}}) {
            const double x = std::cos(a) * p.x - std::sin(a) * p.y,
                         y = std::sin(a) * p.x + std::cos(a) * p.y;
            mesh.points.push_back({x, std::cos(b) * y, std::sin(b) * y});
        }
        mesh.triangles = {{0, 5, 4}, {0, 4, 3}, {0, 3, 2}, {0, 2, 1},
                          {0, 1, 6}, {1, 2, 6}, {2, 7, 6}, {2, 3, 7}};
        const SurfaceTriangles triangles(mesh.points, mesh.triangles, meshTopology(mesh).neighbor);
        for (std::uint32_t from = 0; from < 4; ++from) {
            const Vec3d p = mesh.points[from];
            const MeshFan<SurfaceTriangles> fan(triangles, {triangles.nearest(p).triangle, p}, 12);
            for (std::uint32_t to = 0; to < 4; ++to)
                for (const WalkEnds& line : linesTo(triangles, fan, mesh.points[to])) {
                    const double off = line.length - length(mesh.points[to] - p);
                    least = std::min(least, off), most = std::max(most, off);
                }
        }
    }
    CHECK(least > -1e-9);  // before, -9
    CHECK(most < 1e-9);    // before, 9
}

TEST_CASE("MeshFan: lines end at a vertex, in the triangle from which they come") {
    const SurfaceTriangles triangles = cubeCorner();
    const Vec3d from{3, 1, 0};
    const auto at = triangles.nearest(from);
    const MeshFan<SurfaceTriangles> fan(triangles, {at.triangle, at.point}, 12);
    const std::vector<WalkEnds> lines = linesTo(triangles, fan, {0, 0, 0});
    REQUIRE(lines.size() == 1);
    CHECK(lines[0].length == Approx(length(from)));
    CHECK(length(lines[0].in - normalized(-1.0 * from)) < 1e-12);
    CHECK(triangles.normal(lines[0].last).z == -1);
}

TEST_CASE("MeshFan: points behind the edges of a cube are seen over both planes laid flat") {
    const SurfaceTriangles triangles = cubeCorner();
    const Vec3d from{3, 1, 0};
    const auto at = triangles.nearest(from);
    const MeshFan<SurfaceTriangles> fan(triangles, {at.triangle, at.point}, 12);
    for (const Vec3d& to : {Vec3d{4, 0, 2}, {1, 0, 3}, {7, 0, 0.5}}) {
        const std::vector<WalkEnds> lines = linesTo(triangles, fan, to);
        REQUIRE(!lines.empty());
        double least = kInfinity;
        for (const WalkEnds& line : lines) least = std::min(least, line.length);
        CHECK(least == Approx(std::hypot(to.x - from.x, to.z + from.y)));
    }
}

TEST_CASE("MeshFan: on a floor given twice, with other triangles, lines end after some edges") {
    // Each edge between two squares has three triangles beyond it.
    constexpr std::uint32_t kSquares = 16;
    TriangleMesh mesh;
    for (std::uint32_t i = 0; i <= kSquares; ++i)
        for (std::uint32_t j = 0; j <= kSquares; ++j) mesh.points.push_back({1.0 * i, 1.0 * j, 0});
    for (std::uint32_t i = 0; i < kSquares; ++i)
        for (std::uint32_t j = 0; j < kSquares; ++j) {
            const std::uint32_t a = i * (kSquares + 1) + j, b = a + kSquares + 1;
            mesh.triangles.insert(
                mesh.triangles.end(),
                {{a, b, b + 1}, {a, b + 1, a + 1}, {a, b, a + 1}, {b, b + 1, a + 1}});
        }
    const SurfaceTriangles triangles(mesh.points, mesh.triangles, meshTopology(mesh).neighbor);
    const Vec3d from{8.3, 8.6, 0};
    const auto at = triangles.nearest(from);
    const MeshFan<SurfaceTriangles> fan(triangles, {at.triangle, at.point}, 6);
    CHECK(fan.parts().size() > 100);
    CHECK(fan.parts().size() < 2040);  // measured 1358; 20,000, where fans end, without that
    CHECK(shortest(linesTo(triangles, fan, {9.5, 9.7, 0})).length == Approx(std::hypot(1.2, 1.1)));
}

TEST_CASE("MeshFan: behind a vertex with more than a full turn of faces lines go around it") {
    const SurfaceTriangles triangles = floorAround(true);
    const Vec3d from{0, 1, 1};  // 45 degrees above the floor: the shadow is 135 to 225 around
    const auto at = triangles.nearest(from);
    const MeshFan fan(triangles, MeshPoint{at.triangle, at.point}, 12, AtVertex::GoAround);
    for (const Vec3d& to : {Vec3d{0, -2, 0}, {-1, -2, 0}, {1, -3, 0}}) {
        const WalkEnds line = shortest(linesTo(triangles, fan, to));
        CHECK(line.length == Approx(length(from) + length(to)));
        CHECK(!line.straight);
        CHECK(length(line.out - normalized(-1.0 * from)) < 1e-12);
        CHECK(length(line.in - normalized(to)) < 1e-12);
    }
    const WalkEnds beside = shortest(linesTo(triangles, fan, {-2, -1, 0}));
    CHECK(beside.straight);
    const double turn = std::numbers::pi / 4 + std::numbers::pi / 2 + std::atan2(1, 2);
    CHECK(beside.length == Approx(std::sqrt(2 + 5 - 2 * std::sqrt(10.0) * std::cos(turn))));
    const MeshFan straight(triangles, MeshPoint{at.triangle, at.point}, 12);
    CHECK(linesTo(triangles, straight, {-1, -2, 0}).empty());
}

TEST_CASE("MeshFan: lines go around a corner of a boundary, over edges before and after it") {
    const SurfaceTriangles triangles = floorAround(false);
    const Vec3d from{-0.5, 2, 0}, to{2, -0.5, 0};
    const auto at = triangles.nearest(from);
    const MeshFan fan(triangles, MeshPoint{at.triangle, at.point}, 12, AtVertex::GoAround);
    CHECK(shortest(linesTo(triangles, fan, to)).length == Approx(2 * length(from)));
    CHECK(shortest(linesTo(triangles, fan, {1, -6, 0})).length ==
          Approx(length(Vec3d{1.5, -8, 0})));
    const std::uint32_t last = triangles.nearest(to).triangle;
    for (std::size_t k = 0; k < fan.parts().size(); ++k) {
        WalkEnds line;
        if (fan.parts()[k].triangle != last || !fan.sees(k, to, line)) continue;
        Vec3d point = to;
        double walked = 0;
        bool passes = false;
        for (const Vec3d& crossing : fan.crossings(k, to)) {
            walked += length(crossing - point), point = crossing;
            passes |= length(crossing) < 1e-12;
        }
        CHECK(passes);
        CHECK(walked + length(from - point) == Approx(line.length));
    }
}

}  // namespace
}  // namespace igeo
