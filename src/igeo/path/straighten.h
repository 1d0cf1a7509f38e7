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

}  // namespace igeo
