// Paths over the triangles of a mesh against unfolding: exact.
#include <igeo/march/jet.h>
#include <igeo/path/accuracy_estimate.h>
#include <igeo/path/straighten.h>
#include <igeo/surface/mesh_band.h>
#include <support/catch.h>
#include <support/mesh_shapes.h>

#include <numbers>

namespace igeo {
namespace {

const double kH = std::sqrt(3.0);

struct Solved {
    Band band;
    Field field;

    Solved(const TriangleMesh& mesh, double dx, const Vec3d& seed)
        : band(bandFromMesh(mesh, dx, kH)), field(marchJet(band, nullptr, {on(seed)})) {}

    SurfacePoint on(const Vec3d& p) const {
        return nearestSurfacePoint(band, band.transform.indexFromWorld(p));
    }
    /// Lengths of the traced and the straightened path, world units.
    std::array<double, 2> lengths(const Vec3d& target) const {
        Path path = tracePath(field, on(target));
        REQUIRE(path.status == PathStatus::Reached);
        requireOnMesh(path);
        const double traced = path.length * band.transform.dx;
        straighten(field, path);
        requireOnMesh(path);
        CHECK(path.vertices.front().distance == Approx(path.length));
        return {traced, path.length * band.transform.dx};
    }
    /// Every segment lies on one triangle.
    void requireOnMesh(const Path& path) const {
        for (std::size_t k = 1; k < path.vertices.size(); ++k) {
            const Vec3d a = path.vertices[k - 1].pIndex, b = path.vertices[k].pIndex;
            REQUIRE(length(b - a) < 1 + 1e-9);
            for (const double share : {0.0, 0.3, 0.5, 0.8}) {
                const Vec3d p = a + share * (b - a);
                REQUIRE(std::sqrt(band.triangles->nearest(p).squared) < 1e-6);
            }
        }
    }
};

/// The box [0, x] x [0, y] x [0, z], two triangles per face.
TriangleMesh boxMesh(const Vec3d& size) {
    TriangleMesh mesh;
    for (unsigned k = 0; k < 8; ++k)
        mesh.points.push_back({k & 4 ? size.x : 0, k & 2 ? size.y : 0, k & 1 ? size.z : 0});
    for (const auto& q : std::vector<std::array<std::uint32_t, 4>>{
             {0, 1, 3, 2}, {4, 6, 7, 5}, {0, 4, 5, 1}, {2, 3, 7, 6}, {0, 2, 6, 4}, {1, 5, 7, 3}}) {
        mesh.triangles.push_back({q[0], q[1], q[2]});
        mesh.triangles.push_back({q[0], q[2], q[3]});
    }
    return mesh;
}

TriangleMesh turned(const TriangleMesh& mesh) {
    return test::moved(mesh, [](const Vec3d& p) {
        const Vec3d q{0.8 * p.x - 0.6 * p.y, 0.6 * p.x + 0.8 * p.y, p.z};
        return Vec3d{q.x, 0.28 * q.y - 0.96 * q.z, 0.96 * q.y + 0.28 * q.z};
    });
}
Vec3d turned(const Vec3d& p) { return turned(TriangleMesh{{}, {p}, {}, 0, {}}).points[0]; }

TEST_CASE("paths over a box are those of its unfolding", "[mesh]") {
    const Vec3d size{1, 0.7, 0.5};
    const Solved s(turned(boxMesh(size)), 0.02, turned(Vec3d{0.31, 0.22, 0.5}));
    // On the top, on two sides beside it, and on a third beyond a corner of those.
    for (const auto& [target, exact] :
         std::vector<std::pair<Vec3d, double>>{{{0.83, 0.6, 0.5}, std::hypot(0.52, 0.38)},
                                               {{1, 0.41, 0.17}, std::hypot(0.69 + 0.33, 0.19)},
                                               {{0.62, 0.7, 0.28}, std::hypot(0.31, 0.48 + 0.22)},
                                               {{0.4, 0, 0.09}, std::hypot(0.09, 0.22 + 0.41)}}) {
        const auto [traced, straight] = s.lengths(turned(target));
        INFO(exact << " " << traced << " " << straight);
        CHECK(std::abs(straight - exact) < 1e-7);
        CHECK(traced - exact < 0.0015);
    }
}

TEST_CASE("paths on a plate a third of a voxel thick stay on its face", "[mesh]") {
    const double thick = 0.007;
    const Solved s(turned(boxMesh({1, 0.6, thick})), 0.02, turned(Vec3d{0.12, 0.13, thick}));
    for (const Vec3d& p :
         {Vec3d{0.9, 0.5, thick}, Vec3d{0.3, 0.55, thick}, Vec3d{0.7, 0.1, thick}}) {
        const double exact = std::hypot(p.x - 0.12, p.y - 0.13);
        const auto [traced, straight] = s.lengths(turned(p));
        INFO(exact << " " << traced << " " << straight);
        CHECK(std::abs(straight - exact) < 1e-7);
        CHECK(std::abs(traced - exact) < 0.002 * exact);
    }
}

/// From p to q in a plane, around the disc of radius r about the origin.
double aroundDisc(double r, const Vec3d& p, const Vec3d& q) {
    const double a = length(p), b = length(q), angle = std::acos(dot(p, q) / (a * b));
    const double arc = angle - std::acos(r / a) - std::acos(r / b);
    if (arc <= 0) return length(p - q);
    return std::sqrt(a * a - r * r) + r * arc + std::sqrt(b * b - r * r);
}

TEST_CASE("a path around a hole goes along its rim", "[mesh]") {
    const double hole = 0.15;
    const TriangleMesh mesh = test::sheet(1, 360, [&](double u, double v) {
        const double r = hole + u * (0.5 - hole), a = 2 * std::numbers::pi * v;
        return Vec3d{r * std::cos(a), r * std::sin(a), 0};
    });
    const Solved s(mesh, 0.02, {-0.32, 0.03, 0});
    for (const Vec3d& p : {Vec3d{0.33, 0.05, 0}, Vec3d{0.2, -0.3, 0}, Vec3d{-0.1, 0.2, 0}}) {
        // Chords of half a degree are short by 1e-5.
        CHECK(s.lengths(p)[1] == Approx(aroundDisc(hole, {-0.32, 0.03, 0}, p)).epsilon(3e-5));
    }
}

TEST_CASE("the estimate on a mesh is the error of the distance, not that of lengths", "[mesh]") {
    const Solved s(turned(boxMesh({1, 0.7, 0.5})), 0.02, turned(Vec3d{0.31, 0.22, 0.5}));
    const AccuracyEstimate e = estimateAccuracy(s.field);
    CHECK(e.samples == 8);
    CHECK(e.meanError < 0.0012);
    CHECK(e.largestError < 0.004);
}

TEST_CASE("a path ends at seeds on vertices and edges", "[mesh]") {
    const Vec3d size{1, 0.7, 0.5};
    for (const Vec3d& seed : {Vec3d{1, 0.7, 0.5}, Vec3d{0.4, 0, 0.5}, Vec3d{1, 0, 0.5}}) {
        const Solved s(boxMesh(size), 0.02, seed);
        for (const Vec3d& target :
             {Vec3d{0.31, 0.22, 0.5}, Vec3d{0.5, 0.35, 0.5}, Vec3d{0, 0, 0.5}})
            CHECK(s.lengths(target)[1] == Approx(length(target - seed)).epsilon(1e-9));
    }
}

}  // namespace
}  // namespace igeo
