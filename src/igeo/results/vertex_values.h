/// Distances at the vertices of a mesh file, under the file's own numbers.
#pragma once

#include <igeo/base/progress.h>
#include <igeo/io/triangle_mesh.h>
#include <igeo/march/field.h>
#include <igeo/results/surface_mesh.h>

#include <string>
#include <vector>

namespace igeo {

/// The file's vertices and faces; of a mesh without a source its points and triangles.
PolygonMesh polygonsOf(const TriangleMesh& mesh);

/// Per vertex of polygonsOf, in their order.
struct VertexValues {
    std::vector<double> distance;      ///< world units times weight; +infinity: not reached, NaN:
                                       ///< no face uses the vertex
    std::vector<std::uint32_t> label;  ///< the nearest seed; kNoLabel: not reached or not used
};

/// The distance at each vertex: sampleDistance at its place on the mesh. Vertices that were welded
/// have the same values.
/// @param field  on a band of the mesh
/// @throws Error  Cancelled through `progress`
/// Time O(vertices + triangles), in parallel. The same bits for any number of threads.
VertexValues vertexValues(const TriangleMesh& mesh, const Field& field,
                          Progress& progress = Progress::none());

/// Comma-separated: a first line `vertex,distance,label`, then a line per vertex; `inf` and -1
/// where it is not reached, `nan` and -1 where no face uses it. Reading the numbers gives the same
/// doubles.
std::string verticesCsv(const VertexValues& values);

/// NumPy's format, version 1.0: little-endian float64, shape (vertices,), with infinities and NaN.
std::string verticesNpy(const VertexValues& values);

/// The file's vertices and faces as binary PLY: x y z, double where single precision would change
/// one; red green blue (uchar); distance and quality, the same number (float); label (int).
/// -1 where a vertex is not reached or not used. MeshLab shows `quality`.
std::string verticesPly(const PolygonMesh& mesh, const VertexValues& values, const Color& color);

/// The same as Wavefront OBJ: `v x y z r g b`, colors as Blender and MeshLab read them, and `f`.
std::string verticesObj(const PolygonMesh& mesh, const VertexValues& values, const Color& color);

}  // namespace igeo
