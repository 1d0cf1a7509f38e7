/// A picture in linear light, before its conversion to pixels. Internal to the pictures.
#pragma once

#include <igeo/results/detail/canvas.h>
#include <igeo/results/detail/marks.h>
#include <igeo/results/detail/seen_pixels.h>
#include <igeo/results/picture_options.h>

#include <vector>

namespace igeo {

/// Linear light, premultiplied by alpha.
struct Rgba {
    float r = 0, g = 0, b = 0, a = 0;

    Rgba() = default;
    Rgba(const Vec3d& color, double alpha)
        : r(float(color.x * alpha)),
          g(float(color.y * alpha)),
          b(float(color.z * alpha)),
          a(float(alpha)) {}
    /// Opaque.
    explicit Rgba(const Vec3f& color) : r(color.x), g(color.y), b(color.z), a(1) {}
    Rgba& operator+=(const Rgba& o) { return r += o.r, g += o.g, b += o.b, a += o.a, *this; }
    friend Rgba operator*(Rgba c, float s) { return c.r *= s, c.g *= s, c.b *= s, c.a *= s, c; }
    /// Draws a color over this one.
    void cover(const Vec3d& color, double alpha) {
        *this = *this * float(1 - alpha);
        *this += Rgba(color, alpha);
    }
    /// Blends a color in, by the square root of light; alpha is unchanged.
    void tint(const Vec3d& color, double share);
};

class Film {
public:
    Film(int width, int height)
        : width_(width), height_(height), pixels_(std::size_t(width) * std::size_t(height)) {}

    Rgba& at(int x, int y) {
        return pixels_[std::size_t(y) * std::size_t(width_) + std::size_t(x)];
    }
    const Rgba& at(int x, int y) const {
        return pixels_[std::size_t(y) * std::size_t(width_) + std::size_t(x)];
    }

    /// Draws an outline of the surface, a pixel wide, so that it differs from a background of its
    /// own color.
    void drawRim(const Vec3d& color);
    static constexpr double kFaint = 0.35;  ///< opacity of hidden parts

    /// Draws white lines with dark edges on the surface.
    /// @param core, edge  half widths; pixels
    /// @param strength    share of their color, by the square root of light, which is close to
    ///                    perception
    void drawStrokes(const Strokes& strokes, double core, double edge, double strength);
    /// Opaque where no pixel is in front of it, elsewhere faint.
    void drawDot(const Dot& dot, const Frame& frame, const SeenPixels& seen);
    /// Converts the picture to pixels over its background, at the left of the canvas.
    void develop(Background background, Canvas& canvas) const;

private:
    int width_, height_;
    std::vector<Rgba> pixels_;
};

}  // namespace igeo
