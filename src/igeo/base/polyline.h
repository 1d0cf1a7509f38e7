/// Curves in space.
#pragma once

#include <igeo/base/types.h>

#include <vector>

namespace igeo {

/// A polyline in space.
struct Curve {
    std::vector<Vec3d> points;
    bool closed = false;  ///< the last point is joined to the first
    double start = 0;     ///< distance at which its front starts
};

}  // namespace igeo
