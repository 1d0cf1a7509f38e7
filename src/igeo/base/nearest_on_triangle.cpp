#include <igeo/base/nearest_on_triangle.h>

#include <algorithm>

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

NearestOnTriangle nearestOnTriangle(const Vec3d& p, const Vec3d& a, const Vec3d& b,
                                    const Vec3d& c) {
    const Vec3d ab = b - a, ac = c - a, ap = p - a, area = cross(ab, ac);
    const double l2 = std::max({dot(ab, ab), dot(ac, ac), dot(c - b, c - b)});
    if (!(dot(area, area) > 1e-20 * l2 * l2)) {
        if (l2 == dot(ab, ab)) return nearestOnSegment(p, a, b, 0, 1, 3);
        if (l2 == dot(ac, ac)) return nearestOnSegment(p, c, a, 2, 0, 5);
        return nearestOnSegment(p, b, c, 1, 2, 4);
    }
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
