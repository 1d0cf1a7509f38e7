/// Visible triangles at the pixels of a picture. Internal to the pictures.
#pragma once

#include <igeo/band/surface_triangles.h>
#include <igeo/base/progress.h>

#include <array>
#include <limits>
#include <vector>

namespace igeo {

/// A perspective camera in index space with unit axes; pixels count from the upper left.
struct Frame {
    Vec3d eye, right, up, back;
    double scale = 1;     ///< pixels per unit of length at depth 1
    double perPixel = 1;  ///< 1 / scale
    int width = 0, height = 0;

    /// The ray through a picture position, of depth 1.
    Vec3d toward(double x, double y) const {
        return ((x - 0.5 * width) * perPixel) * right + ((0.5 * height - y) * perPixel) * up - back;
    }
    /// A point in camera coordinates: right, up and depth, from the eye.
    Vec3d seen(const Vec3d& p) const {
        const Vec3d r = p - eye;
        return {dot(r, right), dot(r, up), -dot(r, back)};
    }
    /// The picture position of a camera point of depth > 0.
    std::array<double, 2> place(const Vec3d& s) const {
        return {0.5 * width + scale * s.x / s.z, 0.5 * height - scale * s.y / s.z};
    }
};

/// The visible triangle at a picture position.
struct Sample {
    float depth = std::numeric_limits<float>::infinity();
    std::uint32_t triangle = SurfaceTriangles::kNone;

    bool covered() const { return triangle != SurfaceTriangles::kNone; }
};

/// Triangles sorted into tiles of the picture, so that threads draw tiles independently.
///
/// A sample shows the first triangle on its ray; on ties the first in the list. Visibility uses
/// edge functions of the ray itself (M. Olano and T. Greer, Triangle scan conversion using 2D
/// homogeneous coordinates, 1997), so no clipping is needed. An edge belongs to both of its
/// triangles.
class Raster {
public:
    static constexpr int kTile = 32;  ///< pixels along a side
    using Offset = std::array<double, 2>;

    Raster(const SurfaceTriangles& triangles, const Frame& frame);

    std::size_t tiles() const { return std::size_t(across_) * std::size_t(down_); }
    /// The upper left pixel.
    std::array<int, 2> origin(std::size_t tile) const {
        return {int(tile) % across_ * kTile, int(tile) / across_ * kTile};
    }
    std::size_t tileOf(int x, int y) const { return std::size_t(y / kTile * across_ + x / kTile); }

    /// The samples of a tile, at `offsets` from the corner of each pixel: that of pixel (x, y) in
    /// the tile and offset k comes at (y * kTile + x) * offsets.size() + k.
    /// @param wanted  per pixel of the tile, whether it is drawn; empty: all
    void draw(std::size_t tile, const std::vector<Offset>& offsets,
              const std::vector<std::uint8_t>& wanted, std::vector<Sample>& samples) const;

    /// Barycentric coordinates where the ray `toward` meets the plane of a triangle.
    std::array<double, 3> shares(std::uint32_t triangle, const Vec3d& toward) const;

private:
    struct Box {
        double left = 1e30, top = 1e30, right = -1e30, bottom = -1e30;
    };
    Box boxOf(std::size_t triangle) const;

    const SurfaceTriangles& triangles_;
    const Frame& frame_;
    int across_, down_;
    std::vector<std::size_t> first_;  ///< per tile: first of its triangles in the list
    std::vector<std::uint32_t> list_;
};

}  // namespace igeo
