/// The point of a triangle nearest to a given point, and the distance to a segment.
#pragma once

#include <igeo/base/types.h>

#include <algorithm>

namespace igeo {

/// The point of a triangle nearest to p, and the part of the triangle it lies on.
struct NearestOnTriangle {
    Vec3d point;
    /// 0, 1, 2: corner; 3, 4, 5: edge from corner k - 3 to the next; 6: inside.
    int feature = 6;
};

/// A triangle, prepared for queries at many positions.
struct TriangleCorners {
    Vec3d a, b, c;
    Vec3d ab, ac;
    bool flat;  ///< without area

    TriangleCorners(const Vec3d& pa, const Vec3d& pb, const Vec3d& pc)
        : a(pa), b(pb), c(pc), ab(b - a), ac(c - a) {
        const Vec3d area = cross(ab, ac);
        const double l2 = longest2();
        flat = !(dot(area, area) > 1e-20 * l2 * l2);
    }
    /// The same as nearestOnTriangle.
    NearestOnTriangle nearest(const Vec3d& p) const;

private:
    double longest2() const { return std::max({dot(ab, ab), dot(ac, ac), dot(c - b, c - b)}); }
    NearestOnTriangle nearestOfFlat(const Vec3d& p) const;
};

/// By the regions of C. Ericson, Real-Time Collision Detection (2005), 5.1.5. A triangle without
/// area is replaced by its longest edge.
inline NearestOnTriangle nearestOnTriangle(const Vec3d& p, const Vec3d& a, const Vec3d& b,
                                           const Vec3d& c) {
    return TriangleCorners(a, b, c).nearest(p);
}

/// The distance of p from the segment from a to b, which may be a point.
inline double distanceToSegment(const Vec3d& p, const Vec3d& a, const Vec3d& b) {
    const Vec3d along = b - a;
    const double square = dot(along, along);
    const double t = square > 0 ? std::clamp(dot(p - a, along) / square, 0.0, 1.0) : 0;
    return length(p - a - t * along);
}

inline NearestOnTriangle TriangleCorners::nearest(const Vec3d& p) const {
    if (flat) return nearestOfFlat(p);
    const Vec3d ap = p - a;
    const double d1 = dot(ab, ap), d2 = dot(ac, ap);
    if (d1 <= 0 && d2 <= 0) return {a, 0};
    const Vec3d bp = p - b;
    const double d3 = dot(ab, bp), d4 = dot(ac, bp);
    if (d3 >= 0 && d4 <= d3) return {b, 1};
    const Vec3d cp = p - c;
    const double d5 = dot(ab, cp), d6 = dot(ac, cp);
    if (d6 >= 0 && d5 <= d6) return {c, 2};
    const double vc = d1 * d4 - d3 * d2, vb = d5 * d2 - d1 * d6, va = d3 * d6 - d5 * d4;
    const double sum = va + vb + vc;
    if (vc <= 0 && d1 >= 0 && d3 <= 0) return {a + (d1 / (d1 - d3)) * ab, 3};
    if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0)
        return {b + ((d4 - d3) / ((d4 - d3) + (d5 - d6))) * (c - b), 4};
    if (vb <= 0 && d2 >= 0 && d6 <= 0) return {a + (d2 / (d2 - d6)) * ac, 5};
    return {a + (vb / sum) * ab + (vc / sum) * ac, 6};
}

}  // namespace igeo
