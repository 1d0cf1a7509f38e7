/// Points that fronts start from.
#pragma once

#include <igeo/base/types.h>

namespace igeo {

/// A seed, or a target whose start has no effect, before it is put on the surface.
struct Seed {
    Vec3d position;    ///< world or index space, as the caller says
    double start = 0;  ///< distance there, world units times weight, >= 0

    Seed() = default;
    Seed(const Vec3d& p, double startAt = 0) : position(p), start(startAt) {}
    Seed(double x, double y, double z, double startAt = 0) : position(x, y, z), start(startAt) {}
};

}  // namespace igeo
