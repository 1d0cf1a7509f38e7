/// Chords between points of S. Internal to the band and to what reads fields.
#pragma once

#include <igeo/band/band.h>

#include <algorithm>
#include <cmath>

namespace igeo {

/// Whether |psi| is at most `most` at the points that divide a chord into parts.
bool staysNearPsi(const Band& band, const Vec3d& from, const Vec3d& chord, int parts, double most);

/// From one end of a chord to the edge of the planes at its ends, along the straight line over both
/// laid flat.
/// @param n, m  their unit normals, at an angle
inline Vec3d toEdgeOf(const Vec3d& chord, const Vec3d& n, const Vec3d& m) {
    const double cosine = dot(n, m), sine = std::sqrt(std::max(1 - cosine * cosine, 0.0));
    // From both ends to the edge, at right angles to it.
    const double here = dot(m, chord) / sine, there = dot(n, chord) / sine,
                 sum = std::abs(here) + std::abs(there);
    const Vec3d along = (1 / sine) * cross(n, m);
    const double share = sum > 0 ? std::abs(here) / sum : 0;
    return (here / sine) * (m - cosine * n) + (share * dot(along, chord)) * along;
}

/// The length of the straight line from one point to another over the edge of their planes, if S
/// runs along it: psi is small there. Else +infinity. For level sets.
/// @param n, nTo  unit normals of the planes
double overOneEdge(const Band& band, const Vec3d& from, const Vec3d& to, const Vec3d& n,
                   const Vec3d& nTo);

/// Whether a chord rises over a plane at its ends by more than any arc does that turns by up to 37
/// degrees: S leads from end to end over a step.
inline bool isOverStep(const Vec3d& chord, const Vec3d& n, const Vec3d& m) {
    constexpr double kSteepest = 0.35, kShort = 1;  // voxels; 0.32 on an arc of 37 degrees
    const double c = length(chord);
    return c > kShort && std::max(std::abs(dot(chord, n)), std::abs(dot(chord, m))) > kSteepest * c;
}

/// Whether a chord lies in the plane of one of its ends. Where psi rounds edges off, points beside
/// them are a little off the planes of both faces.
/// @param n  the unit normal there
/// @param off  as far off, where there are no triangles; voxels
inline bool liesInPlane(const Band& band, const Vec3d& chord, const Vec3d& n, double off = 0.1) {
    constexpr double kInPlane = 0.05;
    return std::abs(dot(n, chord)) < kInPlane * length(chord) + (band.triangles ? 0 : off);
}

/// Whether S, which bends between the ends of a chord, runs along it in the plane of one end: the
/// other lies on the edge. On level sets and points psi tells whether it does.
bool runsInPlane(const Band& band, const Vec3d& from, const Vec3d& chord, const Vec3d& n);

/// Whether S runs along the chord between two points of it: no wall or gap lies between, and S
/// leads from one to the other by a path at most a tenth longer. On a mesh the triangles decide;
/// elsewhere the middles of the chord and of its parts, each moved to psi = 0.
/// @param b  within some voxels of a; both may be some tenths of a voxel off S
bool followsSurface(const Band& band, const Vec3d& a, const Vec3d& b);

/// Whether psi shows a path from a point of S to a foot point near it, at most a fifth longer than
/// the chord, and the foot point lies on psi = 0, or nearly so. In the middle of a wall foot points
/// lie anywhere. For level sets and points.
bool psiJoins(const Band& band, const Vec3d& p, const Vec3d& foot);

}  // namespace igeo
