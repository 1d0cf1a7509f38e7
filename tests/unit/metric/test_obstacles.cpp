#include <igeo/base/parallel.h>
#include <igeo/march/jet.h>
#include <igeo/metric/obstacles.h>
#include <igeo/surface/mesh_band.h>
#include <support/analytic_band.h>
#include <support/catch.h>
#include <support/expect_error.h>
#include <support/mesh_shapes.h>
#include <support/openvdb.h>
#include <support/shapes.h>
#include <support/walls.h>

#include <cmath>
#include <functional>
#include <random>
#include <set>
#include <tuple>

namespace igeo::test {
TEST_CASE("obstacles: a wall of voxels parts the surface") {
    Random random(1);
    Tally whole, alongS, core;
    for (int k = 0; k < 150; ++k) {
        const Ground g = randomGround(random, k % 2);
        const Vec3d w = wallNormal(random, g);
        const Vec3d p = g.onto(g.center + g.across * w), q = g.onto(g.center - g.across * w);
        // One voxel thick: those next to each other share an edge at least.
        whole.add(g, wallOf(g, w, halfEdge(w), [](NodeIndex) { return true; }), p, q);
        // Of these the voxels that S passes; S is bent by 0.05 across a voxel.
        alongS.add(g,
                   wallOf(g, w, halfEdge(w),
                          [&](NodeIndex i) {
                              return std::abs(g.band.psi[i]) <=
                                     halfWidth(Vec3d(g.band.normal[i])) + 0.05;
                          }),
                   p, q);
        // All voxels of the core that the wall passes.
        core.add(g, wallOf(g, w, halfWidth(w), [&](NodeIndex i) { return g.band.inCore(i); }), p,
                 q);
    }
    for (const Tally& t : {whole, alongS, core}) {
        CHECK(t.walls == 150);
        CHECK(t.leaks == 0);
        // Half a wall, half the diagonal of a grown cube, and a link that is cut.
        CHECK(t.swallowed < 2);
    }
}

TEST_CASE("obstacles: a curve of voxels drawn on S shuts in what it surrounds") {
    Random random(2);
    Tally circles, polygons;
    for (int k = 0; k < 300; ++k) {
        const Ground g = randomGround(random, k % 2);
        const Vec3d n = g.normalAtCenter();
        const Vec3d far = g.onto(g.center - (k % 2 ? kRadius : 0) * n + 8.0 * anyOrthogonal(n));
        const double start = random.between(0, 6.3);
        circles.add(g, maskOf(curveVoxels(g, 4.5, 90, start)), g.center, far);
        polygons.add(g, maskOf(curveVoxels(g, 5, 6, start)), g.center, far);
    }
    for (const Tally& t : {circles, polygons}) {
        CHECK(t.walls == 300);
        CHECK(t.leaks == 0);
        CHECK(t.swallowed < 2);
    }
}

TEST_CASE("obstacles: the thinnest wall of the core parts it wherever its voxels touch") {
    // Planes one voxel thick, in a core one voxel thick, may miss each other's voxels altogether.
    Random random(3);
    int touching = 0;
    for (int k = 0; k < 100; ++k) {
        const Ground g = randomGround(random, false);
        const Vec3d w = wallNormal(random, g);
        const auto wall = wallOf(g, w, halfEdge(w), [&](NodeIndex i) { return g.band.inCore(i); });
        if (!leadsAcross(*wall, g, normalized(cross(w, g.normalAtCenter())), kPatch - 2)) continue;
        ++touching;
        Tally tally;
        tally.add(g, wall, g.onto(g.center + g.across * w), g.onto(g.center - g.across * w));
        CHECK(tally.leaks == 0);
    }
    CHECK(touching > 20);
}

TEST_CASE("obstacles: a curve shuts in whatever the voxels of its mask") {
    Random random(4);
    for (const double size : {0.04, 0.35, 1.0, 2.6})
        for (int k = 0; k < 10; ++k) {
            // Bent as strongly as a band allows: S strays from the chords of its links.
            const Vec3d shift = random.inCube(0.5), n = random.unit(), x = anyOrthogonal(n);
            const double radius = size > 1 ? 9 : 4;
            const Ground g{sphereBand(shift, radius, 1.8), shift + radius * n, nullptr,
                           [](const Vec3d&) { return true; }, 0};
            const auto mask = openvdb::MaskGrid::create();
            const Vec3d turn = random.unit();
            mask->setTransform(rotatedTransform(size, {turn.x, turn.y, turn.z}, 77, {1, 2, 3}));
            for (double angle = 0; angle < 2 * M_PI; angle += 0.002) {
                const Vec3d side = std::cos(angle) * x + std::sin(angle) * cross(n, x);
                const Vec3d p = shift + radius * (0.6 * n + 0.8 * side);
                mask->tree().setValueOn(openvdb::Coord::round(
                    mask->transform().worldToIndex(openvdb::Vec3d(p.x, p.y, p.z))));
            }
            INFO("voxels of " << size);
            for (const auto which : {Links::Core, Links::Faces}) {
                const Parting parting =
                    part(g.band, mask, g.center, shift - radius * n, which, g.farFromCut);
                CHECK(!parting.leaks);
                CHECK(parting.p > 0);
                CHECK(parting.q > 2 * parting.p);
                CHECK(parting.swallowed < 0.5 + 1.8 * size + 1);
            }
        }
}

TEST_CASE("obstacles: a mask's voxel blocks the strips that its grown cube meets") {
    // Against the points of the strip, one by one.
    Random random(5);
    const Ijk voxel{3, -2, 5};
    const ObstacleSet set = only(maskOf({voxel}));
    int hits = 0;
    for (int k = 0; k < 2000; ++k) {
        const Vec3d a = Vec3d(voxel) + random.inCube(2.2), n = random.unit();
        const Vec3d b = k % 5 ? a + random.inCube(1.2) : a;
        // As documented: 0.6 voxels, and L^2 / 16 for the bulge, above and below; grown by 0.1.
        const double sweep = 0.6 + dot(b - a, b - a) / 16;
        double least = kInfinity;
        constexpr int kSteps = 60;
        for (int i = 0; i <= kSteps; ++i)
            for (int j = -kSteps; j <= kSteps; ++j) {
                const Vec3d d =
                    a + (double(i) / kSteps) * (b - a) + (sweep * j / kSteps) * n - Vec3d(voxel);
                least = std::min(least, std::max({std::abs(d.x), std::abs(d.y), std::abs(d.z)}));
            }
        const double between = (length(b - a) + 2 * sweep) / kSteps;
        const bool blocked = set.block(a, b, n);
        hits += blocked;
        if (blocked != (least <= 0.6) && std::abs(least - 0.6) > between)
            FAIL(least << " voxels away, blocked: " << blocked);
    }
    CHECK(hits > 100);
    CHECK(set.block({2, -2, 5}, {4, -2, 5}, {}));  // no normal: no sweep
}

TEST_CASE("obstacles: a box in a gap that is joined blocks the joints") {
    auto square = [](double from) {
        return sheet(3, 3, [from](double u, double v) { return Vec3d{from + 12 * u, 12 * v, 0}; });
    };
    const Band band = bandFromMesh(together(square(0), square(13.5)), 1, kHalfWidth,
                                   Progress::none(), /*joinGaps=*/2);
    REQUIRE(band.joints == 1);
    for (const bool high : {false, true}) {
        const auto set = std::make_shared<ObstacleSet>(Similarity{});
        set->addBox({12.3, -9, high ? 3.0 : -1.0}, {13.2, 99, 9});
        const auto metric = std::make_shared<Metric>();
        metric->setObstacles(band, set);
        CHECK(metric->blocksAny(band) == !high);
        const Field field = marchJet(band, metric, {nearestSurfacePoint(band, {6, 6, 0})});
        CHECK((sampleDistance(field, {18, 6, 0}) < kInfinity) == high);
    }
}

TEST_CASE("obstacles: spheres and boxes are exact") {
    Random random(6);
    const Similarity transform = placed();
    // In the world, which is 0.25 per voxel.
    const Vec3d middle = transform.worldFromIndex({3, -2, 5}), half{0.3, 0.1, 0.55};
    ObstacleSet sphere(transform), box(transform);
    CHECK(sphere.empty());
    sphere.addSphere(middle, 0.4);
    box.addBox(middle - half, middle + half);
    CHECK(!sphere.empty());
    int hits = 0;
    for (int k = 0; k < 3000; ++k) {
        const Vec3d a = Vec3d{3, -2, 5} + random.inCube(4), b = k % 5 ? a + random.inCube(2) : a;
        double fromCenter = kInfinity, fromBox = kInfinity;
        constexpr int kSteps = 1000;
        for (int i = 0; i <= kSteps; ++i) {
            const Vec3d d = transform.worldFromIndex(a + (double(i) / kSteps) * (b - a)) - middle;
            fromCenter = std::min(fromCenter, length(d));
            fromBox = std::min(fromBox, std::max({std::abs(d.x) - half.x, std::abs(d.y) - half.y,
                                                  std::abs(d.z) - half.z}));
        }
        const double between = 0.25 * length(b - a) / kSteps + 1e-12;
        const bool inSphere = sphere.block(a, b, {0, 0, 1}), inBox = box.block(a, b, {0, 0, 1});
        hits += inSphere + inBox;
        if (std::abs(fromCenter - 0.4) > between) REQUIRE(inSphere == (fromCenter < 0.4));
        if (std::abs(fromBox) > between) REQUIRE(inBox == (fromBox < 0));
    }
    CHECK(hits > 100);
    // Closed, and as thin as nothing.
    ObstacleSet plain{Similarity{}};
    plain.addSphere({0, 0, 0}, 2);
    plain.addBox({5, 0, 0}, {5, 4, 4});
    CHECK(plain.block({2, -1, 0}, {2, 1, 0}, {0, 0, 1}));
    CHECK(!plain.block({2.0001, -1, 0}, {2.0001, 1, 0}, {0, 0, 1}));
    CHECK(plain.block({4.5, 1, 1}, {5.5, 1, 1}, {0, 0, 1}));
    CHECK(plain.block({4, 4, 1}, {6, 4, 1}, {0, 0, 1}));
    CHECK(!plain.block({4, 4.0001, 1}, {6, 4.0001, 1}, {0, 0, 1}));

    const auto bad = Error::Kind::InvalidArgument;
    expectError(bad, {"radius 0"}, [&] { plain.addSphere({0, 0, 0}, 0); });
    expectError(bad, {"sphere"}, [&] { plain.addSphere({0, std::nan(""), 0}, 1); });
    expectError(bad, {"radius inf"}, [&] { plain.addSphere({0, 0, 0}, kInfinity); });
    expectError(bad, {"lower"}, [&] { plain.addBox({0, 1, 0}, {1, 0, 1}); });
    expectError(bad, {"finite"}, [&] { plain.addBox({0, 0, 0}, {1, kInfinity, 1}); });
}

TEST_CASE("obstacles: a level set blocks its inside, tiles and all") {
    const Similarity transform = placed();
    const openvdb::Vec3d center(11, -19, 6);
    const auto grid =
        makeLevelSet(sphere(center, 3.2), *rotatedTransform(0.1, {1, 0, 2}, 15, {1, 2, 3}), 3);
    const ObstacleSet set = only(grid, transform);
    const auto inverted = grid->deepCopy();
    for (auto it = inverted->beginValueAll(); it; ++it) it.setValue(-*it);
    inverted->tree().root().setBackground(-grid->background(), /*updateChildNodes=*/false);
    const ObstacleSet outside = only(inverted, transform);
    const Vec3d middle = transform.indexFromWorld({11, -19, 6});
    Random random(7);
    int crossing = 0;
    for (int k = 0; k < 5000; ++k) {
        const Vec3d a = middle + random.inCube(16), b = a + random.inCube(1);
        const auto [low, high] = std::minmax({length(a - middle), length(b - middle)});
        // The radius is 12.8 voxels; trilinear values are off by (0.1 / 0.25)^2 / 12.8 of one, and
        // a chord strays by a quarter of its length squared over 25.6.
        if (std::abs(low - 12.8) < 0.1 || std::abs(high - 12.8) < 0.1) continue;
        REQUIRE(set.block(a, b, {0, 0, 1}) == (low < 12.8));
        REQUIRE(outside.block(a, b, {0, 0, 1}) == (high > 12.8));
        crossing += low < 12.8 && high > 12.8;
    }
    CHECK(crossing > 50);
    CHECK(blocksPoint(outside, {5000, 0, 0}));
    CHECK(outside.mayBeNear({5000, 0, 0}, 1));
    CHECK(!set.mayBeNear({5000, 0, 0}, 1));
    // The interpolant of -1 in one voxel and 1 around it is negative halfway to the next.
    const auto single = openvdb::FloatGrid::create(1);
    single->setGridClass(openvdb::GRID_LEVEL_SET);
    single->setTransform(openvdb::math::Transform::createLinearTransform(100));
    single->tree().setValueOn({0, 0, 0}, -1);
    const ObstacleSet large = only(single);
    CHECK(blocksPoint(large, {-49, 0, 0}));
    CHECK(large.mayBeNear({-49, 0, 0}, 0));
    CHECK(!blocksPoint(large, {-51, 0, 0}));
}

TEST_CASE("obstacles: which voxels of a grid block") {
    const auto floats = openvdb::FloatGrid::create(0);
    floats->setGridClass(openvdb::GRID_FOG_VOLUME);
    floats->tree().setValueOn({0, 0, 0}, 0.51f);
    floats->tree().setValueOn({10, 0, 0}, 0.5f);
    floats->tree().setValueOff({20, 0, 0}, 1);
    const ObstacleSet fog = only(floats);
    CHECK(blocksPoint(fog, {0, 0, 0}));
    CHECK(!blocksPoint(fog, {10, 0, 0}));
    CHECK(!blocksPoint(fog, {20, 0, 0}));
    const auto bools = openvdb::BoolGrid::create(false);
    bools->tree().setValueOn({0, 0, 0}, true);
    bools->tree().setValueOn({10, 0, 0}, false);
    bools->tree().setValueOff({20, 0, 0}, true);
    const ObstacleSet mask = only(bools);
    CHECK(blocksPoint(mask, {0, 0, 0}));
    CHECK(!blocksPoint(mask, {10, 0, 0}));
    CHECK(!blocksPoint(mask, {20, 0, 0}));
    const auto tiles = openvdb::MaskGrid::create();
    tiles->sparseFill({{0, 0, 0}, {255, 255, 255}}, true);
    const ObstacleSet solid = only(tiles);
    CHECK(blocksPoint(solid, {100.3, 200.2, 17.1}));
    CHECK(blocksPoint(solid, {-0.59, 3, 3}, {0, 0, 1}));
    CHECK(!blocksPoint(solid, {-0.61, 3, 3}, {0, 0, 1}));
    CHECK(blocksPoint(solid, {-1.19, 3, 3}, {1, 0, 0}));
    CHECK(!blocksPoint(solid, {-1.21, 3, 3}, {1, 0, 0}));

    const auto bad = Error::Kind::BadInput;
    expectError(bad, {"blocks nothing", "o.vdb", "'wall'"},
                [&] { only(openvdb::MaskGrid::create()); });
    const auto hollow = makeLevelSet(sphere({0, 0, 0}, 1), 0.1, 3);
    for (auto it = hollow->beginValueAll(); it; ++it) it.setValue(std::abs(*it));
    expectError(bad, {"blocks nothing"}, [&] { only(hollow); });
    floats->tree().setValueOn({0, 0, 0}, std::nanf(""));
    expectError(bad, {"NaN"}, [&] { only(floats); });
    bools->setTransform(openvdb::math::Transform::createFrustumTransform(
        openvdb::BBoxd(openvdb::Vec3d(-30.0), openvdb::Vec3d(30.0)), 0.5, 60, 1));
    expectError(bad, {"not linear"}, [&] { only(bools); });
}

TEST_CASE(
    "obstacles: the same in both directions and on any thread; nothing is blocked where none is "
    "near") {
    const Similarity transform = placed();
    ObstacleSet set(transform);
    set.addSphere(transform.worldFromIndex({5, 0, 0}), 0.5);
    set.addBox(transform.worldFromIndex({0, 30, 0}),
               transform.worldFromIndex({0, 30, 0}) + Vec3d{1, 2, 0});
    set.addGrid(source(makeLevelSet(sphere({12, -20, 5}, 2.5), 0.9, 3)));
    Random random(8);
    const auto mask = openvdb::MaskGrid::create();
    mask->setTransform(rotatedTransform(0.4, {1, 1, 3}, 50, {10, -20, 5}));
    for (int k = 0; k < 300; ++k) {
        const Vec3d p = random.inCube(12);
        mask->tree().setValueOn({int(p.x), int(p.y), int(p.z)});
    }
    set.addGrid(source(mask));
    struct Way {
        Vec3d a, b, n;
    };
    std::vector<Way> ways;
    for (int k = 0; k < 40000; ++k) {
        const Vec3d a = random.inCube(45);
        ways.push_back({a, k % 4 ? a + random.inCube(1.7) : a, random.unit()});
    }
    std::vector<char> blocked(ways.size());
    parallelFor(ways.size(), 100, [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k)
            blocked[k] = set.block(ways[k].a, ways[k].b, ways[k].n);
    });
    int hits = 0, near = 0;
    for (std::size_t k = 0; k < ways.size(); ++k) {
        const auto& [a, b, n] = ways[k];
        hits += blocked[k];
        near += set.mayBeNear(a, length(b - a));
        REQUIRE(set.block(a, b, n) == bool(blocked[k]));
        REQUIRE(set.block(b, a, n) == bool(blocked[k]));
        REQUIRE(set.block(b, a, -n) == bool(blocked[k]));
        if (blocked[k]) REQUIRE(set.mayBeNear(a, length(b - a)));
    }
    CHECK(hits > 200);
    CHECK(near < 30000);
}

}  // namespace igeo::test
