/// What a picture shows, and from where.
#pragma once

#include <igeo/base/types.h>

#include <optional>
#include <string>

namespace igeo {

struct PictureOptions {
    int width = 1280, height = 960;    ///< pixels, 1 to 16384
    std::string colorMap = "viridis";  ///< ColorMap::names()
    double isolineSpacing = 0;    ///< world units times weight; 0: a round one that gives 10 to
                                  ///< 25 lines, negative: no lines
    bool legend = true;           ///< where there is room for it
    std::optional<Vec3d> eye;     ///< world; none: chosen
    std::optional<Vec3d> lookAt;  ///< world; none: the middle of the surface
    Vec3d up{0, 1, 0};            ///< world
};

}  // namespace igeo
