/// Pixels with simple drawing: rectangles, text, PNG.
#pragma once

#include <igeo/base/detail/registers.h>
#include <igeo/base/types.h>
#include <igeo/results/detail/font.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace igeo {

/// 8-bit sRGB with alpha, initially transparent. Colors are given in linear light; x, y count from
/// the upper left. Drawing is clipped to the picture.
class Canvas {
public:
    Canvas(int width, int height);

    int width() const { return width_; }
    int height() const { return height_; }

    using Four = Registers<4>::Vector;
    /// Sets a pixel of the picture.
    /// @param linear  its color, not multiplied with alpha, and alpha
    IGEO_INLINE void set(int x, int y, const Four& linear) {
        storeLanes(bytesOf(linear), at(x, y));
    }
    /// Fills width x height pixels from (x, y) on.
    void fill(int x, int y, int width, int height, const Vec3d& linear, double alpha = 1);
    /// Draws a text that starts at (x, y) on its base line, over the pixels there.
    void text(const Font& font, double x, double y, const std::string& text, const Vec3d& linear);

    /// A PNG file, marked as sRGB, with alpha where a pixel is not opaque; the same bytes for the
    /// same pixels.
    std::string png() const;

private:
    using Bytes = std::array<std::uint8_t, 4>;
    static constexpr int kSteps = 1 << 14;  ///< of the table from linear light to bytes
    static const std::uint8_t* table();

    /// The nearest bytes, to a quarter of a step.
    IGEO_INLINE Bytes bytesOf(const Four& linear) const {
        constexpr Four kScale{kSteps, kSteps, kSteps, 255}, kOne{1, 1, 1, 1};
        const Four most = linear < kOne ? linear : kOne, inRange = most > 0 ? most : Four{};
        const auto k = __builtin_convertvector(kScale * inRange + 0.5f, Registers<4>::Integers);
        return {table_[k[0]], table_[k[1]], table_[k[2]], std::uint8_t(k[3])};
    }
    Bytes bytesOf(const Vec3d& linear, double alpha) const {
        return bytesOf(Four{float(linear.x), float(linear.y), float(linear.z), float(alpha)});
    }
    std::uint8_t* at(int x, int y) {
        return &rgba_[4 * (std::size_t(y) * std::size_t(width_) + std::size_t(x))];
    }
    bool isOpaque() const;
    bool holds(int x, int y) const { return x >= 0 && y >= 0 && x < width_ && y < height_; }

    const std::uint8_t* const table_ = table();
    int width_, height_;
    std::vector<std::uint8_t> rgba_;
};

}  // namespace igeo
