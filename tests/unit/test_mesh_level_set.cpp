#include <igeo/mesh_level_set.h>
#include <support/catch.h>
#include <support/expect_error.h>
#include <support/mesh_shapes.h>
#include <support/openvdb.h>

namespace igeo {
namespace {

using Kind = Error::Kind;

/// Largest difference between psi and f at active voxels, in voxels.
template <typename F>
double off(const LevelSet& s, const F& f) {
    double most = 0;
    for (auto it = s.psi->cbeginValueOn(); it; ++it) {
        const auto p = s.psi->indexToWorld(it.getCoord());
        most = std::max(most, std::abs(*it - f(Vec3d(p.x(), p.y(), p.z()))));
    }
    return most / s.transform.dx;
}

TEST_CASE("a closed mesh gives its signed distance", "[mesh]") {
    const Vec3d centre{3, -2, 5};
    TriangleMesh mesh = test::sphereMesh(centre, 1, 4);
    mesh.file = "some/ball.obj";
    // The sign does not come from the triangles.
    for (std::size_t t = 0; t < mesh.triangles.size(); t += 2)
        std::swap(mesh.triangles[t][0], mesh.triangles[t][1]);
    const LevelSet s = levelSetFromMesh(mesh, 0.05);
    CHECK(s.name == "ball");
    CHECK(s.psi->getName() == "ball");
    CHECK(s.file == "some/ball.obj");
    CHECK(s.transform.dx == 0.05);
    CHECK(s.warnings.empty());
    CHECK(s.stats.halfWidth == Approx(3).epsilon(0.01));
    // Triangles of 0.08 on a unit sphere lie up to 0.08^2 / 6 = 1e-3 inside of it: 0.02 voxels.
    CHECK(off(s, [&](const Vec3d& p) { return length(p - centre) - 1; }) < 0.025);
    // Half the estimate's voxels on either side, curved.
    CHECK(double(s.stats.activeVoxels) == Approx(estimatedVoxels(mesh, 0.05)).epsilon(0.05));
}

TEST_CASE("meshes without an inside are refused", "[mesh]") {
    const TriangleMesh patch = test::sheet(4, 4, [](double u, double v) { return Vec3d{u, v, 0}; });
    test::expectError(Kind::BadInput, {"16 edges", "sheet", "open surface"},
                      [&] { levelSetFromMesh(patch, 0.1); });
    const TriangleMesh ball = test::sphereMesh({}, 1, 2);
    test::expectError(Kind::InvalidArgument, {"voxels"}, [&] { levelSetFromMesh(ball, 1e-6); });
    test::expectError(Kind::InvalidArgument, {"half-width"},
                      [&] { levelSetFromMesh(ball, 0.1, 1); });
    // So coarse that nothing is left of it.
    test::expectError(Kind::BadInput, {"sphere"}, [&] { levelSetFromMesh(ball, 10); });
}

TEST_CASE("a shell goes around an open mesh", "[mesh]") {
    const TriangleMesh patch = test::sheet(1, 1, [](double u, double v) {
        return Vec3d{3 * u, 2 * v, 0.013};
    });
    const double dx = 0.1;
    const LevelSet s = shellOfMesh(patch, dx);
    CHECK(s.warnings.empty());
    CHECK(s.stats.halfWidth == Approx(2.87).epsilon(0.001));  // lattice planes at 3.87 voxels
    CHECK(s.stats.crossingShare > 0.2);
    const auto distance = [&](const Vec3d& p) {
        const Vec3d q{std::clamp(p.x, 0.0, 3.0), std::clamp(p.y, 0.0, 2.0), 0.013};
        return length(p - q) - dx;
    };
    CHECK(off(s, distance) < 1e-4);
    test::expectError(Kind::InvalidArgument, {"shell"}, [&] { shellOfMesh(patch, dx, 5); });
}

TEST_CASE("conversions can be interrupted", "[mesh]") {
    struct Stop : Progress {
        bool cancelled() const override { return true; }
    } stop;
    test::expectError(Kind::Cancelled, {},
                      [&] { levelSetFromMesh(test::sphereMesh({}, 1, 3), 0.02, 3, stop); });
}

}  // namespace
}  // namespace igeo
