/// What the colors of a picture mean. Internal.
#pragma once

#include <igeo/march/field.h>
#include <igeo/results/color_map.h>
#include <igeo/results/detail/canvas.h>
#include <igeo/results/picture_options.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace igeo {

// In linear light.
const Vec3d kInk{0.012, 0.014, 0.02}, kWhite{1, 1, 1};
const Vec3d kUnreached{0.48, 0.48, 0.48};

/// Distances and what they look like: in voxels times weight.
struct Scale {
    ColorMap colors;
    double low = 0, high = 0;
    std::vector<double> levels;  ///< of isolines, ascending

    Scale(const Field& field, const PictureOptions& options);
    double share(double d) const { return high > low ? (d - low) / (high - low) : 0; }
    double atShare(double s) const { return low + s * (high - low); }
    Vec3d color(double d) const { return colors(share(d)); }
    /// Of an isoline on a color: white on dark ones, black on light ones, both tinted.
    static Vec3d lineOn(const Vec3d& c) {
        constexpr double kMiddle = 0.18;  // luminance that black and white stand out from alike
        const bool dark = dot(c, {0.2126, 0.7152, 0.0722}) < kMiddle;
        return dark ? 0.3 * c + Vec3d{0.7, 0.7, 0.7} : 0.12 * c;
    }
    /// How far d is from the nearest isoline; +infinity where there is none.
    double fromIsoline(double d) const;
};

/// The color bar and its words, at the right edge.
class Legend {
public:
    /// No legend where it would take more than a third of the width, or is not wanted.
    Legend(const Scale& scale, const Field& field, const PictureOptions& options);
    /// Pixels of the picture's width that it takes.
    int taken() const { return shown_ ? width_ : 0; }

    /// @param ink  of words and lines
    void draw(Canvas& canvas, const Vec3d& ink) const;

private:
    struct Tick {
        double d;  ///< voxels times weight
        std::string text;
    };
    void chooseTicks(double dx);
    void measure();
    int pixels(double units) const { return std::max(1, int(std::lround(units * unit_))); }
    void drawBar(Canvas& canvas, int x, int y, const Vec3d& ink) const;

    const Scale& scale_;
    double unit_;  ///< pixels; a 400th of the picture's shorter side, and at least one
    Font font_;
    std::vector<std::string> head_, foot_;
    std::vector<Tick> ticks_;
    bool hasUnreached_, shown_ = false;
    int height_, width_ = 0;  ///< pixels: of the bar, of everything
};

}  // namespace igeo
