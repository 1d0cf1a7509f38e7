/// Pixels with plain drawing: rectangles, text, PNG.
#pragma once

#include <igeo/base/types.h>

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace igeo {

/// 8-bit sRGB, black at first. Colors come in linear light and x, y count from the upper left; what
/// lies outside the picture is cut off.
class Canvas {
public:
    Canvas(int width, int height);

    int width() const { return width_; }
    int height() const { return height_; }

    void set(int x, int y, const Vec3d& linear);
    /// Fills width x height pixels from (x, y) on.
    void fill(int x, int y, int width, int height, const Vec3d& linear);
    /// Text of letters (shown small), digits and .,-+():/ in a font of its own, each of the font's
    /// pixels a square of scale x scale; the first one's upper left corner is (x, y).
    void text(int x, int y, const std::string& text, int scale, const Vec3d& linear);
    static constexpr int kDigitHeight = 7;  ///< of a digit; letters reach 2 below it

    /// As a PNG file, marked as sRGB; the same bytes for the same pixels.
    std::string png() const;

private:
    int width_, height_;
    std::vector<std::uint8_t> rgb_;
};

}  // namespace igeo
