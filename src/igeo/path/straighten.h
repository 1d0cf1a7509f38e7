/// Geodesics that depend on surface and metric alone: paths relaxed to locally shortest curves.
#pragma once

#include <igeo/path/trace.h>

namespace igeo {

/// Moves the interior vertices of a path to a curve on S with the same ends that is locally
/// shortest in the field's metric, and clear of its obstacles.
///
/// On a mesh without weights or obstacles that is a curve from edge to edge over its triangles,
/// exact to rounding (shortestCurve). Elsewhere it resamples the path to steps of about half a
/// voxel, then repeats: Newton's equation for the
/// sideways shifts s (first variation of length; tridiagonal; without a weight s'' = -kappa_g),
/// shift, project to S. The error of the march is gone afterwards. What is left is psi as
/// read by trilinear interpolation, whose zero set lies inside convex parts: on a sphere of R
/// voxels lengths are 1 / (6 R^2) short, and over a sharp edge some tenths of a voxel. Where a
/// vertex would come into an obstacle it stays, so that paths lie along obstacles to within a
/// fraction of a voxel. Paths that are not Reached are left alone. The distances of the vertices
/// become lengths to the seed along the curve. Time O(length), some 10 rounds, more with weights
/// and obstacles (40 at most). The length never grows.
/// @throws Error  Cancelled, looked at before each round; the path is then as it was
void straighten(const Field& field, Path& path, Progress& progress = Progress::none());

/// The same for a curve that may be far from shortest, as one through points: it is relaxed as a
/// whole to the locally shortest curve that it can be moved to on S with its ends fixed, loops
/// around S included. The vertices' distances become lengths from its start by the metric.
/// @param closed  the last vertex repeats the first, and no vertex is fixed: pieces of the curve
///                are relaxed in turn (Birkhoff's curve shortening) until none gets shorter
/// @return false where a closed curve contracts to a point: there is no closed geodesic. The path
///         is then without use
/// @throws Error  Cancelled
/// Time O(length), times the voxels that the curve is moved by; on a mesh times the triangles that
/// it is moved over.
bool straightenWhole(const Field& field, Path& path, bool closed,
                     Progress& progress = Progress::none());

}  // namespace igeo
