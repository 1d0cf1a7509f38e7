/// Faces of a triangle mesh that pass through each other.
#pragma once

#include <igeo/base/progress.h>
#include <igeo/io/triangle_mesh.h>

#include <cstddef>

namespace igeo {

/// The pairs of triangles that cross, or overlap in one plane.
///
/// Two triangles cross where no direction parts them: along each of the normals and the products
/// of two edges (separating axes) they reach into each other by more than `tolerance`. So triangles
/// that only touch do not, as neighbors along an edge or around a point. Triangles without area
/// have no effect.
/// @param tolerance  in the file's units; crossings of less may be missed
/// @throws Error  Cancelled through `progress`
/// Time O(n log n + pairs whose boxes meet), in parallel; 30 bytes per triangle.
std::size_t crossingPairs(const TriangleMesh& mesh, double tolerance,
                          const Progress& progress = Progress::none());

}  // namespace igeo
