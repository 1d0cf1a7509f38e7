/// Distances at the vertices of a mesh file, numbered as in the file.
#pragma once

#include <igeo/base/progress.h>
#include <igeo/io/triangle_mesh.h>
#include <igeo/march/field.h>
#include <igeo/results/surface_mesh.h>

#include <string>
#include <vector>

namespace igeo {

/// The vertices and faces of the file; for a mesh without a source its points and triangles.
PolygonMesh polygonsOf(const TriangleMesh& mesh);

/// The distance at each vertex from a single source.
struct VertexColumn {
    std::string name;              ///< "distance_" and the source's name or number
    std::vector<double> distance;  ///< as VertexValues::distance
};

/// Values per vertex of polygonsOf, in their order.
struct VertexValues {
    /// World units times weight; +infinity: unreached, NaN: no face uses the vertex
    std::vector<double> distance;
    std::vector<std::uint32_t> label;        ///< the nearest source; kNoLabel: unreached or unused
    std::vector<VertexColumn> columns = {};  ///< one per source, if requested
};

/// Reads distances at the vertices of a mesh, for one field or several.
class VertexReader {
public:
    /// @param transform  of the mesh's bands
    VertexReader(const TriangleMesh& mesh, const Similarity& transform);

    /// The distance at each vertex: sampleDistance at its position on the mesh. Welded vertices
    /// have the same values.
    /// @param field  on a band of the mesh
    /// @throws Error  Cancelled through `progress`
    /// Time O(vertices + triangles), in parallel. The same bits for any number of threads.
    VertexValues read(const Field& field, Progress& progress = Progress::none()) const;

private:
    SurfaceMesh mesh_;  ///< index space, without values
    std::vector<std::uint32_t> pointOfVertex_;
};

/// The values of one field.
VertexValues vertexValues(const TriangleMesh& mesh, const Field& field,
                          Progress& progress = Progress::none());

/// Comma-separated: a first line `vertex,distance,label` and the names of the columns, then a line
/// per vertex; `inf` and -1 where unreached, `nan` and -1 where no face uses it. Reading the
/// numbers gives the same doubles.
std::string verticesCsv(const VertexValues& values);

/// NumPy's format, version 1.0: little-endian float64, shape (vertices,), with infinities and NaN.
/// With columns: shape (vertices, columns), only the columns.
std::string verticesNpy(const VertexValues& values);

/// NumPy's archive of `distance`, float64 (vertices,); `label`, int32 (vertices,); and of columns
/// `distances`, float64 (vertices, columns).
/// @throws Error  InvalidArgument for 4 GiB and more
std::string verticesNpz(const VertexValues& values);

/// The vertices and faces of the file as binary PLY: x y z, double if single precision would change
/// one; red green blue (uchar); distance and quality, the same number (float); label (int); s t and
/// texture_u texture_v, (distance / largest, 0) or (0, 1); the columns (float). -1 where a vertex
/// is unreached or unused. MeshLab shows `quality`.
std::string verticesPly(const PolygonMesh& mesh, const VertexValues& values, const Color& color);

/// The same as Wavefront OBJ: `v x y z r g b`, colors as Blender and MeshLab read them, and `f`.
std::string verticesObj(const PolygonMesh& mesh, const VertexValues& values, const Color& color);

/// The same for VTK (vtp_file.h): distance (float64), label (int32) and the columns (float64). NaN
/// where a vertex is unreached or unused, label -1.
std::string verticesVtp(const PolygonMesh& mesh, const VertexValues& values);

/// GIFTI: an array of float32 each for distance, label and the columns, under these names, without
/// the surface (.func.gii or .shape.gii), zlib in base64. -1 where a vertex is unreached or unused.
std::string verticesGifti(const VertexValues& values);

}  // namespace igeo
