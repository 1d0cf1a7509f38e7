/// The mesh of a band, refined to carry the distance.
#pragma once

#include <igeo/io/triangle_mesh.h>
#include <igeo/results/surface_mesh.h>

namespace igeo {

/// The input mesh in index space, its triangles oriented consistently (orientConsistently), without
/// values.
SurfaceMesh meshAsGiven(const TriangleMesh& mesh, const Similarity& transform);

/// The input mesh with distance, label and normal at its corners, as surfaceMesh() gives for a
/// level set; open meshes too.
///
/// Edges longer than `longest` are halved until none is, at a point shared by the triangles on both
/// sides, so no crack opens. Triangles are first oriented consistently (orientConsistently).
/// @param field    on a band of this mesh
/// @param longest  voxels, > 0
/// @throws Error  InvalidArgument for `longest` out of range or more than 2^31 triangles; Cancelled
///         through `progress`
/// Time O(n log n) per halving. Order and bits do not depend on the number of threads.
SurfaceMesh refinedMesh(const TriangleMesh& mesh, const Field& field, double longest = 1,
                        Progress& progress = Progress::none());

}  // namespace igeo
