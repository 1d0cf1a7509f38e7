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

TEST_CASE("ColorMap: the published colors") {
    CHECK(ColorMap::names() ==
          std::vector<std::string>{"viridis", "magma", "cividis", "turbo", "gray"});
    struct Published {
        const char* name;
        int entry;  ///< of 256
        Vec3d color;
        double within;  ///< of 255
    };
    // From matplotlib 3.6.3. Those at multiples of 5 are in the table, the others come between two.
    for (const Published& p : {
             Published{"viridis", 0, {0x44, 0x01, 0x54}, 0.01},
             {"viridis", 255, {0xfd, 0xe7, 0x25}, 0.01},
             {"viridis", 128, {33, 145, 140}, 1},
             {"magma", 100, {137, 40, 129}, 0.01},
             {"magma", 203, {254, 157, 108}, 1},
             {"cividis", 22, {0, 49, 113}, 4},
             {"turbo", 60, {47, 178, 244}, 0.01},
             {"turbo", 177, {254, 169, 51}, 1},
             {"gray", 77, {77, 77, 77}, 0.01},
         }) {
        const Vec3d seen = 255.0 * srgbFromLinear(ColorMap(p.name)(p.entry / 255.0));
        INFO(p.name << " " << p.entry << ": " << seen.x << " " << seen.y << " " << seen.z);
        for (int k = 0; k < 3; ++k) CHECK(std::abs(seen[k] - p.color[k]) <= p.within);
    }
}

TEST_CASE("ColorMap: lightness rises from one end to the other, but for turbo's") {
    for (const std::string& name : ColorMap::names()) {
        if (name == "turbo") continue;
        const ColorMap map(name);
        constexpr int kSteps = 300;
        double before = -1;
        for (int k = 0; k <= kSteps; ++k) {
            const double light = lightness(map(double(k) / kSteps));
            INFO(name << " " << k);
            CHECK(light > before);
            before = light;
        }
        CHECK(before > 0.88);
    }
}

TEST_CASE("ColorMap: no two distances look the same") {
    for (const std::string& name : ColorMap::names()) {
        const ColorMap map(name);
        for (int k = 0; k < 32; ++k) {
            const Vec3d a = srgbFromLinear(map(k / 32.0)), b = srgbFromLinear(map((k + 1) / 32.0));
            CHECK(length(b - a) > 0.0204);  // measured 0.0307
            CHECK(length(b - a) < 0.36);    // measured 0.239, of turbo
        }
    }
}

TEST_CASE("ColorMap: beyond the ends it stays at them") {
    const ColorMap map("viridis");
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
    expectError(Error::Kind::InvalidArgument, {"viridis"}, [] { ColorMap(""); });
}

}  // namespace igeo::test
