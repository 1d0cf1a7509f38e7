/// Triangle meshes from files.
#pragma once

#include <igeo/io/triangle_mesh.h>

#include <string>

namespace igeo {

/// Whether a file is a mesh: by its ending, in any case (.obj .ply .stl .off .gii .mz3 .gltf .glb),
/// or by its first bytes (surfaces of FreeSurfer).
bool isMeshFile(const std::string& file);

/// Reads all surfaces of a file as one mesh: polygons are cut into triangles, the transforms of a
/// glTF scene applied, points and lines left out, and the mesh is welded (weld()) and split where
/// corners lie in edges (splitAtJunctions()). glTF is read by assimp. All formats but STL and
/// glTF keep the numbers of their vertices (TriangleMesh::source), and all but glTF may be gzip
/// files (.gii.gz).
///
/// GIFTI: positions are those of the array of points; transforms in the file are not applied.
/// FreeSurfer: positions are those of the file, relative to the center that the geometry of the
/// volume, its last part, gives.
///
/// Coordinates of STL and glTF are rounded to single precision, and many files hold no more; a
/// warning says so where a mesh is so far from the origin that it loses more than 1e-5 of its size.
/// @throws Error  Io for a file that does not exist, is a folder or is not readable; BadInput for
///         one of another kind, a broken one, one without triangles, coordinates that are not
///         finite or more than 2^31 points
/// Time O(size).
TriangleMesh readMesh(const std::string& file);

/// The mesh of vertices and faces in memory, made as readMesh makes one from a file: polygons cut
/// into triangles, welded, with the vertex numbers kept.
/// @param name  its name in messages and results
/// @throws Error  BadInput without vertices or faces, for corners that are no vertices, and as
///         readMesh
TriangleMesh meshOf(PolygonMesh polygons, const std::string& name);

}  // namespace igeo
