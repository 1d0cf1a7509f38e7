// What is seen in pictures at a glance: text, backgrounds, directions, levels, folds.
#include <igeo/results/detail/canvas.h>
#include <igeo/results/isolines.h>
#include <igeo/results/picture.h>
#include <igeo/surface/level_set_band.h>
#include <igeo/surface/level_set_check.h>
#include <support/catch.h>
#include <support/openvdb.h>
#include <support/shapes.h>
#include <support/sphere_picture.h>

#include <algorithm>
#include <set>

namespace igeo::test {
namespace {

/// The pixels of a legend or text that differ from their background by more than a little.
struct Words {
    int first, last, top, bottom, count = 0;

    Words(const Image& image, int left, const Vec3d& background)
        : first(image.width), last(-1), top(image.height), bottom(-1) {
        for (int y = 0; y < image.height; ++y)
            for (int x = left; x < image.width; ++x) {
                if (length(image.light(x, y) - background) < 0.05) continue;
                first = std::min(first, x), last = std::max(last, x);
                top = std::min(top, y), bottom = std::max(bottom, y);
                ++count;
            }
    }
};

}  // namespace

TEST_CASE("Canvas: text begins where it is put, is as wide as it says and stays in the picture") {
    for (const double size : {9.0, 21.5, 60.0}) {
        const Font font(size);
        for (const std::string& s : {std::string("distance (world units)"), std::string("0.25"),
                                     std::string("\u22121e+06"), std::string("\u00b5m")}) {
            const int width = int(font.width(s)) + 60, height = int(3 * size);
            Canvas canvas(width, height);
            canvas.fill(0, 0, width, height, {1, 1, 1});
            canvas.text(font, 20.3, 2 * size, s, {0, 0, 0});
            const Image image(canvas.png());
            CHECK(!image.hasAlpha);
            const Words words(image, 0, {1, 1, 1});
            INFO(s << ", " << size);
            // Letters begin and end within a tenth of an em of their place.
            CHECK(std::abs(words.first - 20.3) < 0.12 * size + 1);
            CHECK(std::abs(words.last - 20.3 - font.width(s)) < 0.12 * size + 1);
            CHECK(words.top >= int(2 * size) - size);
            CHECK(words.bottom <= int(2 * size) + 0.3 * size);
            // Ink and paper, and shades between them: antialiased.
            std::set<std::uint8_t> shades(image.rgb.begin(), image.rgb.end());
            CHECK(*shades.begin() < 60);
            CHECK(shades.size() > 20);
        }
    }
    Canvas small(4, 4);
    small.text(Font(30), -5, 10, "88888", {1, 0, 0});
    small.fill(3, 3, 100, 100, {0, 1, 0});
    CHECK(Image(small.png()).at(3, 3)[1] == 255);
}

TEST_CASE("renderPng: words and the surface stand out from every background") {
    const SpherePicture scene({0, 0, 1});
    PictureOptions options;
    options.width = 400, options.height = 400;
    options.unit = "mm";
    options.colorMap = "gray";  // from black to white
    options.background = Background::White;
    const Image white(scene.render(options));
    options.background = Background::Black;
    const Image black(scene.render(options));
    options.background = Background::Transparent;
    const Image clear(scene.render(options));
    CHECK(!white.hasAlpha);
    CHECK(!black.hasAlpha);
    REQUIRE(clear.hasAlpha);
    // Right of the bar there are only words.
    const int left = 350;
    CHECK(white.isWhite(left, 0));
    CHECK(length(black.light(left, 0)) == 0);
    CHECK(clear.alpha[0] == 0);
    const Words onWhite(white, left, {1, 1, 1}), onBlack(black, left, {0, 0, 0});
    CHECK(onWhite.count > 100);
    CHECK(onBlack.count > 100);
    for (int y = 0; y < 400; ++y)
        for (int x = 0; x < 400; ++x) {
            const std::size_t i = std::size_t(y * 400 + x);
            // The same picture over white, by its alpha: as encoded for words, in light else.
            if (clear.alpha[i] == 255)
                REQUIRE(length(clear.light(x, y) - white.light(x, y)) < 0.02);
            if (clear.alpha[i] == 0) {
                REQUIRE(white.isWhite(x, y));
                REQUIRE(length(black.light(x, y)) == 0);
            }
        }
    // The first and the last pixel of the surface in each row differ from what is around it.
    int rows = 0;
    for (int y = 0; y < 400; ++y) {
        int first = 0;
        while (first < 300 && clear.alpha[std::size_t(y * 400 + first)] < 255) ++first;
        if (first == 300) continue;
        ++rows;
        CHECK(dot(white.light(first, y), {1, 1, 1}) < 3 * 0.8);
        CHECK(dot(black.light(first, y), {1, 1, 1}) > 3 * 0.03);
    }
    CHECK(rows > 200);
    // The unit is what differs.
    options.background = Background::White;
    options.unit = "cm";
    CHECK((scene.render(options) != scene.render([&] {
        PictureOptions o = options;
        o.unit = "mm";
        return o;
    }())));
}

TEST_CASE("renderPng: each of six directions is up") {
    // The seed is the one white dot; from a little above it is in the half that `up` says.
    for (const Vec3d& up :
         {Vec3d{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}}) {
        const SpherePicture scene(up + 0.3 * Vec3d{up.y, up.z, up.x});
        PictureOptions options;
        options.width = options.height = 160;
        options.legend = false, options.isolineSpacing = -1;
        options.colorMap = "magma";
        options.up = up;
        const Image image(scene.render(options));
        double row = 0, count = 0;
        for (int y = 2; y < 158; ++y)
            for (int x = 2; x < 158; ++x)
                if (!image.isWhite(x, y) && dot(image.light(x, y), {1, 1, 1}) > 3 * 0.9)
                    row += y, ++count;
        INFO(up.x << " " << up.y << " " << up.z);
        REQUIRE(count > 0);
        CHECK(row / count < 70);  // measured 64.9; the middle is 80
    }
}

TEST_CASE("renderPng: levels are those of isolines in files") {
    const SpherePicture scene({0, 0, 1});
    PictureOptions options = scene.plain();
    const std::string none = scene.render(options);
    options.isolineSpacing = 0;
    const std::string chosen = scene.render(options);
    CHECK((chosen != none));
    const std::vector<double> levels = chosenLevels(scene.field, 0, 0);
    CHECK(levels.size() >= 10);
    CHECK(levels.size() <= 25);
    options.isolineSpacing = (levels[1] - levels[0]) * 0.05;
    CHECK((scene.render(options) == chosen));
    options.isolineSpacing = 0;
    options.isolineCount = 3;
    CHECK((scene.render(options) != chosen));
    CHECK(chosenLevels(scene.field, 3, 0) == levelsByCount(scene.field, 3));
    CHECK(chosenLevels(scene.field, 0, 0.1) == levelsBySpacing(scene.field, 2));
}

TEST_CASE("renderPng: folds are darker than ridges") {
    // Two spheres that touch, seen from the side: at the same slope to light and eye, the neck
    // between them is darker than the outer flank.
    Shape pair;
    pair.sdf = [](const openvdb::Vec3d& p) {
        return std::min((p - openvdb::Vec3d(-0.45, 0, 0)).length(),
                        (p - openvdb::Vec3d(0.45, 0, 0)).length()) -
               0.5;
    };
    pair.bounds = openvdb::BBoxd(openvdb::Vec3d(-0.95, -0.5, -0.5), openvdb::Vec3d(0.95, 0.5, 0.5));
    LoadedGrid loaded;
    loaded.grid = makeLevelSet(pair, 0.04, 3);
    const LevelSet levelSet = checkLevelSet(std::move(loaded));
    const Band band = bandFromLevelSet(levelSet, 1.8);
    Field field;
    field.band = &band;
    field.distance.assign(band.size(), kInfinity);
    field.summarize();
    PictureOptions options;
    options.width = 400, options.height = 300;
    options.legend = false;
    options.eye = Vec3d{0, 0, 6};
    options.lookAt = Vec3d{0, 0, 0};
    const Image image(renderPng(&levelSet, field, {}, options));
    auto at = [&](double x, double z) {
        const double scale = 400 / (2 * View::kHalfWidth) / (6 - z);
        return dot(image.light(int(200 + scale * x), 150), {1, 1, 1});
    };
    // 57 degrees from the eye on the right flanks of both spheres; light comes from the left.
    const double s = 0.5 * std::sin(1), c = 0.5 * std::cos(1);
    const double outer = at(0.45 + s, c), inner = at(-0.45 + s, c);
    CHECK(inner < 0.9 * outer);  // measured 0.85
}

}  // namespace igeo::test
