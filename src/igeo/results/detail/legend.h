/// The legend of a picture's colors. Internal.
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

/// Distances and their colors; in voxels times weight.
struct Scale {
    ColorMap colors;
    double low = 0, high = 0;
    std::vector<double> levels;  ///< of isolines, ascending

    Scale(const Field& field, const PictureOptions& options);
    double share(double d) const { return high > low ? (d - low) / (high - low) : 0; }
    double atShare(double s) const { return low + s * (high - low); }
    Vec3d color(double d) const { return colors(share(d)); }
    /// The color of an isoline over a color: white on dark, black on light, both tinted.
    static Vec3d lineOn(const Vec3d& c) {
        constexpr double kMiddle = 0.18;  // luminance with the same contrast to black and white
        const bool dark = dot(c, {0.2126, 0.7152, 0.0722}) < kMiddle;
        return dark ? 0.3 * c + Vec3d{0.7, 0.7, 0.7} : 0.12 * c;
    }
    /// The distance from d to the nearest isoline's level; +infinity without isolines.
    /// @param above  the first level that is not below the last d, and then below this one; the
    ///               search starts there
    double fromIsoline(double d, std::size_t& above) const;
};

/// The color bar and its text, at the right edge.
class Legend {
public:
    /// No legend if it would take more than a third of the width, or is switched off.
    Legend(const Scale& scale, const Field& field, const PictureOptions& options);
    /// The part of the picture's width that it takes, pixels.
    int taken() const { return shown_ ? width_ : 0; }

    /// @param ink  color of text and lines
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
    int height_, width_ = 0;  ///< pixels: of the bar; of the whole legend
};

}  // namespace igeo
