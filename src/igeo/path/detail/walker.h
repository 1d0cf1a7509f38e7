/// Steps of a geodesic on S, given by the nodes of a band. Internal to the paths.
#pragma once

#include <igeo/band/band.h>

#include <algorithm>

namespace igeo {

/// S around a point, from the foot points f and normals m of the nodes of its cell.
struct Local {
    bool valid = false;  ///< false beyond the edge of the band
    /// Mean of (p - f) . (m + n) / 2, n the mean normal: the height of p above S, exact on spheres.
    double height = 0;
    /// The gradient of the height, unit. Not n: a path stays straight only with the normal of the
    /// surface that it is projected to.
    Vec3d normal;
};

Local localSurface(const Band& band, const Vec3d& p, const Vec3d& sheetNormal);

/// A point of a geodesic, with its unit velocity and the normal of S.
struct Walker {
    Vec3d p, v, n;
    double at = 0;  ///< length so far, voxels

    /// Moves by an arc of the given length on the surface that surface(p, n) returns as a Local;
    /// false where S ends.
    template <typename Surface>
    bool step(const Surface& surface, double arc);
};

template <typename Surface>
bool Walker::step(const Surface& surface, double arc) {
    constexpr int kRounds = 8;
    constexpr double kOnSurface = 1e-9;
    // The chord in the plane of v and n that ends on S.
    Vec3d chord = arc * v;
    Local here = surface(p + chord, n);
    for (int round = 0; round < kRounds && here.valid; ++round) {
        const Vec3d bend = here.normal - n;
        const double slope = std::max(dot(n, here.normal), 0.5);
        const Vec3d next =
            arc * (1 - dot(bend, bend) / 24) * normalized(chord - (here.height / slope) * n);
        const double change = length(next - chord);
        chord = next;
        here = surface(p + chord, n);
        if (change < kOnSurface) break;
    }
    const Vec3d along = tangential(chord, here.normal);
    if (!here.valid || !(length(along) > 0)) return false;
    at += arc;
    p += chord;
    n = here.normal;
    v = normalized(along);
    return true;
}

}  // namespace igeo
