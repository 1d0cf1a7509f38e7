/// The point of a triangle nearest to another.
#pragma once

#include <igeo/base/types.h>

namespace igeo {

/// The point of a triangle nearest to p, and the part of the triangle it lies on.
struct NearestOnTriangle {
    Vec3d point;
    /// 0, 1, 2: corner; 3, 4, 5: edge from corner k - 3 to the next; 6: inside.
    int feature = 6;
};
/// By the regions of C. Ericson, Real-Time Collision Detection (2005), 5.1.5. Triangles without
/// area are taken as their longest edge.
NearestOnTriangle nearestOnTriangle(const Vec3d& p, const Vec3d& a, const Vec3d& b, const Vec3d& c);

}  // namespace igeo
