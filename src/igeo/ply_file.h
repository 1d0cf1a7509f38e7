/// Points and faces of PLY files.
#pragma once

#include <igeo/types.h>

#include <istream>
#include <string>
#include <vector>

namespace igeo {

struct PlyFaces {
    std::vector<Vec3d> points;
    std::vector<std::vector<std::uint32_t>> faces;  ///< corners; each a number of a point
};

/// Reads x, y, z of the element `vertex` and the list vertex_indices (or vertex_index) of the
/// element `face`, if there is one; ASCII, little- and big-endian, any of the format's number
/// types, other elements and properties skipped.
/// @param file  for messages
/// @throws Error  BadInput for anything else, and for a file that ends too early
PlyFaces readPlyFaces(std::istream& in, const std::string& file);

}  // namespace igeo
