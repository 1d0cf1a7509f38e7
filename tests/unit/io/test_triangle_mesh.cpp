#include <igeo/io/triangle_mesh.h>
#include <support/catch.h>
#include <support/expect_error.h>
#include <support/mesh_shapes.h>

namespace igeo {
namespace {

const auto square = [](double u, double v) { return Vec3d{u, v, 0}; };

TEST_CASE("edges are counted by their triangles", "[mesh]") {
    const MeshTopology sphere = meshTopology(test::sphereMesh({}, 1, 2));
    CHECK(sphere.closed());
    CHECK(sphere.components == 1);
    CHECK(test::turnedEdges(test::sphereMesh({}, 1, 2)) == 0);

    const TriangleMesh patch = test::sheet(5, 4, square);
    const MeshTopology open = meshTopology(patch);
    CHECK_FALSE(open.closed());
    CHECK(open.boundaryEdges == 18);
    CHECK(open.nonManifoldEdges == 0);
    CHECK(open.nonOrientable == 0);

    // A page set on the square's edge x = 1, which 4 of its edges then share with a third triangle
    // only where the square goes on: here at its boundary, so all stay manifold; and in the middle.
    const auto page = [](double at) {
        return test::sheet(5, 4, [at](double u, double v) { return Vec3d{at, v, u}; });
    };
    TriangleMesh corner = test::together(patch, page(1)), tee = test::together(patch, page(0.4));
    weld(corner), weld(tee);
    CHECK(corner.points.size() == 2 * patch.points.size() - 5);
    CHECK(meshTopology(corner).boundaryEdges == 18 + 18 - 8);
    CHECK(meshTopology(corner).components == 1);
    CHECK(meshTopology(tee).nonManifoldEdges == 4);
    CHECK(meshTopology(tee).components == 1);

    const MeshTopology two =
        meshTopology(test::together(test::sphereMesh({}, 1, 1), test::sphereMesh({5, 0, 0}, 1, 1)));
    CHECK(two.components == 2);
    CHECK(two.component.front() == 0);
    CHECK(two.component.back() == 1);
}

TEST_CASE("triangles are turned to agree", "[mesh]") {
    const TriangleMesh sphere = test::sphereMesh({}, 1, 2);
    TriangleMesh mixed = sphere;
    for (std::size_t t = 0; t < mixed.triangles.size(); t += 3)
        std::swap(mixed.triangles[t][0], mixed.triangles[t][1]);
    CHECK(test::turnedEdges(mixed) > 0);
    MeshTopology topology = meshTopology(mixed);
    CHECK(orientConsistently(mixed, topology) == (mixed.triangles.size() + 2) / 3);
    CHECK(topology.neighbor == meshTopology(mixed).neighbor);
    CHECK(test::turnedEdges(mixed) == 0);
    // As most were: outward.
    for (const auto& [a, b, c] : mixed.triangles)
        CHECK(dot(mixed.points[a], cross(mixed.points[b], mixed.points[c])) > 0);

    // Turned inside out, with a cavity: outward on the outside.
    TriangleMesh inner = test::sphereMesh({}, 0.5, 2), outer = sphere;
    for (auto& t : outer.triangles) std::swap(t[1], t[2]);
    TriangleMesh hollow = test::together(outer, inner);
    CHECK(orientConsistently(hollow) == hollow.triangles.size());
    for (const auto& [a, b, c] : hollow.triangles) {
        const Vec3d n =
            cross(hollow.points[b] - hollow.points[a], hollow.points[c] - hollow.points[a]);
        CHECK((dot(n, hollow.points[a]) > 0) == (length(hollow.points[a]) > 0.7));
    }
    // An open one has no outside.
    outer.triangles.pop_back();
    CHECK(orientConsistently(outer) == 0);

    TriangleMesh strip = test::moebius(1, 0.5, 40);
    CHECK(meshTopology(strip).nonOrientable == 1);
    orientConsistently(strip);
    CHECK(test::turnedEdges(strip) > 0);
}

TEST_CASE("points are welded within a millionth of the diagonal", "[mesh]") {
    TriangleMesh mesh = test::sheet(1, 1, square);
    const double diagonal = std::sqrt(2.0);
    auto besides = [&](double gap) {
        TriangleMesh two = test::together(mesh, test::moved(mesh, [&](const Vec3d& p) {
                                              return p + Vec3d{1 + gap, 0, 0};
                                          }));
        weld(two);
        return two.points.size();
    };
    // The two together are sqrt(5) across.
    CHECK(besides(0.9e-6 * diagonal) == 6);
    CHECK(besides(3e-6 * diagonal) == 8);
    // A point of no triangle does not count, wherever it is.
    for (const double far : {1e4, 1e9}) {
        TriangleMesh two = test::together(mesh, test::moved(mesh, [&](const Vec3d& p) {
                                              return p + Vec3d{1 + 3e-6 * diagonal, 0, 0};
                                          }));
        two.points.push_back({far, 0, 0});
        weld(two);
        CHECK(two.points.size() == 8);
    }
}

TEST_CASE("absurd sizes are refused before anything is allocated", "[mesh]") {
    const TriangleMesh mesh = test::sheet(2, 2, square);
    CHECK(estimatedVoxels(mesh, 0.01) == Approx(60000));
    CHECK_NOTHROW(requireReasonable(mesh, 0.001));
    test::expectError(Error::Kind::InvalidArgument, {"6e+10", "1e+09", "7.746e-05"},
                      [&] { requireReasonable(mesh, 1e-5); });
    for (const double dx : {0.0, -1.0, kInfinity, std::nan("")})
        test::expectError(Error::Kind::InvalidArgument, {"voxel size"},
                          [&] { requireReasonable(mesh, dx); });
    const TriangleMesh far = test::moved(mesh, [](const Vec3d& p) { return p + Vec3d{1e9, 0, 0}; });
    test::expectError(Error::Kind::InvalidArgument, {"origin"},
                      [&] { requireReasonable(far, 0.1); });
}

}  // namespace
}  // namespace igeo
