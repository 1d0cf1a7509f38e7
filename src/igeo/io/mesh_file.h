/// Triangle meshes from files.
#pragma once

#include <igeo/io/triangle_mesh.h>

#include <string>

namespace igeo {

/// Whether a file is a mesh by the ending of its name: .obj .ply .stl .off .gltf .glb, in any case.
bool isMeshFile(const std::string& file);

/// Reads all surfaces of a file as one mesh: polygons are cut into triangles, the transforms of a
/// glTF scene applied, points and lines left out, the mesh welded (weld()). PLY, OBJ and
/// OFF keep the numbers of their vertices (TriangleMesh::source); STL and glTF go through assimp.
///
/// Coordinates of STL and glTF pass through single precision, and many files hold no more; a
/// warning says so where the mesh is so far from the origin that it loses more than 1e-5 of its
/// size.
/// @throws Error  Io for a file that is not there, is a folder or may not be read; BadInput for one
///         of another kind, broken, without triangles, with coordinates that are not finite or
///         more than 2^31 points
/// Time O(size).
TriangleMesh readMesh(const std::string& file);

}  // namespace igeo
