#include <igeo/results/color_map.h>
#include <support/catch.h>
#include <support/expect_error.h>

namespace igeo::test {
namespace {

/// Lightness L of Oklab, from linear light: the cube-root response, written the other way round.
double lightness(const Vec3d& c) {
    const double l = std::cbrt(0.4122214708 * c.x + 0.5363325363 * c.y + 0.0514459929 * c.z);
    const double m = std::cbrt(0.2119034982 * c.x + 0.6806995451 * c.y + 0.1073969566 * c.z);
    const double s = std::cbrt(0.0883024619 * c.x + 0.2817188376 * c.y + 0.6299787005 * c.z);
    return 0.2104542553 * l + 0.7936177850 * m - 0.0040720468 * s;
}

}  // namespace

TEST_CASE("srgbFromLinear: fixed points, the standard's middle, clamped") {
    const Vec3d c = srgbFromLinear({0, 0.21404114, 1});
    CHECK(c.x == 0);
    CHECK(c.y == Approx(0.5).margin(1e-7));
    CHECK(c.z == Approx(1));
    CHECK(srgbFromLinear({-1, 0.001, 7}).x == 0);
    CHECK(srgbFromLinear({-1, 0.001, 7}).y == Approx(0.01292));
    CHECK(srgbFromLinear({-1, 0.001, 7}).z == Approx(1));
}

TEST_CASE("ColorMap: lightness rises evenly from one end to the other") {
    REQUIRE(ColorMap::names().size() >= 4);
    for (const std::string& name : ColorMap::names()) {
        const ColorMap map(name);
        const double first = lightness(map(0)), last = lightness(map(1));
        INFO(name << ": " << first << " to " << last);
        // White lines stand out at one end and black ones at the other.
        CHECK(first < 0.45);
        CHECK(last > 0.88);
        constexpr int kSteps = 300;
        double before = -1;
        for (int k = 0; k <= kSteps; ++k) {
            const double t = double(k) / kSteps, light = lightness(map(t));
            CHECK(light > before);
            before = light;
            // Off the line only where a color is clamped to sRGB: less than one sees.
            CHECK(std::abs(light - (first + t * (last - first))) < 0.01);
        }
    }
}

TEST_CASE("ColorMap: no two distances look the same") {
    for (const std::string& name : ColorMap::names()) {
        const ColorMap map(name);
        for (int k = 0; k < 32; ++k) {
            const Vec3d a = srgbFromLinear(map(k / 32.0)), b = srgbFromLinear(map((k + 1) / 32.0));
            CHECK(length(b - a) > 3.0 / 255);
            CHECK(length(b - a) < 0.15);
        }
    }
}

TEST_CASE("ColorMap: beyond the ends it stays at them") {
    const ColorMap map("lagoon");
    CHECK(map(-1) == map(0));
    CHECK(map(-kInfinity) == map(0));
    CHECK(map(std::nan("")) == map(0));
    CHECK(map(1.5) == map(1));
    CHECK(map(kInfinity) == map(1));
    CHECK(map(0) != map(1));
}

TEST_CASE("ColorMap: an unknown name is refused with those there are") {
    std::vector<std::string> phrases = ColorMap::names();
    phrases.push_back("'rainbow'");
    expectError(Error::Kind::InvalidArgument, phrases, [] { ColorMap("rainbow"); });
    expectError(Error::Kind::InvalidArgument, {"lagoon"}, [] { ColorMap(""); });
}

}  // namespace igeo::test
