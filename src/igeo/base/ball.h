/// Balls in space.
#pragma once

#include <igeo/base/types.h>

namespace igeo {

struct Ball {
    Vec3d center;
    double radius = 0;
};

}  // namespace igeo
