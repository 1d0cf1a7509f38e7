/// What the pixels of a picture show. Internal to the pictures.
#pragma once

#include <igeo/results/detail/raster.h>

#include <cstdint>
#include <memory>
#include <vector>

namespace igeo {

/// What is seen at the middle of each pixel, in camera coordinates. Rows of floats, with pixels of
/// the background around the picture, so that neighbors and registers of pixels need no test.
struct SeenPixels {
    static constexpr int kPad = 8;

    int width, height;
    std::size_t stride;                   ///< from one row to the next
    double perPixel;                      ///< as in Frame
    std::vector<float> depth;             ///< +infinity: background, without other values
    std::unique_ptr<float[]> nx, ny, nz;  ///< unit normal, on either side of the surface
    std::unique_ptr<float[]> distance;    ///< +infinity: unreached
    std::vector<float> towardX, towardY;  ///< the rays (Frame::toward), per column and row

    explicit SeenPixels(const Frame& frame);

    std::size_t index(int x, int y) const {
        return std::size_t(y + 1) * stride + std::size_t(x + kPad);
    }
    bool covered(std::size_t i) const { return depth[i] < std::numeric_limits<float>::infinity(); }
    Vec3f toward(int x, int y) const {
        return {towardX[std::size_t(x + kPad)], towardY[std::size_t(y)], 1};
    }
    Vec3f place(int x, int y) const { return depth[index(x, y)] * toward(x, y); }
    Vec3f normal(std::size_t i) const { return {nx[i], ny[i], nz[i]}; }
};

/// Differences of the pixels of a row from their neighbors.
struct RowEdges {
    /// Per pixel, not 0: it and one of its four neighbors show different parts: surface and
    /// background, reached and unreached, one behind the other, or two sides of a crease.
    std::unique_ptr<std::int32_t[]> edge;
    std::unique_ptr<float[]> slope;  ///< of the distance, per pixel of the surface, over the others

    RowEdges(const SeenPixels& seen, int y);
};

}  // namespace igeo
