#include <igeo/band/detail/snap.h>
#include <igeo/band/surface_point.h>
#include <support/analytic_band.h>
#include <support/catch.h>
#include <support/expect_error.h>

#include <random>
#include <set>

namespace igeo::test {
namespace {

const Vec3d kMiddle{0.3, -0.2, 0.1};

}  // namespace

TEST_CASE("nearestSurfacePoint: snap distance on a sphere, near and far") {
    const double radius = 20;
    const Band band = sphereBand(kMiddle, radius, 2);
    // The trilinear interpolant's zero is off the sphere by at most 1/8 of the sum of second
    // derivatives, 2 / R, at R - 1.
    const double interpolant = 0.25 / (radius - 1);
    std::mt19937 random(1);
    std::normal_distribution<double> normal;
    for (const double r : {10.0, 18.7, 20.0, 21.2, 23.0, 30.0, 100.0, 1e4}) {
        for (int trial = 0; trial < 50; ++trial) {
            const Vec3d u = normalized(Vec3d{normal(random), normal(random), normal(random)});
            const Vec3d asked = kMiddle + r * u;
            const SurfacePoint p = nearestSurfacePoint(band, asked);
            INFO("r = " << r << ", direction " << u.x << " " << u.y << " " << u.z);
            REQUIRE(p.askedIndex == asked);
            REQUIRE(p.snapDistance == length(p.pIndex - asked));
            REQUIRE(std::abs(length(p.pIndex - kMiddle) - radius) < interpolant + 1e-6);
            // Every point of the sphere has a voxel within sqrt(3)/2, so a foot point within that
            // times R / (R - 1) sideways: s = 0.92. By the law of cosines a foot point that far
            // off is further away by at most s^2 r / (2 R |r - R|), and by s at most.
            const double s = 0.92, away = std::abs(r - radius);
            const double sideways = away > 0 ? std::min(s, s * s * r / (2 * radius * away)) : 0;
            REQUIRE(p.snapDistance > away - interpolant - 1e-6);
            REQUIRE(p.snapDistance < away + interpolant + sideways + 1e-6);
            // The node is the nearest voxel.
            REQUIRE(p.node != kNoNode);
            REQUIRE(band.ijk(p.node) == roundToIjk(p.pIndex));
            REQUIRE(p.start == 0);
        }
    }
}

TEST_CASE("nearestSurfacePoint: near points keep their tangential position") {
    const Vec3d n = normalized(Vec3d{1, -2, 0.5});
    const Band band = planeBand(n, 0.3, {-15, -15, -15}, {15, 15, 15}, 3);
    std::mt19937 random(2);
    std::uniform_real_distribution<double> unit(-5, 5);
    for (int trial = 0; trial < 500; ++trial) {
        const Vec3d q{unit(random), unit(random), unit(random)};
        const Vec3d onPlane = q - (dot(n, q) - 0.3) * n;
        const double away = 1.2 * (unit(random) / 5);
        const SurfacePoint p = nearestSurfacePoint(band, onPlane + away * n);
        // Tolerance of projectToSurface and the rounding of float normals.
        REQUIRE(length(p.pIndex - onPlane) < 2e-7);                   // measured 1.3e-7
        REQUIRE(std::abs(p.snapDistance - std::abs(away)) < 7.3e-8);  // measured 4.8e-8
    }
}

TEST_CASE("nearestSurfacePoint: ties go to the node of the smallest number") {
    // All foot points of the lattice plane z = 0 are lattice points; above the middle of a cell
    // four are equally near, each foot point of several voxels.
    const Band band = planeBand({0, 0, 1}, 0, {-20, -20, -4}, {20, 20, 4}, 3);
    for (const Vec3d& asked : {Vec3d{0.5, 0.5, 10}, Vec3d{-7.5, 7.5, -50}, Vec3d{8, 3.5, 12}}) {
        NodeIndex first = kNoNode;
        double least = kInfinity;
        for (std::size_t k = 0; k < band.size(); ++k) {
            const double r = length(band.footPoint(NodeIndex(k)) - asked);
            if (r < least) least = r, first = NodeIndex(k);
        }
        const SurfacePoint p = nearestSurfacePoint(band, asked);
        CHECK(p.pIndex == band.footPoint(first));
        CHECK(p.snapDistance == least);
    }
}

TEST_CASE("nearestSurfacePoint: any finite position will do") {
    const Band band = sphereBand(kMiddle, 8, 2);
    for (const double far : {1e6, 3e9, 1e30, 1e200}) {
        for (const Vec3d& u : {Vec3d{1, 0, 0}, Vec3d{-0.6, 0, 0.8}}) {
            const SurfacePoint p = nearestSurfacePoint(band, far * u);
            REQUIRE(p.node < band.size());
            CHECK(std::abs(length(p.pIndex - kMiddle) - 8) < 0.25 / 7 + 1e-6);
            // Beyond 1e15 the surface is smaller than a rounding of the distance.
            if (far < 1e8) CHECK(dot(normalized(p.pIndex - kMiddle), u) > 0.98);
        }
    }
    const SurfacePoint middle = nearestSurfacePoint(band, kMiddle);
    CHECK(std::abs(middle.snapDistance - 8) < 0.25 / 7 + 1e-6);
}

TEST_CASE("nearestSurfacePoint: an empty band has no points") {
    expectError(Error::Kind::BadInput, {"empty"}, [] {
        nearestSurfacePoint(bandOfVoxels({}), {0, 0, 0});
    });
}

TEST_CASE("nodesAround: all nodes within the radius, sorted") {
    const Band band = sphereBand(kMiddle, 20, 2);
    const SurfacePoint p = nearestSurfacePoint(band, kMiddle + Vec3d{11, 13, 10});
    const auto found = nodesAround(band, p, 3.5);
    std::vector<NodeIndex> expected;
    for (std::size_t k = 0; k < band.size(); ++k)
        if (length(Vec3d(band.ijk(NodeIndex(k))) - p.pIndex) <= 3.5)
            expected.push_back(NodeIndex(k));
    // A disc of a smooth surface is connected.
    CHECK(found == expected);
    // No radius: the node of the point alone.
    CHECK(nodesAround(band, p, 0) == std::vector<NodeIndex>{p.node});
}

TEST_CASE("nodesAround: stops at gaps and at facing sheets") {
    // Two planes 8 voxels apart, in bands that do not touch.
    const auto gap = [](const Vec3d& p) { return std::abs(p.z) - 4; };
    const auto up = [](const Vec3d& p) { return Vec3d{0, 0, p.z >= 0 ? 1.0 : -1.0}; };
    const Band apart = analyticBand(gap, up, {-12, -12, -8}, {12, 12, 8}, 2);
    for (const NodeIndex i : nodesAround(apart, nearestSurfacePoint(apart, {0, 0, 4}), 9))
        REQUIRE(apart.ijk(i).z > 0);

    // A slab 2 voxels thick in one band.
    const auto slab = [](const Vec3d& p) { return std::abs(p.z) - 1; };
    const Band thin = analyticBand(slab, up, {-12, -12, -5}, {12, 12, 5}, 2);
    for (const double side : {1.0, -1.0}) {
        const auto found = nodesAround(thin, nearestSurfacePoint(thin, {0.2, 0.3, side}), 4);
        CHECK(found.size() > 50);
        for (const NodeIndex i : found) REQUIRE(thin.normal[i].z == float(side));
    }
}

TEST_CASE("a point is in the other space where it is near the surface there, and far as given") {
    const auto answer = [](double asGiven, double asOther) {
        SurfacePoint given, other;
        given.snapDistance = asGiven, other.snapDistance = asOther;
        return isInOtherSpace(given, other);
    };
    CHECK(answer(30, 0.1));
    CHECK(answer(8.1, 2));
    CHECK(!answer(30, 2.1));  // off the surface in both
    CHECK(!answer(7.9, 0.1));
    CHECK(!answer(4, 3));  // voxels of about 1 at the origin: both spaces are nearly one
}

}  // namespace igeo::test
