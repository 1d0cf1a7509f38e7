/// Meshes in text formats. Internal.
#pragma once

#include <igeo/io/polygon_mesh.h>

#include <string>
#include <vector>

namespace igeo {

/// Reads `v` and `f` of a Wavefront OBJ file; negative corner numbers count back from the last
/// vertex. Everything else is skipped. By hand, because the usual libraries round to float and
/// renumber vertices.
/// @param file   its name, for messages
/// @param bytes  all of the file
/// @throws Error  BadInput, with the line, for a vertex without three numbers and a corner that is
///         no vertex number, 0 among them
/// Time O(size).
PolygonMesh readObjMesh(const std::string& file, const std::string& bytes);

/// Reads an OFF file in text form; normals, colors and texture coordinates are skipped.
/// @throws Error  BadInput, with the line, as readObjMesh; also for another kind of file, for
///         OFF in binary or in four dimensions, and for a file that ends too early
/// Time O(size). Memory O(size), whatever counts the file announces.
PolygonMesh readOffMesh(const std::string& file, const std::string& bytes);

/// Reads the corners of the triangles of an STL file in text form, three each, in single precision;
/// keywords in letters of either case. Normals are skipped, numbers or not.
/// @throws Error  BadInput, with the line, for a facet without three corners, for another word and
///         for a file that ends within a solid
/// Time O(size).
std::vector<Vec3d> readTextStlCorners(const std::string& file, const std::string& bytes);

}  // namespace igeo
