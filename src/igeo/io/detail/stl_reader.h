/// Meshes in STL files. Internal.
#pragma once

#include <igeo/base/types.h>

#include <string>
#include <vector>

namespace igeo {

/// Reads the corners of the triangles of an STL file, three each, in single precision. Normals and
/// attributes are skipped, and in a binary file all that follows its triangles. Binary is a file
/// that is long enough for as many triangles as its header announces, whatever its first word.
/// @param file   its name, for messages
/// @param bytes  all of the file
/// @throws Error  BadInput for a file that is cut off or no STL file
/// Time and memory O(size).
std::vector<Vec3d> readStlCorners(const std::string& file, const std::string& bytes);

}  // namespace igeo
