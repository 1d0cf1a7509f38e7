/// Visible triangles at the pixels of a picture. Internal to the pictures.
#pragma once

#include <igeo/band/surface_triangles.h>
#include <igeo/base/detail/registers.h>
#include <igeo/base/progress.h>

#include <array>
#include <limits>
#include <memory>
#include <vector>

namespace igeo {

/// A perspective camera in index space with unit axes; pixels count from the upper left.
///
/// Camera coordinates: to the right, up, and in depth, from the eye.
struct Frame {
    Vec3d eye, right, up, back;
    double scale = 1;     ///< pixels per unit of length at depth 1
    double perPixel = 1;  ///< 1 / scale
    int width = 0, height = 0;

    /// The ray through a picture position, of depth 1, in camera coordinates.
    Vec3d toward(double x, double y) const {
        return {(x - 0.5 * width) * perPixel, (0.5 * height - y) * perPixel, 1};
    }
    /// A direction in camera coordinates, and back.
    Vec3d turned(const Vec3d& v) const { return {dot(v, right), dot(v, up), -dot(v, back)}; }
    Vec3d turnedBack(const Vec3d& v) const { return v.x * right + v.y * up - v.z * back; }
    /// A point in camera coordinates, and back.
    Vec3d seen(const Vec3d& p) const { return turned(p - eye); }
    Vec3d inSpace(const Vec3d& s) const { return eye + turnedBack(s); }
    /// The picture position of a camera point of depth > 0.
    std::array<double, 2> place(const Vec3d& s) const {
        return {0.5 * width + scale * s.x / s.z, 0.5 * height - scale * s.y / s.z};
    }
};

/// The visible triangles at four picture positions.
struct FourSamples {
    static constexpr std::size_t kLanes = 4;
    static constexpr float kFar = std::numeric_limits<float>::infinity();
    static constexpr std::uint32_t kNone = SurfaceTriangles::kNone;

    std::array<float, kLanes> depth{kFar, kFar, kFar, kFar};
    std::array<std::uint32_t, kLanes> triangle{kNone, kNone, kNone, kNone};
    std::array<float, kLanes> second{}, third{};  ///< barycentric coordinates of corners 1 and 2

    bool covered(std::size_t lane) const { return triangle[lane] != kNone; }
    bool anyCovered() const { return bitsOf<kLanes>(loadLanes<kLanes>(depth.data()) < kFar) != 0; }
};

/// Triangles sorted into tiles of the picture, so that threads draw tiles independently.
///
/// A sample shows the first triangle on its ray; on ties one that turns its front to the eye, and
/// the first of these. Visibility uses edge functions of the ray itself (M. Olano and T. Greer,
/// Triangle scan conversion using 2D homogeneous coordinates, 1997), so no clipping is needed. An
/// edge belongs to both of its triangles.
class Raster {
public:
    static constexpr int kTile = 32;  ///< pixels along a side
    static constexpr std::size_t kPixels = std::size_t(kTile) * kTile;
    /// Pixels of a tile: a bit for each, row by row.
    using Pixels = std::array<std::uint32_t, kTile>;
    /// Where samples are: the same in each group of kGroup pixels of a row, in so many registers.
    template <int kGroup, int kRegisters>
    struct PixelGroups {
        static constexpr int kPixels = kGroup;
        static constexpr std::size_t kPerGroup = kRegisters,
                                     kPerTile = Raster::kPixels / kGroup * kRegisters;
        using Lanes = std::array<double, FourSamples::kLanes>;

        std::array<Lanes, kRegisters> x, y;  ///< from the corner of the first pixel of a group
        float low, high;                     ///< of x and of y in each pixel
    };
    using Centers = PixelGroups<4, 1>;  ///< of pixels
    static Centers centers();
    static constexpr int kFiner = 3;  ///< per axis of a pixel
    using Finer = PixelGroups<1, 3>;  ///< kFiner^2 samples, and more that are of no use
    static Finer finer();

    /// @param withBacks  false: no sample shows a triangle that turns its back to the eye
    Raster(const SurfaceTriangles& triangles, bool withBacks, const Frame& frame);

    std::size_t tiles() const { return std::size_t(across_) * std::size_t(down_); }
    /// The upper left pixel.
    std::array<int, 2> origin(std::size_t tile) const {
        return {int(tile) % across_ * kTile, int(tile) / across_ * kTile};
    }
    std::size_t tileOf(int x, int y) const { return std::size_t(y / kTile * across_ + x / kTile); }
    bool isEmpty(std::size_t tile) const { return first_[2 * tile] == first_[2 * tile + 2]; }

    /// The samples of a tile, group by group, row by row.
    /// @param wanted   which pixels are drawn; samples of others have any value
    /// @param samples  Pattern::kPerTile
    template <typename Pattern>
    void draw(std::size_t tile, const Pattern& pattern, const Pixels& wanted,
              FourSamples* samples) const;

private:
    /// The part of the picture that a triangle covers, pixels, and its least depth.
    struct Box {
        float left, top, right, bottom, nearest;
    };
    struct Edges;
    template <typename Pattern>
    class Tile;
    Box boxOf(std::size_t triangle) const;
    std::array<Vec3d, 3> seen(std::size_t triangle) const {
        const auto& [i, j, k] = triangles_[triangle];
        return {corners_[i].at, corners_[j].at, corners_[k].at};
    }

    const SurfaceTriangles& triangles_;
    const Frame& frame_;
    int across_, down_;
    struct Corner {
        Vec3d at;    ///< camera coordinates
        float x, y;  ///< picture position; no number behind the eye
    };
    std::vector<Corner> corners_;   ///< per vertex
    std::unique_ptr<Box[]> boxes_;  ///< per triangle
    /// Per tile: first in the list of the triangles that turn their front to the eye, and of the
    /// others, which the former hide on closed surfaces.
    std::vector<std::size_t> first_;
    std::vector<std::uint32_t> list_;
};

}  // namespace igeo
