/// Colors for numbers from 0 to 1.
#pragma once

#include <igeo/base/types.h>

#include <string>
#include <vector>

namespace igeo {

/// Gamma-encoded sRGB of a color in linear light, components clamped to [0, 1].
Vec3d srgbFromLinear(const Vec3d& linear);

/// A color map: an arc in the polar form of Oklab (B. Ottosson, "A perceptual color space for
/// image processing", 2020), where equal steps look equal. Lightness rises and hue turns linearly,
/// chroma is a parabola; so every map reads in gray, too, and none has the false edges of a
/// rainbow.
class ColorMap {
public:
    /// @throws Error  InvalidArgument for a name that is not among names()
    explicit ColorMap(const std::string& name);

    /// The color for t, clamped to [0, 1], in linear light. O(1), from a table.
    Vec3d operator()(double t) const;

    /// The maps there are; the first is the default.
    static std::vector<std::string> names();

private:
    std::vector<Vec3d> table_;
};

}  // namespace igeo
