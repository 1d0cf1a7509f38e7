#include <igeo/base/nearest_on_triangle.h>

namespace igeo {

namespace {

NearestOnTriangle nearestOnSegment(const Vec3d& p, const Vec3d& a, const Vec3d& b, int cornerA,
                                   int cornerB, int edge) {
    const Vec3d e = b - a;
    const double l2 = dot(e, e), t = l2 > 0 ? dot(p - a, e) / l2 : 0;
    if (t <= 0) return {a, cornerA};
    if (t >= 1) return {b, cornerB};
    return {a + t * e, edge};
}

}  // namespace

NearestOnTriangle TriangleCorners::nearestOfFlat(const Vec3d& p) const {
    const double l2 = longest2();
    if (l2 == dot(ab, ab)) return nearestOnSegment(p, a, b, 0, 1, 3);
    if (l2 == dot(ac, ac)) return nearestOnSegment(p, c, a, 2, 0, 5);
    return nearestOnSegment(p, b, c, 1, 2, 4);
}

}  // namespace igeo
