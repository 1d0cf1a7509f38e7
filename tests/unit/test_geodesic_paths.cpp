// Paths of pairs, curves through points and their vertices, on surfaces whose geodesics are known.
#include <igeo/base/parallel.h>
#include <igeo/igeo.h>
#include <support/catch.h>
#include <support/expect_error.h>
#include <support/mesh_shapes.h>
#include <support/openvdb.h>
#include <support/shapes.h>

#include <numbers>

namespace igeo::test {
namespace {

GeodesicSolver onBox() {
    VoxelOptions voxels;
    voxels.resolution = 48;
    return GeodesicSolver{Surface(boxMesh({2, 3, 1}), voxels)};
}

/// A tube about the z axis without ends, of 64 flat faces.
TriangleMesh tube(double radius, double height) {
    return sheet(64, 16, [&](double u, double v) {
        const double a = 2 * std::numbers::pi * u;
        return Vec3d{radius * std::cos(a), radius * std::sin(a), height * (v - 0.5)};
    });
}

/// What holds for every curve.
void requireSound(const Polyline& line) {
    const std::size_t n = line.points.size();
    REQUIRE(line.status == PathStatus::Reached);
    REQUIRE((line.normals.size() == n && line.arcLength.size() == n && line.distance.size() == n));
    double at = 0;
    for (std::size_t k = 0; k < n; ++k) {
        if (k) at += length(line.points[k] - line.points[k - 1]);
        CHECK(line.arcLength[k] == Approx(at).margin(1e-9));
        CHECK(length(line.normals[k]) == Approx(1).epsilon(1e-9));
    }
    CHECK(line.length == Approx(at).epsilon(1e-9));
}

}  // namespace

TEST_CASE("pairPaths: from source to target, on a box exact") {
    const GeodesicSolver solver = onBox();
    const std::vector<Vec3d> from{{1, 1, 1}, {1, 1, 1}}, to{{2, 1.5, 0.5}, {1, 1, 0}};
    const auto pairs = solver.pairPaths(from, to, /*straighten=*/true);
    REQUIRE(pairs.size() == 2);
    for (std::size_t k = 0; k < 2; ++k) {
        const Polyline& path = pairs[k].path;
        requireSound(path);
        CHECK(length(path.points.front() - from[k]) <= 1e-9);
        CHECK(length(path.points.back() - to[k]) <= 1e-9);
        CHECK(path.distance.front() == 0);
        CHECK(path.distance.back() == Approx(path.length).epsilon(1e-12));
        CHECK(pairs[k].distance == solver.pairs(from, to)[k].distance);
    }
    // Both faces laid out flat; the target is in the middle of a face, on its diagonal.
    CHECK(pairs[0].path.length == Approx(std::hypot(1.5, 0.5)).epsilon(1e-12));
    CHECK(pairs[1].path.length == Approx(3).epsilon(1e-12));
    CHECK(solver.pairs(from, to)[0].path.points.empty());
}

TEST_CASE("pairPaths: pairs that nothing joins have no path") {
    const auto grid = makeLevelSet(twoSpheres({0, 0, 0}, 0.5, {2, 0, 0}, 0.5), 0.05, 3);
    const GeodesicSolver solver{Surface(*grid)};
    const auto pairs =
        solver.pairPaths({{0, 0, 0.5}, {0, 0, 0.5}}, {{2, 0, 0.5}, {0.5, 0, 0}}, true);
    CHECK(pairs[0].path.status == PathStatus::Unreachable);
    CHECK(pairs[0].path.points.empty());
    requireSound(pairs[1].path);
    CHECK(pairs[1].path.length ==
          Approx(0.5 * std::numbers::pi / 2).epsilon(1.5e-3));  // measured: 1e-3
    CHECK(solver.through({{0, 0, 0.5}, {2, 0, 0.5}}).status == PathStatus::Unreachable);
}

TEST_CASE("pairs: those with a point off the surface are skipped where that is asked for") {
    QueryRules rules;
    rules.skipOffSurface = true;
    const GeodesicSolver solver = onBox().with(rules);
    const Vec3d far{9, 9, 9}, a{1, 1, 1}, b{2, 1.5, 0.5}, c{1, 1, 0};
    const auto pairs = solver.pairPaths({a, a, far, b}, {b, far, a, c}),
               good = solver.pairPaths({a, b}, {b, c});
    REQUIRE(pairs.size() == 4);
    CHECK(pairs[0].distance == good[0].distance);
    CHECK(pairs[3].distance == good[1].distance);
    CHECK(pairs[0].path.points == good[0].path.points);
    CHECK(!pairs[0].isSkipped());
    CHECK((pairs[1].isSkipped() && std::isnan(pairs[1].distance)));
    CHECK(pairs[1].path.status == PathStatus::OffSurface);
    CHECK(pairs[1].reason() == "the target is off the surface");
    CHECK(pairs[2].reason() == "the source is off the surface");
    CHECK(solver.pairs({far}, {a})[0].isSkipped());
    expectError(Error::Kind::InvalidArgument, {"the target of pair 0 (9,9,9)"},
                [&] { solver.with({}).pairs({a}, {far}); });
    expectError(Error::Kind::InvalidArgument, {"point 1"}, [&] { solver.through({a, far}); });
}

TEST_CASE("through: legs are geodesics, and turn at the points only") {
    const GeodesicSolver solver = onBox();
    const std::vector<Vec3d> points{{1, 1, 1}, {2, 1.5, 0.5}, {1, 1, 0}, {0.2, 2, 0}};
    const Polyline line = solver.through(points);
    requireSound(line);
    const double leg = std::hypot(1.5, 0.5);
    CHECK(line.length == Approx(2 * leg + std::hypot(0.8, 1)).epsilon(1e-12));
    REQUIRE(line.corners.size() == 2);
    for (std::size_t k = 0; k < 2; ++k)
        CHECK(length(line.points[line.corners[k]] - points[k + 1]) <= 1e-9);
    CHECK(line.arcLength[line.corners[0]] == Approx(leg).epsilon(1e-12));
    CHECK(line.distance == line.arcLength);
    CHECK(length(line.end.position - points.back()) <= 1e-9);

    const Polyline closed = solver.through(points, /*closed=*/true);
    requireSound(closed);
    CHECK(closed.points.front() == closed.points.back());
    CHECK(closed.corners.size() == 3);
    const auto back = solver.pairPaths({points[3]}, {points[0]}, true);
    CHECK(closed.length == Approx(line.length + back[0].path.length).epsilon(1e-12));
}

TEST_CASE("through: as a whole the points in between only guide") {
    const GeodesicSolver solver = onBox();
    const Polyline line =
        solver.through({{1, 1, 1}, {2, 1.4, 0.5}, {1, 1, 0}}, /*closed=*/false, /*whole=*/true);
    requireSound(line);
    CHECK(line.corners.empty());
    CHECK(line.length == Approx(3).epsilon(1e-12));
    // The other way around: the points say which geodesic it is.
    const Polyline other =
        solver.through({{1, 1, 1}, {1, 0, 0.5}, {1, 1, 0}}, /*closed=*/false, /*whole=*/true);
    CHECK(other.length == Approx(3).epsilon(1e-12));
    CHECK(other.points[other.points.size() / 2].y == Approx(0).margin(1e-9));
}

TEST_CASE("through: closed geodesics of a box and a tube, exact") {
    const Polyline belt =
        onBox().through({{1, 0.5, 1}, {2, 0.7, 0.5}, {1, 0.5, 0}, {0, 0.3, 0.5}}, true, true);
    requireSound(belt);
    CHECK(belt.length == Approx(6).epsilon(1e-12));
    CHECK(belt.points.front() == belt.points.back());

    VoxelOptions voxels;
    voxels.size = 0.05;
    const GeodesicSolver solver{Surface(tube(1, 4), voxels)};
    const double around = 64 * 2 * std::sin(std::numbers::pi / 64);
    auto at = [](double turns, double z) {
        return Vec3d{std::cos(2 * std::numbers::pi * turns), std::sin(2 * std::numbers::pi * turns),
                     z};
    };
    std::vector<Vec3d> ring, helix;
    for (int k = 0; k < 6; ++k) ring.push_back(at(k / 6.0, k % 2 ? 0.3 : -0.2));
    const Polyline circle = solver.through(ring, true, true);
    requireSound(circle);
    CHECK(circle.length == Approx(around).epsilon(1e-9));
    // Twice around, from one height to another: laid out flat, a straight line.
    for (int k = 0; k <= 12; ++k) helix.push_back(at(k / 6.0, k == 12 ? 0.5 : k % 2 ? 0.3 : 0));
    const Polyline twice = solver.through(helix, false, true);
    requireSound(twice);
    CHECK(twice.length == Approx(std::hypot(2 * around, 0.5)).epsilon(1e-9));
    // As much of a helix even where it comes back to its own triangles.
    for (int k = 1; k <= 12; ++k) helix.push_back(at(k / 6.0, k == 12 ? 0 : 0.4));
    const Polyline four = solver.through(helix, false, true);
    requireSound(four);
    CHECK(four.length == Approx(4 * around).epsilon(1e-9));
}

TEST_CASE("through: on a turned and scaled sphere and torus, as level sets") {
    const openvdb::Vec3d middle(3, -1, 2);
    const auto transform = rotatedTransform(0.05, {1, 2, 3}, 25, {0.1, 0.2, 0.3});
    const Vec3d c{middle.x(), middle.y(), middle.z()};
    auto on = [&](double x, double y, double z) { return c + normalized(Vec3d{x, y, z}); };
    const GeodesicSolver ball{Surface(*makeLevelSet(sphere(middle, 1), *transform, 3))};
    const Polyline legs = ball.through({on(1, 0, 0), on(0, 1, 0), on(0, 0, 1)});
    requireSound(legs);
    CHECK(legs.length == Approx(std::numbers::pi).epsilon(0.00077));  // measured 0.00051
    double turned = 0;
    for (std::size_t k = 0; k < legs.points.size(); ++k)
        turned = std::max(turned, length(legs.normals[k] - normalized(legs.points[k] - c)));
    CHECK(turned <= 0.00021);  // measured 0.00014
    const Polyline whole = ball.through({on(1, 0, 0), on(0.5, 1, 0.5), on(-1, 2, 0)}, false, true);
    requireSound(whole);
    CHECK(whole.length ==
          Approx(std::acos(-1 / std::sqrt(5.0))).epsilon(0.00064));  // measured 0.00042
    const std::vector<Vec3d> cap{on(1, 0, 2), on(-1, 1, 2), on(-1, -1, 2)};
    CHECK(ball.through(cap, true).status == PathStatus::Reached);
    const Polyline none = ball.through(cap, true, true);
    CHECK(none.status == PathStatus::Stalled);
    CHECK(none.points.empty());

    // The inner equator: the shortest closed geodesic that goes around the hole.
    const GeodesicSolver ring{Surface(*makeLevelSet(torus(middle, 1, 0.4), *transform, 3))};
    std::vector<Vec3d> loop;
    for (int k = 0; k < 5; ++k) {
        const double a = 2 * std::numbers::pi * k / 5;
        loop.push_back(c + Vec3d{1.4 * std::cos(a), 1.4 * std::sin(a), 0});
    }
    const Polyline neck = ring.through(loop, true, true);
    requireSound(neck);
    CHECK(neck.length == Approx(2 * std::numbers::pi * 0.6).epsilon(0.00031));  // measured 0.0002
}

TEST_CASE("pairs and through: with a weight that the whole surface says, and around an obstacle") {
    const auto grid = makeLevelSet(sphere({0, 0, 0}, 1), 0.05, 3);
    const Surface ball(*grid);
    SolverOptions options;
    options.metric.curvature = CurvatureWeight{};
    const GeodesicSolver weighted(ball, options);
    const std::vector<Vec3d> points{{1, 0, 0}, {0, 0.8, 0.6}, {-0.6, 0.8, 0}};
    const auto pairs = weighted.pairPaths({points[0]}, {points[1]}, true);
    requireSound(pairs[0].path);
    CHECK(pairs[0].path.weightedLength ==
          Approx(pairs[0].distance).epsilon(0.00062));  // measured 0.00041
    const Polyline whole = weighted.through(points, false, true);
    requireSound(whole);
    CHECK(whole.weightedLength <= weighted.through(points).weightedLength);

    // On the great circle between the ends.
    auto rock = std::make_shared<ObstacleSet>(ball.transform());
    rock->addSphere({0, 1, 0}, 0.4);
    options.metric = {};
    options.metric.obstacles = rock;
    const Polyline around = GeodesicSolver(ball, options)
                                .through({{1, 0, 0}, {0, 0.6, 0.8}, {-0.6, 0.8, 0}}, false, true);
    requireSound(around);
    CHECK(around.length > std::acos(-0.6) + 0.01);
    for (const Vec3d& p : around.points) CHECK(length(p - Vec3d{0, 1, 0}) > 0.38);
}

TEST_CASE("through: what cannot be one is refused") {
    const GeodesicSolver solver = onBox();
    using Kind = Error::Kind;
    expectError(Kind::InvalidArgument, {"1 points", "2 or more"}, [&] {
        solver.through({{1, 1, 1}});
    });
    expectError(Kind::InvalidArgument, {"2 points", "closed", "3 or more"}, [&] {
        solver.through({{1, 1, 1}, {1, 1, 0}}, true);
    });
    expectError(Kind::InvalidArgument, {"point 1", "from the surface"}, [&] {
        solver.through({{1, 1, 1}, {9, 9, 9}, {1, 1, 0}});
    });
}

TEST_CASE("resampled: vertices at equal lengths, corners and ends kept") {
    const GeodesicSolver solver = onBox();
    const Polyline line = solver.through({{1, 1, 1}, {2, 1.5, 0.5}, {1, 1, 0}});
    const double leg = std::hypot(1.5, 0.5), step = 0.25;
    const Polyline even = solver.resampled(line, step);
    CHECK(even.length == line.length);
    REQUIRE(even.points.size() == 15);  // 6 whole steps and a rest, twice
    REQUIRE(even.corners == std::vector<std::size_t>{7});
    for (std::size_t k = 0; k < 15; ++k) {
        const double at = k < 7    ? double(k) * step
                          : k == 7 ? leg
                          : k < 14 ? leg + double(k - 7) * step
                                   : 2 * leg;
        CHECK(even.arcLength[k] == Approx(at).margin(1e-12));
        CHECK(even.distance[k] == Approx(at).margin(1e-12));
    }
    CHECK(length(even.points[7] - Vec3d{2, 1.5, 0.5}) <= 1e-9);
    // The first three are on the top, then the side: its own normals, not blends.
    for (std::size_t k = 0; k < 7; ++k) {
        const bool top = double(k) * step < leg / 1.5;
        CHECK(length(even.normals[k] - (top ? Vec3d{0, 0, 1} : Vec3d{1, 0, 0})) <= 1e-12);
        if (top)
            CHECK(length(even.points[k] - line.points[0]) == Approx(double(k) * step).margin(1e-9));
    }
    CHECK(solver.resampled(line, 100).points.size() == 3);
    CHECK(solver.resampled(solver.through({{1, 1, 1}, {1, 2, 1}}), 0.25).points.size() == 5);
    CHECK(solver.resampled(Polyline{}, 1).points.empty());
    for (const double bad : {0.0, -1.0, 1e-8, std::nan("")})
        expectError(Error::Kind::InvalidArgument, {"apart", "1e7"},
                    [&] { solver.resampled(line, bad); });
}

TEST_CASE("moveAlongNormals: above a sphere, and inside") {
    const auto grid = makeLevelSet(sphere({0, 0, 0}, 1), 0.05, 3);
    const GeodesicSolver solver{Surface(*grid)};
    const Polyline walk = solver.shoot({1, 0, 0}, {0, 1, 0.3}, 3);
    for (const double by : {0.2, -0.3}) {
        Polyline moved = walk;
        moveAlongNormals(moved, by);
        for (const Vec3d& p : moved.points)
            CHECK(length(p) == Approx(1 + by).margin(1.1e-6));  // measured 7.3e-07
        CHECK(moved.arcLength == walk.arcLength);
    }
}

TEST_CASE("through and pairPaths: the same bits for any number of threads") {
    std::vector<Polyline> found;
    for (const int threads : {1, 2}) {
        const ThreadLimit limit(threads);
        const auto grid = makeLevelSet(torus({0, 0, 0}, 1, 0.4), 0.05, 3);
        const GeodesicSolver solver{Surface(*grid)};
        found.push_back(solver.through({{1.4, 0, 0}, {0, 1.4, 0}, {-1.4, 0, 0}}, false, true));
        found.push_back(solver.pairPaths({{1.4, 0, 0}}, {{0, -1, 0.4}})[0].path);
    }
    for (std::size_t k = 0; k < 2; ++k) {
        CHECK((found[k].points == found[k + 2].points));
        CHECK((found[k].normals == found[k + 2].normals));
    }
}

}  // namespace igeo::test
