/// Pictures of a sphere with exact distances, decoded again.
#pragma once

#include <igeo/results/detail/camera.h>
#include <igeo/results/picture.h>
#include <igeo/surface/level_set_band.h>
#include <igeo/surface/level_set_check.h>
#include <png.h>
#include <support/openvdb.h>
#include <support/pinned.h>
#include <support/shapes.h>

#include <cmath>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace igeo::test {

struct Image {
    int width = 0, height = 0;
    bool hasAlpha = false;
    std::vector<std::uint8_t> rgb, alpha;

    explicit Image(const std::string& bytes) {
        png_image image{};
        image.version = PNG_IMAGE_VERSION;
        if (!png_image_begin_read_from_memory(&image, bytes.data(), bytes.size()))
            throw std::runtime_error(image.message);
        hasAlpha = image.format & PNG_FORMAT_FLAG_ALPHA;
        image.format = PNG_FORMAT_RGBA;
        std::vector<std::uint8_t> rgba(PNG_IMAGE_SIZE(image));
        if (!png_image_finish_read(&image, nullptr, rgba.data(), 0, nullptr))
            throw std::runtime_error(image.message);
        width = int(image.width), height = int(image.height);
        for (std::size_t k = 0; k < rgba.size(); ++k) (k % 4 == 3 ? alpha : rgb).push_back(rgba[k]);
    }
    const std::uint8_t* at(int x, int y) const {
        if (x < 0 || x >= width || y < 0 || y >= height) throw std::out_of_range("no such pixel");
        return &rgb[std::size_t(3 * (y * width + x))];
    }
    /// Linear light.
    Vec3d light(int x, int y) const {
        auto decode = [](std::uint8_t byte) {
            const double c = byte / 255.0;
            return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
        };
        const std::uint8_t* p = at(x, y);
        return {decode(p[0]), decode(p[1]), decode(p[2])};
    }
    bool isWhite(int x, int y) const {
        return at(x, y)[0] == 255 && at(x, y)[1] == 255 && at(x, y)[2] == 255;
    }
};

/// A sphere with the exact distances from one of its points.
struct SpherePicture : Pinned {
    Vec3d center;
    double radius;
    LevelSet levelSet;
    Band band;
    Field field;

    explicit SpherePicture(const Vec3d& toSeed, double dx = 0.05,
                           const Vec3d& middle = {0.3, -0.2, 0.5},
                           openvdb::math::Transform::Ptr transform = nullptr)
        : center(middle), radius(20 * dx) {
        if (!transform) transform = openvdb::math::Transform::createLinearTransform(dx);
        LoadedGrid loaded;
        loaded.grid = makeLevelSet(sphere({center.x, center.y, center.z}, radius), *transform, 3);
        levelSet = checkLevelSet(std::move(loaded));
        band = bandFromLevelSet(levelSet, 2);
        SurfacePoint seed = nearestSurfacePoint(band, index(pointAt(toSeed)));
        field.band = &band;
        field.seeds = {seed};
        field.startRadius = 2;
        const Vec3d s = world(seed.pIndex);
        for (std::size_t i = 0; i < band.size(); ++i)
            field.distance.push_back(distance(s, world(Vec3d(band.ijk(NodeIndex(i))))) / dx);
        field.summarize();
    }
    Vec3d index(const Vec3d& p) const { return levelSet.transform.indexFromWorld(p); }
    Vec3d world(const Vec3d& p) const { return levelSet.transform.worldFromIndex(p); }
    Vec3d pointAt(const Vec3d& direction) const { return center + radius * normalized(direction); }
    double distance(const Vec3d& p, const Vec3d& q) const {
        const Vec3d a = p - center, b = q - center;
        return radius * std::atan2(length(cross(a, b)), dot(a, b));
    }
    double fromSeed(const Vec3d& p) const { return distance(world(field.seeds[0].pIndex), p); }

    /// A great circle from `from` over `via`, `angle` long.
    Path arc(const Vec3d& from, const Vec3d& via, double angle) const {
        Path path;
        const Vec3d u = normalized(from), v = normalized(tangential(via, u));
        for (int k = 0; k <= 60; ++k) {
            const double a = angle * k / 60;
            path.vertices.push_back({index(pointAt(std::cos(a) * u + std::sin(a) * v)), 0, 0});
        }
        return path;
    }

    std::string render(const PictureOptions& options, const std::vector<Path>& paths = {}) const {
        return renderPng(&levelSet, field, paths, options);
    }
    /// Options for an eye in front, at distance 6, that sees nothing but the plain surface.
    PictureOptions plain() const {
        PictureOptions o;
        o.width = 320, o.height = 240;
        o.legend = false;
        o.isolineSpacing = -1;
        o.eye = center + Vec3d{0, 0, 6 * radius};
        o.lookAt = center;
        return o;
    }
    /// Where plain(), or one of another width, shows a point; pixels from the upper left corner.
    std::pair<double, double> pixelOf(const Vec3d& p, int width = 320) const {
        const Vec3d r = p - (center + Vec3d{0, 0, 6 * radius});
        const double scale = width / (2 * View::kHalfWidth) / -r.z;
        return {width / 2 + scale * r.x, width * 3 / 8 - scale * r.y};
    }
};

}  // namespace igeo::test
