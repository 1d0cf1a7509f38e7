/// Triangle meshes from files.
#pragma once

#include <igeo/io/triangle_mesh.h>

#include <string>

namespace igeo {

/// Whether a file is a mesh by the ending of its name, in any case: .obj .ply .stl .off .gii .mz3
/// .gltf .glb; or a surface of FreeSurfer by its first bytes.
bool isMeshFile(const std::string& file);

/// Reads all surfaces of a file as one mesh: polygons are cut into triangles, the transforms of a
/// glTF scene applied, points and lines left out, the mesh welded (weld()). STL and
/// glTF go through assimp; all others keep the numbers of their vertices (TriangleMesh::source),
/// and may be gzip files (.gii.gz).
///
/// GIFTI: positions as they are in the array of points; transforms that the file names are not
/// applied. FreeSurfer: positions as they are in the file, relative to the center that its last
/// part, the geometry of the volume, gives.
///
/// Coordinates of STL and glTF pass through single precision, and many files hold no more; a
/// warning says so where the mesh is so far from the origin that it loses more than 1e-5 of its
/// size.
/// @throws Error  Io for a file that is not there, is a folder or may not be read; BadInput for one
///         of another kind, broken, without triangles, with coordinates that are not finite or
///         more than 2^31 points
/// Time O(size).
TriangleMesh readMesh(const std::string& file);

/// The mesh of vertices and faces that are in memory, as readMesh makes it of a file: polygons cut
/// into triangles, welded, with the numbers of its vertices.
/// @param name  what messages and results call it
/// @throws Error  BadInput without vertices or faces, for corners that are no vertices, and as
///         readMesh
TriangleMesh meshOf(PolygonMesh polygons, const std::string& name);

}  // namespace igeo
