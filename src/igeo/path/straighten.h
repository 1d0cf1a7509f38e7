/// Geodesics that depend on surface and metric alone: paths relaxed to locally shortest curves.
#pragma once

#include <igeo/base/progress.h>
#include <igeo/march/field.h>
#include <igeo/path/path.h>

namespace igeo {

/// Moves the interior vertices of a path to a curve on S with the same ends that is locally
/// shortest in the field's metric and clear of its obstacles.
///
/// On a mesh without weights or obstacles the curve passes from edge to edge over its triangles,
/// exact to rounding (shortestCurve). Elsewhere it resamples the path to steps of about half a
/// voxel and repeats: solve Newton's equation for the sideways shifts s (first variation of length;
/// tridiagonal; without a weight s'' = -kappa_g), shift, project to S. This removes the error of
/// the march. What remains is that of chords, 1 / (96 R^2) short on a sphere of R voxels, and that
/// of psi between voxels: over a sharp edge lengths are some tenths of a voxel short. A
/// vertex that would enter an obstacle stays, so paths follow obstacles to within a fraction of a
/// voxel. Paths that are not Reached are unchanged. The distances of the vertices become lengths to
/// the seed along the curve. Time O(length), some 10 rounds, more with weights and obstacles (100
/// at most). The length never grows.
/// @throws Error  Cancelled, tested before each round; the path is then unchanged
void straighten(const Field& field, Path& path, Progress& progress = Progress::none());

/// The curve that straighten makes of a path that is Reached: also of a rough one
/// (TraceOptions::rough), which its chords may make shorter than any curve on S. Its vertices have
/// no distance.
/// @throws Error  Cancelled
Path straightened(const Field& field, const Path& path, Progress& progress = Progress::none());

/// The same as straighten for a curve that may be far from shortest, such as one through points. It
/// is relaxed as a whole to the locally shortest curve that it can be moved to on S with its ends
/// fixed, so its loops around S remain. The vertices' distances become lengths from its start by
/// the metric.
/// @param closed  the last vertex repeats the first, and no vertex is fixed: parts of the curve are
///                relaxed in turn (Birkhoff's curve shortening) until none gets shorter
/// @return false where a closed curve contracts to a point, so that there is no closed geodesic;
///         the path is then useless
/// @throws Error  Cancelled
/// Time O(length), times the voxels that the curve moves; on a mesh times the triangles that it
/// moves over.
bool straightenWhole(const Field& field, Path& path, bool closed,
                     Progress& progress = Progress::none());

}  // namespace igeo
