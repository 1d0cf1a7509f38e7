/// Pixels with plain drawing: rectangles, text, PNG.
#pragma once

#include <igeo/base/types.h>
#include <igeo/results/detail/font.h>

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace igeo {

/// 8-bit sRGB with alpha, transparent at first. Colors come in linear light and x, y count from the
/// upper left; what lies outside the picture is cut off.
class Canvas {
public:
    Canvas(int width, int height);

    int width() const { return width_; }
    int height() const { return height_; }

    /// @param alpha  of the pixel; the color is not multiplied with it
    void set(int x, int y, const Vec3d& linear, double alpha = 1);
    /// Fills width x height pixels from (x, y) on.
    void fill(int x, int y, int width, int height, const Vec3d& linear, double alpha = 1);
    /// A text that begins at (x, y) on its base line, over what is there.
    void text(const Font& font, double x, double y, const std::string& text, const Vec3d& linear);

    /// As a PNG file, marked as sRGB, with alpha where a pixel is not opaque; the same bytes for
    /// the same pixels.
    std::string png() const;

private:
    std::uint8_t* at(int x, int y) {
        return &rgba_[4 * (std::size_t(y) * std::size_t(width_) + std::size_t(x))];
    }
    bool holds(int x, int y) const { return x >= 0 && y >= 0 && x < width_ && y < height_; }

    int width_, height_;
    std::vector<std::uint8_t> rgba_;
};

}  // namespace igeo
