/// Weights given at the vertices of a mesh.
#pragma once

#include <igeo/band/band.h>
#include <igeo/base/progress.h>
#include <igeo/io/triangle_mesh.h>

#include <vector>

namespace igeo {

/// Values per vertex of the file as values per point of the mesh; of vertices merged into one point
/// the largest.
/// @param ofVertex  as many as the mesh's source has vertices, or the mesh points
/// @throws Error  InvalidArgument for another number of values
std::vector<double> valuesAtPoints(const TriangleMesh& mesh, const std::vector<double>& ofVertex);

/// The weight of every band node: that of its foot point, linear over each triangle.
/// @param ofPoint  per point of the mesh that the band was made of
/// @throws Error  InvalidArgument for a band that was not made from a mesh, or from another mesh;
///         Cancelled
/// Time O(n log n), in parallel.
std::vector<float> sampleVertexWeights(const std::vector<double>& ofPoint, const Band& band,
                                       Progress& progress = Progress::none());

}  // namespace igeo
