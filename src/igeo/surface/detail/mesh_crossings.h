/// Faces of a triangle mesh that pass through each other.
#pragma once

#include <igeo/base/progress.h>
#include <igeo/io/triangle_mesh.h>

#include <cstddef>

namespace igeo {

/// What is counted at most: a polygon of 10,000 corners may have a hundred million crossings.
constexpr std::size_t kMostCrossingPairs = 1'000'000;

/// The pairs of triangles, as they were before splitAtJunctions(), that cross, or overlap in one
/// plane; kMostCrossingPairs where there are that many or more.
///
/// Two triangles cross where no axis separates them: along each of the normals and the products of
/// two edges (separating axes) they overlap by more than `tolerance`. So triangles that only touch
/// do not cross, such as neighbors along an edge or around a point. Triangles without area are
/// ignored.
/// @param tolerance  in the file's units; smaller crossings may be missed
/// @throws Error  Cancelled through `progress`
/// Time O(n log n + pairs whose boxes meet), in parallel; 30 bytes per triangle.
std::size_t crossingPairs(const TriangleMesh& mesh, double tolerance,
                          const Progress& progress = Progress::none());

}  // namespace igeo
