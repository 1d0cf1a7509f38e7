/// The content and camera of a picture.
#pragma once

#include <igeo/base/types.h>

#include <optional>
#include <string>

namespace igeo {

/// The background. Text is white on black, else dark.
enum class Background { White, Black, Transparent };

struct PictureOptions {
    int width = 1280, height = 960;    ///< pixels, 1 to 16384
    std::string colorMap = "viridis";  ///< ColorMap::names()
    Background background = Background::White;
    int isolineCount = 0;  ///< chosenLevels(); 0: by spacing
    /// World units times weight; 0: a round one that gives 10 to 25 lines, negative: no lines
    double isolineSpacing = 0;
    bool legend = true;  ///< drawn if there is enough width
    std::string quantity = "distance",
                unit;             ///< in the legend, UTF-8 of Latin-1; no unit: world units
    std::optional<Vec3d> eye;     ///< world; none: chosen
    std::optional<Vec3d> lookAt;  ///< world; none: the middle of the surface
    Vec3d up{0, 1, 0};            ///< world
};

}  // namespace igeo
