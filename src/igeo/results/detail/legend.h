/// What the colors of a picture mean. Internal.
#pragma once

#include <igeo/march/field.h>
#include <igeo/results/color_map.h>
#include <igeo/results/detail/canvas.h>
#include <igeo/results/picture_options.h>

#include <algorithm>
#include <cmath>

namespace igeo {

// In linear light.
const Vec3d kInk{0.012, 0.014, 0.02};
const Vec3d kUnreached{0.48, 0.48, 0.48};

/// Distances and what they look like: in voxels times weight.
struct Scale {
    ColorMap colors;
    double low = 0, high = 0;
    double spacing = 0;  ///< of isolines; 0: none

    Scale(const Field& field, double dx, const PictureOptions& options);
    Vec3d color(double d) const { return colors(high > low ? (d - low) / (high - low) : 0); }
    /// Of an isoline on a color: white on dark ones, black on light ones, both tinted.
    static Vec3d lineOn(const Vec3d& c) {
        constexpr double kMiddle = 0.18;  // luminance that black and white stand out from alike
        const bool dark = dot(c, {0.2126, 0.7152, 0.0722}) < kMiddle;
        return dark ? 0.3 * c + Vec3d{0.7, 0.7, 0.7} : 0.12 * c;
    }
    /// The number of the isoline below d.
    int step(double d) const {
        return spacing > 0 && d < kInfinity ? int(std::min(d / spacing, 1e9)) : -1;
    }
    /// How far d is from the next isoline; there is none at the start.
    double fromIsoline(double d) const {
        const double level = std::round(d / spacing) * spacing;
        return level > low && level <= high ? std::abs(d - level) : kInfinity;
    }
};

/// The color bar and its words, at the right edge.
class Legend {
public:
    /// No legend where it would take more than a third of the width, or is not wanted.
    Legend(const Scale& scale, const Field& field, double dx, const PictureOptions& options);
    /// Pixels of the picture's width that it takes.
    int taken() const { return shown_ ? width() : 0; }

    void draw(Canvas& canvas) const;

private:
    static constexpr int kBar = 14, kWidth = 84;  ///< in units

    int width() const { return kWidth * unit_; }
    double atRow(double j) const { return scale_.high - (scale_.high - scale_.low) * j / height_; }

    void drawTicks(Canvas& canvas, int x, int y) const;

    const Scale& scale_;
    double dx_;
    bool hasUnreached_, weighted_, shown_ = false;
    int unit_, height_;  ///< pixels per pixel of the font; of the bar
};

}  // namespace igeo
