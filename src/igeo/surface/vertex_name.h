/// Names of vertices.
#pragma once

#include <igeo/base/types.h>
#include <igeo/io/triangle_mesh.h>

#include <cstddef>
#include <string>
#include <vector>

namespace igeo {

/// The vertex with a name: its number from 0 on; +x, -x, +y, -y, +z or -z, the farthest along an
/// axis; or center, the nearest to the middle of the box of all. On ties the first. A vertex
/// without a triangle has no other name than its number.
/// @param of    the owner of the vertices, for messages
/// @param mesh  the mesh of the vertices; null for points
/// @throws Error  InvalidArgument for another name and a number out of range
std::size_t vertexNamed(const std::string& name, const std::vector<Vec3d>& vertices,
                        const std::string& of, const TriangleMesh* mesh = nullptr);

}  // namespace igeo
