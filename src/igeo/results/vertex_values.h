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

/// The distance at each vertex from one source alone.
struct VertexColumn {
    std::string name;              ///< "distance_" and the source's name or number
    std::vector<double> distance;  ///< as VertexValues::distance
};

/// Per vertex of polygonsOf, in their order.
struct VertexValues {
    std::vector<double> distance;      ///< world units times weight; +infinity: not reached, NaN:
                                       ///< no face uses the vertex
    std::vector<std::uint32_t> label;  ///< the nearest source; kNoLabel: not reached or not used
    std::vector<VertexColumn> columns = {};  ///< one per source, where asked for
};

/// Reads distances at the vertices of a mesh, field by field.
class VertexReader {
public:
    /// @param transform  of the mesh's bands
    VertexReader(const TriangleMesh& mesh, const Similarity& transform);

    /// The distance at each vertex: sampleDistance at its place on the mesh. Vertices that were
    /// welded have the same values.
    /// @param field  on a band of the mesh
    /// @throws Error  Cancelled through `progress`
    /// Time O(vertices + triangles), in parallel. The same bits for any number of threads.
    VertexValues read(const Field& field, Progress& progress = Progress::none()) const;

private:
    SurfaceMesh mesh_;  ///< index space, without values
    std::vector<std::uint32_t> pointOfVertex_;
};

/// VertexReader for one field.
VertexValues vertexValues(const TriangleMesh& mesh, const Field& field,
                          Progress& progress = Progress::none());

/// Comma-separated: a first line `vertex,distance,label` and the names of the columns, then a line
/// per vertex; `inf` and -1 where it is not reached, `nan` and -1 where no face uses it. Reading
/// the numbers gives the same doubles.
std::string verticesCsv(const VertexValues& values);

/// NumPy's format, version 1.0: little-endian float64, shape (vertices,), with infinities and NaN.
/// Of columns: shape (vertices, columns), and these alone.
std::string verticesNpy(const VertexValues& values);

/// NumPy's archive of `distance`, float64 (vertices,); `label`, int32 (vertices,); and of columns
/// `distances`, float64 (vertices, columns).
/// @throws Error  InvalidArgument for 4 GiB and more
std::string verticesNpz(const VertexValues& values);

/// The file's vertices and faces as binary PLY: x y z, double where single precision would change
/// one; red green blue (uchar); distance and quality, the same number (float); label (int); s t
/// and texture_u texture_v, (distance / largest, 0) or (0, 1); the columns (float). -1 where a
/// vertex is not reached or not used. MeshLab shows `quality`.
std::string verticesPly(const PolygonMesh& mesh, const VertexValues& values, const Color& color);

/// The same as Wavefront OBJ: `v x y z r g b`, colors as Blender and MeshLab read them, and `f`.
std::string verticesObj(const PolygonMesh& mesh, const VertexValues& values, const Color& color);

/// The same for VTK (vtp_file.h): distance (float64), label (int32) and the columns (float64). NaN
/// where a vertex is not reached or not used, label -1.
std::string verticesVtp(const PolygonMesh& mesh, const VertexValues& values);

/// GIFTI: an array of float32 each for distance, label and the columns, named so, without the
/// surface (.func.gii or .shape.gii), zlib in base64. -1 where a vertex is not reached or not used.
std::string verticesGifti(const VertexValues& values);

}  // namespace igeo
