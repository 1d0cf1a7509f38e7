#include <igeo/march/seeds.h>
#include <support/analytic_band.h>
#include <support/catch.h>
#include <support/expect_error.h>

#include <random>
#include <set>

namespace igeo::test {
namespace {

SurfacePoint at(const Vec3d& p, bool joined = false) {
    SurfacePoint s;
    s.pIndex = p;
    s.joined = joined;
    return s;
}

Band levelPlane() { return planeBand({0, 0, 1}, 0.2, {-20, -20, -3}, {20, 20, 3}, 1.8); }

}  // namespace

TEST_CASE("seeds: what follows joined belongs to the source before it") {
    const Vec3d o;
    CHECK(sourcesOf({}).empty());
    CHECK(sourcesOf({at(o), at(o), at(o, true), at(o, true), at(o)}) ==
          std::vector<std::uint32_t>{0, 1, 1, 1, 2});
    // No seed is before the first.
    CHECK(sourcesOf({at(o, true), at(o, true)}) == std::vector<std::uint32_t>{0, 0});
}

TEST_CASE("seeds: nearestTo a segment and its ends") {
    SurfacePoint s = at({1, 2, 3});
    CHECK(s.nearestTo({9, 9, 9}) == Vec3d{1, 2, 3});
    s.segment = {2, 0, 0};
    CHECK(s.nearestTo({0, 5, 5}) == Vec3d{1, 2, 3});
    CHECK(s.nearestTo({7, 5, 5}) == Vec3d{3, 2, 3});
    CHECK(s.nearestTo({2.5, 5, 5}) == Vec3d{2.5, 2, 3});
}

TEST_CASE("SeedsNear: finds all within the radius, far from the origin as well") {
    constexpr double kNear = 3;
    std::mt19937 random(1);
    std::uniform_real_distribution<double> spread(-15, 15);
    for (const double offset : {0.0, 1e9}) {
        for (const std::size_t count : {1u, 8u, 9u, 300u}) {
            auto somewhere = [&] {
                return Vec3d{offset + spread(random), spread(random) - offset, spread(random)};
            };
            std::vector<SurfacePoint> seeds;
            for (std::size_t k = 0; k < count; ++k) seeds.push_back(at(somewhere()));
            seeds[0].segment = {1.5, 0, 0};
            const SeedsNear near(seeds, kNear);
            for (int round = 0; round < 50; ++round) {
                const Vec3d p = somewhere();
                std::multiset<std::size_t> visited;
                near.forNear(p, [&](std::size_t k) { visited.insert(k); });
                for (std::size_t k = 0; k < count; ++k) {
                    if (length(seeds[k].nearestTo(p) - p) <= kNear) CHECK(visited.count(k) == 1);
                    CHECK(visited.count(k) <= 1);
                }
                if (count == 300) CHECK(visited.size() < 200);
            }
        }
    }
}

TEST_CASE("seedsAlong: segments of half a voxel from end to end") {
    const Band band = levelPlane();
    Curve curve;
    curve.points = {{-5, 0, 0}, {5, 0.3, 1}, {5, 6, 0.2}};
    curve.start = 2;
    for (const bool closed : {false, true}) {
        curve.closed = closed;
        const auto seeds = seedsAlong(band, curve, 1);
        Vec3d end = seeds.front().pIndex;
        for (const SurfacePoint& s : seeds) {
            CHECK(length(s.pIndex - end) < 1e-9);
            CHECK(std::abs(s.pIndex.z - 0.2) < 7.2e-08);  // measured 4.8e-08
            CHECK(length(s.segment) < 0.5 + 1e-9);
            CHECK(s.start == 2);
            CHECK(s.joined == (&s != &seeds.front()));
            end = s.pIndex + s.segment;
        }
        CHECK(length(end - (closed ? seeds.front().pIndex : Vec3d{5, 6, 0.2})) < 1e-6);
    }
    curve.points = {{3, 3, 0}};
    CHECK(seedsAlong(band, curve, 1).size() == 1);
}

TEST_CASE("seedsAlong: a point far away makes no more segments than the surface is wide") {
    const Band sphere = sphereBand({0, 0, 0}, 10, 1.8);
    const auto seeds = seedsAlong(sphere, {{{10, 0, 0}, {2e5, 2e4, 0}}, false, 0}, 1e6);
    // atan(0.1) of 10 voxels, twice per voxel, the start, and one for rounding up.
    CHECK(seeds.size() <= 4);
}

TEST_CASE("seedsAlong: curves off the surface are refused") {
    const Band band = levelPlane();
    using Kind = Error::Kind;
    expectError(Kind::InvalidArgument, {"no points"}, [&] { seedsAlong(band, {}, 1); });
    expectError(Kind::InvalidArgument, {"point 1", "2.8", "maxSnap"}, [&] {
        seedsAlong(band, {{{0, 0, 0}, {1, 0, 3}}, false, 0}, 1);
    });
    // The line between its points is cut by the end of the plane.
    const Band sphere = sphereBand({0, 0, 0}, 10, 1.8);
    expectError(Kind::InvalidArgument, {"between points 0 and 1", "more points"}, [&] {
        seedsAlong(sphere, {{{10, 0, 0}, {-10, 0.5, 0}}, false, 0}, 1);
    });
}

}  // namespace igeo::test
