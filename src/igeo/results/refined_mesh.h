/// The mesh a band was made from, fine enough to carry the distance.
#pragma once

#include <igeo/io/triangle_mesh.h>
#include <igeo/results/surface_mesh.h>

namespace igeo {

/// The input mesh in index space, its triangles oriented alike (orientConsistently), without
/// values.
SurfaceMesh meshAsGiven(const TriangleMesh& mesh, const Similarity& transform);

/// The input mesh with distance, label and normal at its corners, as surfaceMesh() is for a level
/// set; also for meshes that are open.
///
/// Edges longer than `longest` are halved until none is, at one point for the triangles on both
/// sides, so that no crack opens. Triangles are oriented alike first (orientConsistently).
/// @param field    on a band of this mesh
/// @param longest  voxels, > 0
/// @throws Error  InvalidArgument for `longest` out of range or more than 2^31 triangles; Cancelled
///         through `progress`
/// Time O(n log n) per halving. Order and bits do not depend on the number of threads.
SurfaceMesh refinedMesh(const TriangleMesh& mesh, const Field& field, double longest = 1,
                        Progress& progress = Progress::none());

}  // namespace igeo
