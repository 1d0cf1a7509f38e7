// Normals of surfaces that are known exactly.
#include <igeo/path/curve_normals.h>
#include <igeo/surface/mesh_band.h>
#include <support/analytic_band.h>
#include <support/catch.h>
#include <support/mesh_shapes.h>

namespace igeo::test {
namespace {

/// In world space, at a point of a mesh.
Vec3d at(const Band& band, const Vec3d& p, const Vec3d& sheet = {}) {
    return band.transform.worldFromIndexDirection(
        normalAt(band, band.transform.indexFromWorld(p), sheet));
}

void same(const Vec3d& a, const Vec3d& b) { CHECK(length(a - b) <= 1e-12); }

}  // namespace

TEST_CASE("normalAt: faces, edges and corners of a box, to rounding") {
    const Band band = bandFromMesh(boxMesh({2, 3, 1}), 0.1, std::sqrt(3.0));
    same(at(band, {1, 1, 1}), {0, 0, 1});
    same(at(band, {2, 1.5, 0.5}), {1, 0, 0});  // on the diagonal of its face
    same(at(band, {0.3, 0, 0.2}), {0, -1, 0});
    same(at(band, {2, 1, 1}), normalized(Vec3d{1, 0, 1}));
    same(at(band, {0, 3, 0.4}), normalized(Vec3d{-1, 1, 0}));
    // By angles: each face has 90 degrees, in one triangle or in two.
    for (const Vec3d& p : {Vec3d{0, 0, 0}, Vec3d{2, 3, 1}, Vec3d{2, 0, 1}, Vec3d{0, 3, 0}})
        same(at(band, p), normalized(Vec3d{p.x - 1, 2 * (p.y - 1.5) / 3, 2 * p.z - 1}));
}

TEST_CASE("normalAt: of a thin plate the sheet that is meant") {
    const Band band = bandFromMesh(boxMesh({2, 2, 0.02}), 0.05, std::sqrt(3.0));
    same(at(band, {1, 1.2, 0.02}, {0, 0, 1}), {0, 0, 1});
    same(at(band, {1, 1.2, 0}, {0, 0, -1}), {0, 0, -1});
    // A rim's path comes from above and goes on below.
    same(at(band, {2, 1.2, 0.01}, {0, 0, 1}), {1, 0, 0});
}

TEST_CASE("normalAt: on a sphere, of second order") {
    for (const double r : {10.0, 20.0}) {
        const Band band = sphereBand({0.3, 0.2, 0.1}, r, std::sqrt(3.0));
        double worst = 0;
        for (int k = 0; k < 500; ++k) {
            const Vec3d n = normalized(Vec3d{std::cos(2.4 * k), std::sin(2.4 * k), k / 250.0 - 1});
            const Vec3d p = Vec3d{0.3, 0.2, 0.1} + r * n;
            worst = std::max(worst, length(normalAt(band, p, n) - n));
        }
        INFO("radius " << r << ": " << worst);
        CHECK(worst <= 0.09 / (r * r));  // measured: 0.06 / r^2
    }
}

TEST_CASE("addNormals: every vertex has one") {
    const Band band = bandFromMesh(boxMesh({2, 3, 1}), 0.1, std::sqrt(3.0));
    Path path;
    for (const double x : {1.0, 2.0, 2.0})
        path.vertices.push_back(
            {band.transform.indexFromWorld({x, 1, path.vertices.size() < 2 ? 1 : 0.5}), 0, 0});
    addNormals(band, path);
    same(path.vertices[0].normal, {0, 0, 1});
    same(path.vertices[1].normal, normalized(Vec3d{1, 0, 1}));
    same(path.vertices[2].normal, {1, 0, 0});
}

}  // namespace igeo::test
