#include <igeo/band/detail/mesh_fan.h>
#include <igeo/band/surface_triangles.h>
#include <igeo/io/triangle_mesh.h>
#include <support/catch.h>

namespace igeo {
namespace {

/// Three faces of a cube around its corner at the origin, of two triangles each.
SurfaceTriangles cubeCorner() {
    TriangleMesh mesh;
    mesh.points = {{0, 0, 0}, {9, 0, 0}, {9, 9, 0}, {0, 9, 0}, {9, 0, 9}, {0, 0, 9}, {0, 9, 9}};
    mesh.triangles = {{0, 3, 2}, {0, 2, 1}, {0, 1, 4}, {0, 4, 5}, {0, 5, 6}, {0, 6, 3}};
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

}  // namespace
}  // namespace igeo
