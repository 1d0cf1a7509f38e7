/// Pixels with simple drawing: rectangles, text, PNG.
#pragma once

#include <igeo/base/types.h>
#include <igeo/results/detail/font.h>

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

    /// @param alpha  of the pixel; the color is not multiplied with it
    void set(int x, int y, const Vec3f& linear, float alpha = 1);
    /// Fills width x height pixels from (x, y) on.
    void fill(int x, int y, int width, int height, const Vec3d& linear, double alpha = 1);
    /// Draws a text that starts at (x, y) on its base line, over the pixels there.
    void text(const Font& font, double x, double y, const std::string& text, const Vec3d& linear);

    /// A PNG file, marked as sRGB, with alpha where a pixel is not opaque; the same bytes for the
    /// same pixels.
    std::string png() const;

private:
    std::uint8_t* at(int x, int y) {
        return &rgba_[4 * (std::size_t(y) * std::size_t(width_) + std::size_t(x))];
    }
    bool isOpaque() const;
    bool holds(int x, int y) const { return x >= 0 && y >= 0 && x < width_ && y < height_; }

    int width_, height_;
    std::vector<std::uint8_t> rgba_;
};

}  // namespace igeo
