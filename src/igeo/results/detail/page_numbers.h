/// The numbers of a page: packed for its script, which has the reverse (drawing.js). Internal.
#pragma once

#include <igeo/results/surface_mesh.h>

#include <cstdint>
#include <string>
#include <vector>

namespace igeo {

using Numbers = std::vector<std::uint32_t>;

/// zlib in base64: a byte with the count of planes, and the planes, the lowest bytes of all numbers
/// first.
/// @param differences  packs the difference of each number to the one before, its sign in the
///                     lowest bit
std::string packed(const Numbers& numbers, bool differences);

/// Triangles as fans around their least vertices, in the order of these: two thirds of the numbers,
/// and small ones. The order of the triangles is lost.
struct TriangleFans {
    Numbers middle;  ///< per fan: the vertex that all its triangles share, the least of each
    Numbers count;   ///< per fan: its triangles
    /// The others of each fan in a row, count + 1 of them, less the middle. Triangle k is the
    /// middle and entries k and k + 1.
    Numbers rim;

    /// Time O(triangles + vertices).
    TriangleFans(const std::vector<SurfaceMesh::Triangle>& triangles, std::size_t vertices);
};

}  // namespace igeo
