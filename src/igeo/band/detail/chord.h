/// Chords between points of S. Internal to the band and to what reads fields.
#pragma once

#include <igeo/band/band.h>

#include <algorithm>
#include <cmath>

namespace igeo {

/// Whether |psi| is at most `most` at the points that divide a chord into parts.
bool staysNearPsi(const Band& band, const Vec3d& from, const Vec3d& chord, int parts, double most);

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
