#include <igeo/march/jet.h>
#include <igeo/results/isolines.h>
#include <igeo/results/refined_mesh.h>
#include <igeo/surface/mesh_band.h>
#include <support/catch.h>
#include <support/expect_error.h>
#include <support/mesh_shapes.h>
#include <support/meshed.h>

namespace igeo {
namespace {

TEST_CASE("an open mesh is refined without cracks and carries the distance", "[mesh]") {
    // Long thin triangles, and a hole in the middle.
    const TriangleMesh mesh = test::sheet(
        3, 9,
        [](double u, double v) {
            return Vec3d{3 * u, v, 0.1 + 0.2 * u};
        },
        [](double u, double v) { return !(u > 0.34 && u < 0.66 && v > 0.4 && v < 0.6); });
    const double dx = 0.05;
    const Band band = bandFromMesh(mesh, dx, std::sqrt(3.0));
    const SurfacePoint seed =
        nearestSurfacePoint(band, band.transform.indexFromWorld({0.2, 0.1, 0.1}));
    const Field field = marchJet(band, nullptr, {seed});
    const SurfaceMesh fine = refinedMesh(mesh, field);

    const test::Topology topology = test::topologyOf(fine);
    CHECK(topology.rimLoops == 2);
    CHECK(topology.euler == 0);
    CHECK(topology.sameWay == 0);
    CHECK(topology.edgesByTriangles.size() == 2);
    CHECK(test::meshArea(fine) * dx * dx == Approx(meshArea(mesh)));
    double longest = 0, off = 0;
    for (const auto& t : fine.triangles)
        for (std::size_t k = 0; k < 3; ++k)
            longest =
                std::max(longest, length(fine.position[t[k]] - fine.position[t[(k + 1) % 3]]));
    CHECK(longest <= 1);
    for (std::size_t i = 0; i < fine.position.size(); ++i) {
        REQUIRE(fine.distance[i] < kInfinity);
        CHECK(fine.label[i] == 0);
        // Where the hole hides nothing; the rest of the plane is straight ahead.
        const Vec3d p = band.transform.worldFromIndex(fine.position[i]);
        if (p.x < 1)
            off =
                std::max(off, std::abs(fine.distance[i] - length(fine.position[i] - seed.pIndex)));
    }
    CHECK(off < 0.00032);  // measured 0.00021
    const std::vector<Isoline> lines = isolines(field, fine, {20.0});
    CHECK_FALSE(lines.empty());
}

TEST_CASE("edges that are short enough are left alone", "[mesh]") {
    const TriangleMesh mesh = test::sphereMesh({}, 1, 3);
    const Band band = bandFromMesh(mesh, 0.3, std::sqrt(3.0));
    const Field field = marchJet(band, nullptr, {nearestSurfacePoint(band, Vec3d{0, 0, 10})});
    CHECK(refinedMesh(mesh, field).triangles == mesh.triangles);
    CHECK(test::topologyOf(refinedMesh(mesh, field, 0.4)).closed());
    for (const double longest : {0.0, -1.0, std::nan("")})
        test::expectError(Error::Kind::InvalidArgument, {"edges of at most"},
                          [&] { refinedMesh(mesh, field, longest); });
}

}  // namespace
}  // namespace igeo
