#include <igeo/path/curve_normals.h>

#include <igeo/base/nearest_on_triangle.h>
#include <igeo/path/detail/walker.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace igeo {

namespace {

using Place = SurfaceTriangles::Place;

constexpr double kAlmostOn = 1e-6;  // voxels: a point this close is on an edge or a vertex

/// Whether a triangle has no certain plane: a vertex lies in its edge, but for rounding.
bool isNarrow(const SurfaceTriangles& triangles, std::uint32_t t, double width) {
    const Vec3d ab = triangles.corner(t, 1) - triangles.corner(t, 0),
                ac = triangles.corner(t, 2) - triangles.corner(t, 0);
    return !(length(cross(ab, ac)) > width * std::max({length(ab), length(ac), length(ac - ab)}));
}

/// The sum of the normals at a point, weighted by the angles that triangles have there, over edges
/// that join two. Narrow triangles do not count, and the point is on both sides of them.
/// @param t  the triangle of the point
Vec3d sumAround(const SurfaceTriangles& triangles, std::uint32_t t, const Vec3d& p) {
    constexpr double kNarrow = 1e-4, kPi = std::numbers::pi;  // voxels
    constexpr std::size_t kMost = 1000;
    std::vector<std::uint32_t> around{t};
    Vec3d sum;
    for (std::size_t i = 0; i < around.size() && i < kMost; ++i) {
        const std::uint32_t u = around[i];
        const bool narrow = isNarrow(triangles, u, kNarrow);
        double angle = kPi;
        for (unsigned k = 0; k < 3; ++k) {
            const Vec3d a = triangles.corner(u, k), b = triangles.corner(u, k + 1);
            if (length(p - a) <= kAlmostOn) angle = triangles.angle(u, k);
            if (distanceToSegment(p, a, b) > (narrow ? kNarrow : kAlmostOn)) continue;
            const auto beyond = triangles.beyond({u, k});
            if (beyond && std::find(around.begin(), around.end(), beyond->triangle) == around.end())
                around.push_back(beyond->triangle);
        }
        if (!narrow) sum += angle * triangles.normal(u);
    }
    return sum;
}

Vec3d normalOnTriangles(const SurfaceTriangles& triangles, const Vec3d& p,
                        const Vec3d& sheetNormal) {
    constexpr double kFarthest = 2, kCancelled = 0.1;
    Place at = triangles.nearest(p, kFarthest, sheetNormal);
    // Beyond a sharp edge the normal may be opposite to the last one.
    if (at.squared > kAlmostOn * kAlmostOn)
        if (const Place any = triangles.nearest(p, kFarthest); any.squared <= kAlmostOn * kAlmostOn)
            at = any;
    if (at.triangle == SurfaceTriangles::kNone) return sheetNormal;
    const Vec3d sum = sumAround(triangles, at.triangle, at.point);
    return length(sum) > kCancelled ? normalized(sum) : triangles.normal(at.triangle);
}

}  // namespace

Vec3d normalAt(const Band& band, const Vec3d& p, const Vec3d& sheetNormal) {
    if (band.triangles) return normalOnTriangles(*band.triangles, p, sheetNormal);
    const Local here = localSurface(band, p, sheetNormal);
    const Vec3d n = here.valid ? here.normal : surfaceNormal(band, p);
    return n != Vec3d{} ? n : sheetNormal;
}

void addNormals(const Band& band, Path& path, const Vec3d& sheetNormal) {
    Vec3d sheet = sheetNormal;
    if (sheet == Vec3d{} && path.target.node != kNoNode)
        sheet = Vec3d(band.normal[path.target.node]);
    for (PathVertex& v : path.vertices) v.normal = sheet = normalAt(band, v.pIndex, sheet);
}

}  // namespace igeo
