/// Geodesics that depend on the surface alone: paths relaxed to locally shortest curves.
#pragma once

#include <igeo/trace.h>

namespace igeo {

/// Moves the interior vertices of a path to a locally shortest curve on S with the same ends.
///
/// Resamples the path to steps of about half a voxel, then repeats: solve s'' = -kappa_g for the
/// sideways shift s (the first variation of length; tridiagonal), shift, project to psi = 0. The
/// error of the march is gone afterwards. What is left is psi as read by trilinear interpolation,
/// whose zero set lies inside convex parts: on a sphere of R voxels lengths are 1 / (6 R^2) short,
/// and over a sharp edge some tenths of a voxel. Paths that are not Reached, and those of a
/// weighted field, are left alone. The distances of the vertices become lengths to the seed along
/// the curve. Time O(length), some 10 rounds. The length never grows.
void straighten(const Band& band, const Field& field, Path& path);

}  // namespace igeo
