/// Paths over the triangles of a mesh. Internal to the paths.
#pragma once

#include <igeo/base/progress.h>
#include <igeo/march/field.h>
#include <igeo/path/path.h>

#include <vector>

namespace igeo {

/// Computes the lengths of a path and of its vertices from their positions.
/// @return per vertex: the weighted length up to it
std::vector<double> measure(const Field& field, Path& path);

/// Adds vertices so that all of a path lies on the triangles of its band: each segment becomes the
/// locally shortest curve over them. A segment stays as it is if they do not join its ends nearby.
/// Sets the lengths.
/// @return whether they join the ends of all segments
bool layOnTriangles(const Field& field, Path& path);

/// Whether shortest curves are exact: over triangles of constant cost, without obstacles.
bool hasExactCurves(const Field& field);

/// The locally shortest curve over the triangles near a path, in steps of a voxel at most.
/// @param winds  keep the loops of the path around the surface
/// @throws Error  Cancelled
std::vector<Vec3d> shortestOnTriangles(const SurfaceTriangles& triangles, const Path& path,
                                       const Progress& progress, bool winds = false);

}  // namespace igeo
