#include <igeo/base/detail/single.h>
#include <igeo/base/types.h>
#include <support/catch.h>

#include <random>

namespace igeo::test {
namespace {

/// A rotation by `angle` about z followed by one about x, with a reflection if `mirrored`.
Similarity similarity(double dx, double angle, bool mirrored, const Vec3d& origin) {
    const double c = std::cos(angle), s = std::sin(angle);
    Similarity t;
    t.dx = dx;
    t.axis = {Vec3d{c, c * s, s * s}, Vec3d{-s, c * c, c * s}, Vec3d{0, -s, c}};
    if (mirrored) t.axis[2] = -t.axis[2];
    t.origin = origin;
    return t;
}

}  // namespace

TEST_CASE("Similarity: there and back, lengths scaled by dx") {
    std::mt19937 random(1);
    std::uniform_real_distribution<double> unit(-1, 1);
    for (int trial = 0; trial < 1000; ++trial) {
        const double dx = std::pow(10.0, 4 * unit(random));
        const Vec3d origin = 1000 * dx * Vec3d(unit(random), unit(random), unit(random));
        const Similarity t = similarity(dx, 3 * unit(random), trial % 2 == 1, origin);
        const Vec3d p = 1000.0 * Vec3d(unit(random), unit(random), unit(random));
        const Vec3d q = 1000.0 * Vec3d(unit(random), unit(random), unit(random));
        // Rounding of coordinates of about 1000 voxels and of the axes: 2e-16 each, some ten times.
        const double rounding = 4000 * 10 * 2.3e-16;
        REQUIRE(length(t.indexFromWorld(t.worldFromIndex(p)) - p) < rounding);
        const double apart = length(t.worldFromIndex(p) - t.worldFromIndex(q));
        REQUIRE(std::abs(apart / dx - length(p - q)) < rounding);
        REQUIRE(std::abs(length(t.worldFromIndexDirection(p)) - length(p)) < rounding);
        REQUIRE(t.worldFromIndex({}) == origin);
    }
}

TEST_CASE("Similarity: the default is the identity") {
    const Similarity t;
    const Vec3d p{1.25, -3, 7e5};
    CHECK(t.worldFromIndex(p) == p);
    CHECK(t.indexFromWorld(p) == p);
}

TEST_CASE("types: rounding goes down at negative coordinates too") {
    CHECK(roundToIjk({0.49, 0.5, -0.5}) == Ijk{0, 1, 0});
    CHECK(roundToIjk({-0.51, -1.5, -1.6}) == Ijk{-1, -1, -2});
    CHECK(floorToIjk({-0.01, -1, 1.99}) == Ijk{-1, -1, 1});
}

TEST_CASE("types: single precision rounds each coordinate") {
    const Vec3d third{1.0 / 3, -2.0 / 3, 1e9 / 3};
    const Vec3d p = inSingle(third);
    for (int a = 0; a < 3; ++a) {
        CHECK(p[a] != third[a]);
        CHECK(std::abs(p[a] / third[a] - 1) < 6e-8);
    }
    CHECK(inSingle(p) == p);
}

TEST_CASE("types: vectors") {
    const Vec3d a{1, 2, 3}, b{-2, 0.5, 4};
    CHECK(dot(a, b) == 11);
    CHECK(cross(a, b) == Vec3d{6.5, -10, 4.5});
    CHECK(length(Vec3d{2, 3, 6}) == 7);
    CHECK(normalized(Vec3d{}) == Vec3d{});
    CHECK(normalized(Vec3d{0, 0, -5}) == Vec3d{0, 0, -1});
    CHECK(tangential(a, Vec3d{0, 0, 1}) == Vec3d{1, 2, 0});
    Ijk c{4, 5, 6};
    c[1] = -5;
    CHECK((c[0] == 4 && c[1] == -5 && c[2] == 6));
}

}  // namespace igeo::test
