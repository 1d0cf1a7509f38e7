// Pictures of a sphere with exact distances, decoded again and compared with where its points are.
#include <igeo/base/detail/registers.h>
#include <igeo/base/parallel.h>
#include <igeo/results/color_map.h>
#include <igeo/results/field_grids.h>
#include <igeo/results/isolines.h>
#include <igeo/results/picture.h>
#include <igeo/surface/level_set_band.h>
#include <igeo/surface/level_set_check.h>
#include <support/catch.h>
#include <support/expect_error.h>
#include <support/openvdb.h>
#include <support/shapes.h>
#include <support/sphere_picture.h>

#include <atomic>
#include <set>

namespace igeo::test {
TEST_CASE("renderPng: every point has the color of its distance") {
    for (const std::string& name : {std::string("viridis"), std::string("turbo")}) {
        const SpherePicture scene({-1, 0.3, 0.2});
        PictureOptions options = scene.plain();
        options.colorMap = name;
        const Image image(scene.render(options));
        REQUIRE(image.width == 320);
        REQUIRE(image.height == 240);
        for (const auto& [x, y] : {std::pair{0, 0}, {319, 0}, {0, 239}, {319, 239}})
            CHECK(image.isWhite(x, y));
        const ColorMap map(name);
        for (const Vec3d& way : {Vec3d{0, 0, 1}, {0.5, 0, 1}, {0.4, 0.3, 1}, {-0.3, -0.5, 1}}) {
            const Vec3d p = scene.pointAt(way);
            const auto [x, y] = scene.pixelOf(p);
            // Light changes how bright a color is, not its ratios; white shine is below 0.003
            // there. A byte is good to 2.4 / 100 / 2 of linear light from 100 on, and the point
            // to a pixel, 0.02 radii of 3.1.
            const Vec3d seen = normalized(image.light(int(x), int(y)));
            const Vec3d expected =
                normalized(map(scene.fromSeed(p) / (scene.field.maxDistance * 0.05)));
            INFO(name << ": seen " << seen.x << " " << seen.y << " " << seen.z << ", expected "
                      << expected.x << " " << expected.y << " " << expected.z);
            CHECK(length(seen - expected) < 0.019);  // measured 0.013
        }
    }
}

TEST_CASE("renderPng: a seed is a white dot with a dark ring, wherever the voxels are") {
    const Vec3d toSeed{0.2, 0.4, 1};
    const Vec3d middle{0.3, -0.2, 0.5};
    auto mirrored = openvdb::math::Transform::createLinearTransform(0.05);
    mirrored->preScale(openvdb::Vec3d(-1, 1, 1));
    for (const auto& transform :
         {openvdb::math::Transform::createLinearTransform(0.05),
          rotatedTransform(0.05, {1, 1, 1}, 40, {0.01, 0.02, 0.03}), mirrored}) {
        const SpherePicture scene(toSeed, 0.05, middle, transform);
        PictureOptions options = scene.plain();
        options.width = 640, options.height = 480;
        const Image image(scene.render(options));
        const auto [x, y] = scene.pixelOf(scene.pointAt(toSeed), 640);
        CHECK(dot(image.light(int(x), int(y)), {1, 1, 1}) > 3 * 0.9);
        // The radius is 0.0075 of the width in the depth of the middle, so 5.6 pixels here, of
        // which the outer quarter is the ring.
        for (const auto& [dx, dy] : {std::pair{5, 0}, {-5, 0}, {0, 5}, {0, -5}})
            CHECK(dot(image.light(int(x) + dx, int(y) + dy), {1, 1, 1}) < 3 * 0.2);
        CHECK(!image.isWhite(int(x) + 8, int(y)));
    }
    // From behind it shows through the surface, faint.
    const SpherePicture behind({0, 0, -1});
    const Image image(behind.render(behind.plain()));
    const auto [x, y] = behind.pixelOf(behind.center);
    const Vec3d shown = image.light(int(x), int(y)), bare = image.light(int(x) + 6, int(y));
    for (int k = 0; k < 3; ++k)
        CHECK(std::sqrt(shown[k]) == Approx(0.65 * std::sqrt(bare[k]) + 0.35 * std::sqrt(0.95))
                                         .margin(0.048));  // measured 0.032
}

TEST_CASE("renderPng: isolines lie at the multiples of their spacing") {
    const SpherePicture scene({0, 0, 1});
    PictureOptions options = scene.plain();
    options.width = 640, options.height = 480;
    const Image smooth(scene.render(options));
    options.isolineSpacing = 0.15;
    const Image lined(scene.render(options));
    const double half = 320 / View::kHalfWidth;
    std::set<int> met;
    for (int x = 330; x < 640; ++x) {  // from beside the seed on
        // The ray through the pixel's middle and the sphere, in radii.
        const double s = (x + 0.5 - 320) / half, a = 1 + s * s, b = 36 - a * 35;
        if (b <= 0) break;
        const double depth = (6 - std::sqrt(b)) / a, d = std::asin(s * depth);
        const double level = std::round(d / 0.15);
        // A pixel with a tenth of line in it is darker by 0.088, or lighter on a dark color.
        const double ratio =
            dot(lined.light(x, 240), {1, 1, 1}) / dot(smooth.light(x, 240), {1, 1, 1});
        const bool line = ratio < 0.92 || ratio > 1.09;
        if (!line) continue;
        // Half a pixel, which is longer on the surface where that is seen from the side, and half
        // a line: 0.0009 of the width in the depth of the middle.
        const double facing = (std::cos(d) - s * std::sin(d)) / std::sqrt(a);
        INFO("column " << x << ", distance " << d);
        CHECK(std::abs(d - level * 0.15) <
              0.5 * depth / half / facing + 0.0009 * 640 * 6 / half + 0.0005);
        CHECK(level > 0);
        met.insert(int(level));
    }
    // Lines are 1.15 pixels wide from in front. The seventh is seen at cosine 0.35, 0.2 pixels in
    // each of two at worst; then comes the horizon, at acos(1 / 6) = 1.40.
    for (int k = 1; k <= 7; ++k) CHECK(met.count(k) == 1);
}

TEST_CASE("renderPng: paths are drawn where they are seen, faint where they are hidden") {
    SpherePicture scene({-1, 0, -1});
    scene.field.seeds.clear();
    PictureOptions options = scene.plain();
    const std::string without = scene.render(options);
    CHECK((scene.render(options, {Path{}}) == without));
    const Path back = scene.arc({0.5, 0, -1}, {0, 1, -1}, 1);
    const Image bare(without), faint(scene.render(options, {back}));
    for (std::size_t k = 10; k <= 50; k += 10) {
        const auto [x, y] = scene.pixelOf(scene.world(back.vertices[k].pIndex));
        const double before = dot(bare.light(int(x), int(y)), {1, 1, 1}),
                     after = dot(faint.light(int(x), int(y)), {1, 1, 1});
        CHECK(after > before + 0.15);
        CHECK(after < 3 * 0.75);
    }

    const Path path = scene.arc({-0.3, -0.5, 1}, {0.5, 0.3, 1}, 1);
    const Image image(scene.render(options, {path}));
    for (std::size_t k = 10; k <= 60; k += 10) {
        const auto [x, y] = scene.pixelOf(scene.world(path.vertices[k].pIndex));
        CHECK(dot(image.light(int(x), int(y)), {1, 1, 1}) > 3 * 0.5);
    }
    // Its target has a dark dot.
    const auto [x, y] = scene.pixelOf(scene.world(path.vertices[0].pIndex));
    CHECK(dot(image.light(int(x), int(y)), {1, 1, 1}) < 3 * 0.1);
}

TEST_CASE("renderPng: a path behind a thin sheet is as faint as others that are hidden") {
    const double dx = 0.05, thickness = 4 * dx;
    LoadedGrid loaded;
    loaded.grid = makeLevelSet(thinSheet({0, 0, 0}, 0.8, 0.8, thickness), dx, 3);
    const LevelSet levelSet = checkLevelSet(std::move(loaded));
    const Band band = bandFromLevelSet(levelSet, 1.8);
    Field field;
    field.band = &band;
    field.distance.assign(band.size(), 1.0);
    field.summarize();
    // A path is at least 1.8 pixels wide to either side, more than the sheet is thick here.
    PictureOptions options;
    options.width = options.height = 16;
    options.legend = false;
    options.eye = Vec3d{0, 0, 4};
    auto render = [&](double side) {
        Path path;
        for (int k = -10; side != 0 && k <= 10; ++k)
            path.vertices.push_back(
                {levelSet.transform.indexFromWorld({0.04 * k, 0, side * thickness / 2}), 0, 0});
        return renderPng(&levelSet, field, {path}, options);
    };
    const Image none(render(0)), behind(render(-1)), front(render(1));
    auto most = [&](const Image& image) {
        double change = 0;
        for (int y = 0; y < 16; ++y)
            for (int x = 0; x < 16; ++x)
                change = std::max(change, length(image.light(x, y) - none.light(x, y)));
        return change;
    };
    CHECK(most(behind) > 0.05);
    CHECK(most(behind) < 0.5 * most(front));
}

TEST_CASE("renderPng: what is not reached is gray, and an early stop ends in a smooth line") {
    const Vec3d toSeed = normalized(Vec3d{-1, 0, 1}), u{0, 1, 0}, v = cross(toSeed, u);
    SpherePicture scene(toSeed);
    for (double& d : scene.field.distance)
        if (d > 20) d = kInfinity;
    scene.field.stoppedEarly = true;
    scene.field.summarize();
    const bool jets = GENERATE(false, true);
    INFO("jets " << jets);
    scene.field.atFootPoints = jets;
    for (std::size_t i = 0; i < scene.band.size(); ++i) {
        const Vec3d n = normalized(Vec3d(scene.band.normal[i]));
        scene.field.gradient.emplace_back(normalized(tangential(-toSeed, n)));
    }
    PictureOptions options = scene.plain();
    options.width = 640, options.height = 480;
    const Image image(scene.render(options));
    // The last distance is one radius, 20 voxels; cells are known in part 1.7 voxels around it.
    const double last = jets ? 1 : 0.9;
    for (double turn = 0; turn < 2 * M_PI; turn += 0.05)
        for (const double angle : {0.3, last - 0.02, last + 0.03, 1.03, 1.06, 1.5}) {
            const Vec3d n = std::cos(angle) * toSeed +
                            std::sin(angle) * (std::cos(turn) * u + std::sin(turn) * v);
            if (n.z < 0.4) continue;  // behind the horizon, or close to it
            const auto [x, y] = scene.pixelOf(scene.pointAt(n), 640);
            const std::uint8_t* p = image.at(int(x), int(y));
            INFO("angle " << angle << ", turn " << turn);
            CHECK((p[0] == p[1] && p[1] == p[2]) == (angle > last));
        }
}

TEST_CASE("renderPng: the same bytes for any number of threads, and again") {
    const SpherePicture scene({0, 1, 0});
    PictureOptions options;
    options.width = 400, options.height = 300;
    const std::vector<Path> paths{scene.arc({0.3, 0, 1}, {0, 1, 0}, 1.2)};
    std::vector<std::string> pictures;
    for (const int threads : {1, 2, 2}) {
        const ThreadLimit limit(threads);
        pictures.push_back(scene.render(options, paths));
    }
    CHECK((pictures[0] == pictures[1]));
    CHECK((pictures[1] == pictures[2]));
    // Its chunks hold no time, and name the color space.
    CHECK((pictures[0].find("sRGB") != std::string::npos));
    CHECK((pictures[0].find("tIME") == std::string::npos));
    CHECK(pictures[0].substr(pictures[0].size() - 8, 4) == "IEND");
}

TEST_CASE("renderPng: the same bytes with registers of four and of eight floats") {
    bool& eight = eightAtATime();
    const bool hasEight = eight;
    if (!eight) WARN("skipped: this processor has no registers of eight floats");
    const SpherePicture scene({0.3, 0.2, 1});
    PictureOptions options;
    options.width = 403, options.height = 301;  // no multiple of either
    const std::string byEight = scene.render(options);
    eight = false;
    const std::string byFour = scene.render(options);
    eight = hasEight;
    CHECK((byEight == byFour));
}

TEST_CASE("renderPng: distances at corners of triangles give the picture of those at pixels") {
    // With a weight, which is 1 everywhere here, distances are read at pixels.
    SpherePicture scene({0.3, 0.2, 1});
    PictureOptions options;
    options.width = 640, options.height = 480;
    options.legend = false;
    const Image atCorners(scene.render(options));
    auto weighted = std::make_shared<Metric>();
    weighted->weight.assign(scene.band.size(), 1.0f);
    scene.field.metric = weighted;
    const Image atPixels(scene.render(options));
    std::size_t differ = 0;
    int most = 0;
    for (std::size_t k = 0; k < atPixels.rgb.size(); ++k) {
        const int off = std::abs(int(atPixels.rgb[k]) - int(atCorners.rgb[k]));
        differ += off > 4, most = std::max(most, off);
    }
    CHECK(differ < 665);  // measured 443, of a million; beside isolines
    CHECK(most < 48);     // measured 32
}

TEST_CASE("renderPng: the chosen view shows the seed, and all of the surface, at any size") {
    PictureOptions options;
    options.width = 120, options.height = 90;
    options.legend = false;
    for (const Vec3d& up : {Vec3d{0, 1, 0}, {0, 0, 1}, {1, 0, 0}})
        for (const Vec3d& toSeed :
             {Vec3d{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}}) {
            const SpherePicture scene(toSeed);
            options.up = up;
            const Image image(scene.render(options));
            int white = 0, onEdge = 0, top = image.height, bottom = 0;
            for (int y = 0; y < image.height; ++y) {
                int first = image.width, last = -1;  // of the surface in this row
                for (int x = 0; x < image.width; ++x) {
                    if (image.isWhite(x, y)) continue;
                    onEdge += x == 0 || y == 0 || x == image.width - 1 || y == image.height - 1;
                    first = std::min(first, x), last = x;
                    top = std::min(top, y), bottom = std::max(bottom, y);
                }
                for (int x = first; x <= last; ++x)
                    white += dot(image.light(x, y), {1, 1, 1}) > 3 * 0.9;
            }
            CHECK(onEdge == 0);
            CHECK(white >= 9);
            // A margin of 6 %, and the voxels within one of 20 around the sphere; and a pixel.
            CHECK(bottom - top + 2 > image.height / (1.06 * 1.05));
        }
    // Nothing but numbers depends on the unit of length. Powers of two, so that no rounding does.
    options.isolineSpacing = -1;
    const std::string unit = SpherePicture({1, 1, 1}, 1.0, {0, 0, 0}).render(options);
    for (const double dx : {std::ldexp(1.0, -15), std::ldexp(1.0, 30)})
        CHECK((SpherePicture({1, 1, 1}, dx, {0, 0, 0}).render(options) == unit));
}

TEST_CASE("renderPng: the legend is the color map, and is left out where it does not fit") {
    const SpherePicture scene({0, 0, 1});
    PictureOptions options = scene.plain();
    options.width = 400, options.height = 400;
    options.legend = true;
    const Image image(scene.render(options));
    // The bar's upper end: the first row, right of the sphere, that is neither white nor dark.
    const ColorMap map(options.colorMap);
    auto is = [&](int x, int y, const Vec3d& color) {
        return length(image.light(x, y) - color) < 0.02;
    };
    int bars = 0;
    for (int x = 300; x < 400; ++x) {
        int first = 0, last = 399;
        while (first < 399 && !is(x, first, map(1))) ++first;
        while (last > 0 && !is(x, last, map(0))) --last;
        if (last - first < 200) continue;
        ++bars;
        for (int y = first; y <= last; ++y) CHECK(is(x, y, map(double(last - y) / (last - first))));
    }
    CHECK(bars == 14);

    options.width = 120, options.height = 90;
    const std::string small = scene.render(options);
    options.legend = false;
    CHECK((scene.render(options) == small));
}

TEST_CASE("renderPng: a cut surface ends where its data ends") {
    const double dx = 0.05;
    LoadedGrid loaded;
    loaded.grid = makeLevelSet(planePatch({0.01, 0.02, 0.03}, {0, 0, 1}, 2), dx, 3);
    const LevelSet levelSet = checkLevelSet(std::move(loaded));
    REQUIRE(levelSet.stats.cutVoxels > 0);
    const Band band = bandFromLevelSet(levelSet, 2);
    Field field;
    field.band = &band;
    field.distance.assign(band.size(), 1.0);
    field.summarize();
    PictureOptions options;
    options.width = 300, options.height = 300;
    options.legend = false, options.isolineSpacing = -1;
    options.eye = Vec3d{0, 0, 8};
    options.lookAt = Vec3d{0, 0, 0};
    // From in front, and from the side, where a wall at the edge would be seen.
    for (const Vec3d& eye : {Vec3d{0, 0, 8}, {0, -8, 0.4}}) {
        options.eye = eye;
        const Image image(renderPng(&levelSet, field, {}, options));
        CHECK(!image.isWhite(150, 150));
        const Vec3d back = normalized(eye), right{1, 0, 0}, up = cross(back, right);
        const double scale = 150 / View::kHalfWidth;
        int wall = 0, hole = 0;
        for (int y = 0; y < 300; ++y)
            for (int x = 0; x < 300; ++x) {
                const Vec3d dir =
                    (x + 0.5 - 150) / scale * right + (150 - y - 0.5) / scale * up - back;
                const Vec3d p = eye + (0.03 - eye.z) / dir.z * dir;
                const double out = std::max(std::abs(p.x - 0.01), std::abs(p.y - 0.02)) - 1;
                // A pixel, and the voxel around the last value.
                const double blur = (8.1 / scale) / std::abs(normalized(dir).z);
                wall += out > blur && !image.isWhite(x, y);
                hole += out < -2 * dx - blur && image.isWhite(x, y);
            }
        CHECK(wall == 0);
        CHECK(hole == 0);
    }
}

TEST_CASE("renderPng: options out of range are refused") {
    const SpherePicture scene({0, 0, 1});
    auto refused = [&](const std::vector<std::string>& phrases, auto change) {
        PictureOptions options;
        options.width = 32, options.height = 24;
        change(options);
        expectError(Error::Kind::InvalidArgument, phrases,
                    [&] { renderPng(&scene.levelSet, scene.field, {}, options); });
    };
    refused({"0 x 24", "16384"}, [](auto& o) { o.width = 0; });
    refused({"32 x -1", "16384"}, [](auto& o) { o.height = -1; });
    refused({"16385", "16384"}, [](auto& o) { o.width = 16385; });
    refused({"'jet'", "viridis, magma"}, [](auto& o) { o.colorMap = "jet"; });
    refused({"isoline"}, [](auto& o) { o.isolineSpacing = std::nan(""); });
    refused({"looks at itself", "1,2,3"}, [](auto& o) { o.eye = o.lookAt = Vec3d{1, 2, 3}; });
    refused({"looks at itself"}, [&](auto& o) { o.eye = o.lookAt = scene.center; });
    refused({"inside the surface", "0.3,-0.2,0.5"}, [&](auto& o) {
        o.eye = scene.pointAt({1, 0, 0}) - Vec3d{0.4, 0, 0};
    });
    refused({"along its up direction"}, [](auto& o) { o.eye = {0, 9, 0}, o.lookAt = {0, 0, 0}; });
    refused({"up direction"}, [](auto& o) { o.up = {0, 0, 0}; });
    refused({"position or target"}, [](auto& o) { o.eye = {0, kInfinity, 0}; });
}

TEST_CASE("renderPng: stops when asked to, and reports how far it is") {
    struct Stop : Progress {
        bool stop = false;
        std::atomic<int> calls{0};
        void update(const char*, double fraction) override {
            ++calls;
            if (!(fraction >= 0 && fraction <= 1)) calls = -1000000;
        }
        bool cancelled() const override { return stop; }
    } progress;
    const SpherePicture scene({0, 0, 1});
    PictureOptions options;
    options.width = 32, options.height = 24;
    auto render = [&] { renderPng(&scene.levelSet, scene.field, {}, options, progress); };
    progress.stop = true;
    expectError(Error::Kind::Cancelled, {}, render);
    progress.stop = false;
    render();
    CHECK(progress.calls >= 2 * options.height);
}

TEST_CASE("roundSpacing: 1, 2 or 5 times a power of ten, nearest by ratio") {
    CHECK(roundSpacing(16, 16) == Approx(1));
    CHECK(roundSpacing(M_PI, 16) == Approx(0.2));
    CHECK(roundSpacing(8e-7, 16) == Approx(5e-8));
    CHECK(roundSpacing(1.5e9, 16) == Approx(1e8));
    for (double range = 1e-3; range < 1e3; range *= 1.07) {
        const double lines = range / roundSpacing(range, 16);
        CHECK(lines >= 16 / std::sqrt(2.5) * (1 - 1e-9));
        CHECK(lines <= 16 * std::sqrt(2.5) * (1 + 1e-9));
    }
}

TEST_CASE("colorGrid: the colors of the distances in linear light, gray elsewhere") {
    SpherePicture scene({0, 0, 1});
    scene.field.distance[7] = kInfinity;
    const ColorMap map("cividis");
    const auto grid = colorGrid(scene.field, map, scene.levelSet.psi->transform(), "c");
    CHECK(grid->getName() == "c");
    CHECK(grid->transform() == scene.levelSet.psi->transform());
    CHECK(grid->activeVoxelCount() == scene.band.size() - 1);
    auto at = [&](NodeIndex i) {
        const Ijk p = scene.band.ijk(i);
        const openvdb::Vec3s c = grid->tree().getValue({p.x, p.y, p.z});
        return Vec3d{c.x(), c.y(), c.z()};
    };
    const Vec3d gray = at(7);
    CHECK(gray.x == gray.y);
    CHECK(gray.y == gray.z);
    for (const NodeIndex i : {NodeIndex(0), NodeIndex(100), NodeIndex(scene.band.size() - 1)}) {
        const Vec3d expected = map(scene.field.distance[i] / scene.field.maxDistance);
        CHECK(length(at(i) - expected) < 3.8e-08);  // measured 2.5e-08
    }
}

}  // namespace igeo::test
