/// Points, normals and faces of PLY files. Internal.
#pragma once

#include <igeo/base/types.h>

#include <string>
#include <vector>

namespace igeo {

struct Ply {
    std::vector<Vec3d> points;
    std::vector<Vec3f> normals;  ///< per point; empty unless nx, ny and nz are all there
    std::vector<std::vector<std::uint32_t>> faces;  ///< corners, as point numbers
};

/// Reads x y z and nx ny nz of the element `vertex`; `faces` stays empty. Text, binary of either
/// byte order, any number types, elements in any order. All else is skipped, but must be complete.
///
/// By hand, because the usual libraries round to float, a decimeter in the coordinates of a survey,
/// and accept truncated files or read beyond their end.
/// @param file   its name, for messages
/// @param bytes  all of the file
/// @throws Error  BadInput, with the byte, for anything else, and for a file that ends too early
/// Time O(size). Memory O(size), whatever counts the file announces.
Ply readPlyPoints(const std::string& file, const std::string& bytes);

/// Reads faces as well: the list vertex_indices (or vertex_index) of the element `face`, if there
/// is one. BadInput also for a corner that is no point number.
Ply readPlyFaces(const std::string& file, const std::string& bytes);

}  // namespace igeo
