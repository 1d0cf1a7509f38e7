#include <igeo/path/curve_normals.h>

#include <igeo/path/detail/walker.h>

#include <cmath>

namespace igeo {

namespace {

using Side = SurfaceTriangles::Side;
using Place = SurfaceTriangles::Place;

constexpr double kAlmostOn = 1e-6;  // voxels: a point this close is on an edge or a vertex

/// The corner of a triangle at a point; 3: none.
unsigned cornerAt(const SurfaceTriangles& triangles, std::uint32_t t, const Vec3d& p) {
    unsigned k = 0;
    while (k < 3 && length(triangles.corner(t, k) - p) > kAlmostOn) ++k;
    return k;
}

/// The edge of a triangle at a point, as its first corner; 3: none.
unsigned edgeAt(const SurfaceTriangles& triangles, std::uint32_t t, const Vec3d& p) {
    unsigned k = 0;
    for (; k < 3; ++k) {
        const Vec3d a = triangles.corner(t, k), e = triangles.corner(t, k + 1) - a;
        if (length(cross(e, p - a)) <= kAlmostOn * length(e)) break;
    }
    return k;
}

/// A triangle's normal times its angle at a corner.
Vec3d byAngle(const SurfaceTriangles& triangles, std::uint32_t t, unsigned corner) {
    return triangles.angle(t, corner) * triangles.normal(t);
}

/// The sum around a vertex, in both directions from one of its triangles, across edges that join
/// two.
Vec3d sumAround(const SurfaceTriangles& triangles, std::uint32_t t, unsigned corner) {
    constexpr int kMost = 10000;
    const std::uint32_t vertex = triangles[t][corner];
    Vec3d sum = byAngle(triangles, t, corner);
    for (const unsigned first : {corner, (corner + 2) % 3}) {
        Side side{t, first};
        for (int k = 0; k < kMost; ++k) {
            const auto beyond = triangles.beyond(side);
            if (!beyond) break;
            if (beyond->triangle == t) return sum;
            const SurfaceTriangles::Triangle& next = triangles[beyond->triangle];
            const unsigned at = next[0] == vertex ? 0 : next[1] == vertex ? 1 : 2;
            sum += byAngle(triangles, beyond->triangle, at);
            side = {beyond->triangle, beyond->corner == at ? (at + 2) % 3 : at};
        }
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
    const Vec3d own = triangles.normal(at.triangle);
    Vec3d sum = own;
    if (const unsigned corner = cornerAt(triangles, at.triangle, at.point); corner < 3) {
        sum = sumAround(triangles, at.triangle, corner);
    } else if (const unsigned edge = edgeAt(triangles, at.triangle, at.point); edge < 3) {
        if (const auto beyond = triangles.beyond({at.triangle, edge}))
            sum += triangles.normal(beyond->triangle);
    }
    return length(sum) > kCancelled ? normalized(sum) : own;
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
