/// Colors for numbers from 0 to 1.
#pragma once

#include <igeo/base/types.h>

#include <string>
#include <vector>

namespace igeo {

/// Gamma-encoded sRGB of a color in linear light, components clamped to [0, 1].
Vec3d srgbFromLinear(const Vec3d& linear);

/// A published color map: viridis, magma and cividis, whose lightness rises evenly, so that they
/// are readable in gray and with color blindness; turbo, a rainbow that separates more values and
/// is dark at both ends; gray.
class ColorMap {
public:
    /// @throws Error  InvalidArgument for a name that is not among names()
    explicit ColorMap(const std::string& name);

    /// The color for t, clamped to [0, 1], in linear light. O(1), from a table.
    Vec3d operator()(double t) const;

    /// The available maps; the first is the default.
    static std::vector<std::string> names();

private:
    std::vector<Vec3d> table_;
};

}  // namespace igeo
