// Shooting: exact on the plane, reversible, and what is no walk. test_shoot of the accuracy tests
// has the curves.
#include <igeo/path/exponential_map.h>
#include <support/analytic_band.h>
#include <support/catch.h>
#include <support/expect_error.h>

namespace igeo::test {
namespace {

const Vec3d kNormal = normalized(Vec3d{0.2, -0.3, 1});

Band plane() { return planeBand(kNormal, 0.4, {-20, -20, -14}, {20, 20, 14}, 2); }

}  // namespace

TEST_CASE("shoot: straight on a plane, whatever the length and the normal part of the direction") {
    const Band band = plane();
    const SurfacePoint start = nearestSurfacePoint(band, {1.3, -2.2, 0});
    const Vec3d along = normalized(tangential(Vec3d{2, 1, 0.3}, kNormal));
    for (const Vec3d& direction : {along, 1e6 * along, 1e-6 * along, along + 5.0 * kNormal}) {
        const Path path = shoot(band, start, direction, 11.3);
        CHECK(path.status == PathStatus::Reached);
        CHECK(path.weightedLength == 11.3);
        CHECK(path.distance == 11.3);
        CHECK(path.target.pIndex == start.pIndex);
        CHECK(path.vertices.size() == 24);  // steps of at most half a voxel
        for (const PathVertex& v : path.vertices) {
            // psi, feet and normals are floats.
            CHECK(length(v.pIndex - start.pIndex - v.arcLength * along) <
                  4.8e-07);  // measured 3.2e-07
            CHECK(v.distance == v.arcLength);
        }
    }
    const Path none = shoot(band, start, along, 0);
    CHECK(none.status == PathStatus::Reached);
    CHECK(none.vertices.size() == 1);
    CHECK(none.weightedLength == 0);
}

TEST_CASE("shoot: stops where the surface ends") {
    const Band band = planeBand({0, 0, 1}, 0.2, {-20, -20, -2}, {20, 20, 3}, 2);
    const SurfacePoint start = nearestSurfacePoint(band, {0, 0, 0.2});
    const Path path = shoot(band, start, {0, 1, 0}, 100);
    CHECK(path.status == PathStatus::Stalled);
    // The last nodes are at y = 20 and stand for half a voxel more.
    CHECK(path.weightedLength > 19.5);
    CHECK(path.weightedLength < 20.6);
    CHECK(path.vertices.back().arcLength == path.weightedLength);
    CHECK(path.vertices.back().pIndex.y == Approx(path.weightedLength).margin(1e-4));
}

TEST_CASE("shoot: back from the end leads to the start") {
    const Band band = sphereBand({0.3, -0.2, 0.1}, 15, 2);
    const SurfacePoint start = nearestSurfacePoint(band, {9, 3, 12});
    const Path there = shoot(band, start, {1, -1, 0.3}, 70);
    const auto& v = there.vertices;
    SurfacePoint end = nearestSurfacePoint(band, v.back().pIndex);
    end.pIndex = v.back().pIndex;
    const Path back = shoot(band, end, v[v.size() - 2].pIndex - v.back().pIndex, 70);
    // The direction is that of a chord of half a voxel.
    CHECK(length(back.vertices.back().pIndex - v.front().pIndex) < 1e-6);  // measured 2.2e-07
}

TEST_CASE("shoot: what is no direction, no length or no place to start") {
    const Band band = plane();
    const SurfacePoint start = nearestSurfacePoint(band, {1.3, -2.2, 0});
    const auto walk = [&](const Vec3d& direction, double length) {
        return [=, &band] { shoot(band, start, direction, length); };
    };
    using Kind = Error::Kind;
    expectError(Kind::InvalidArgument, {"direction", "zero"}, walk({0, 0, 0}, 1));
    expectError(Kind::InvalidArgument, {"direction"}, walk(3.0 * Vec3d(Vec3f(kNormal)), 1));
    expectError(Kind::InvalidArgument, {"direction"}, walk({std::nan(""), 0, 0}, 1));
    expectError(Kind::InvalidArgument, {"direction"}, walk({kInfinity, 0, 0}, 1));
    expectError(Kind::InvalidArgument, {"-2", "reverse the direction"}, walk({1, 0, 0}, -2));
    expectError(Kind::InvalidArgument, {"length"}, walk({1, 0, 0}, kInfinity));
    expectError(Kind::InvalidArgument, {"length"}, walk({1, 0, 0}, std::nan("")));
    SurfacePoint outside = start;
    outside.pIndex += 100.0 * kNormal;
    expectError(Kind::BadInput, {"edge"}, [&] { shoot(band, outside, {1, 0, 0}, 1); });
}

}  // namespace igeo::test
