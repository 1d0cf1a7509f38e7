/// Points at which fronts start.
#pragma once

#include <igeo/base/types.h>

namespace igeo {

/// A seed before it is moved onto the surface; also a target, whose `start` has no effect.
struct Seed {
    Vec3d position;    ///< world or index space, as the caller says
    double start = 0;  ///< distance there, world units times weight, >= 0

    Seed() = default;
    Seed(const Vec3d& p, double startAt = 0) : position(p), start(startAt) {}
    Seed(double x, double y, double z, double startAt = 0) : position(x, y, z), start(startAt) {}
};

}  // namespace igeo
