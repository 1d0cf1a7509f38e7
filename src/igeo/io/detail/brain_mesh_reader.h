/// Meshes in the binary formats of FreeSurfer and Surfice. Internal.
#pragma once

#include <igeo/io/polygon_mesh.h>

#include <string>
#include <string_view>

namespace igeo {

/// Whether bytes begin like a surface of FreeSurfer (lh.pial, without an ending): a triangle file,
/// or a quadrangle file of either kind. The older of these begins like a morphometry file.
bool isFreeSurferSurface(std::string_view bytes);

/// Reads a triangle or quadrangle file of FreeSurfer, with positions as in the file. Quadrangles
/// stay quadrangles. The part after the faces, with the geometry of the volume, is not read.
/// @param file   its name, for messages
/// @param bytes  all of the file
/// @throws Error  BadInput, with the byte, for another kind of file, one that ends too early,
///         morphometry, and a corner that is no vertex number
/// Time O(size). Memory O(size), whatever counts the file announces.
PolygonMesh readFreeSurferMesh(const std::string& file, const std::string& bytes);

/// Reads vertices and faces of Surfice's .mz3; colors and scalars are skipped.
/// @param bytes  of the file, inflated
/// @throws Error  BadInput as readFreeSurferMesh
PolygonMesh readMz3Mesh(const std::string& file, const std::string& bytes);

}  // namespace igeo
