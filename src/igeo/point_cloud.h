/// Points as scanners leave them: files in.
#pragma once

#include <igeo/types.h>

#include <string>
#include <vector>

namespace igeo {

/// Points on or near a surface, world units.
struct PointCloud {
    std::string file;  ///< as named, for messages
    std::vector<Vec3d> points;
    std::vector<Vec3f> normals;  ///< per point, of any length but zero; empty: none are known
    std::vector<std::string> warnings = {};  ///< of the file, in sentences
};

/// Whether a file is points by the ending of its name, and nothing else: .xyz .txt .csv .pts .asc,
/// in any case.
bool isPointFile(const std::string& file);

/// Reads a cloud, by the ending of the file's name:
///
/// - `.ply`: text or binary of either byte order; x y z and, if all three are there, nx ny nz of
///   the element `vertex`. Everything else is skipped.
/// - `.xyz .txt .csv .pts .asc`: a point per line, x y z or x y z nx ny nz, with blanks, commas or
///   semicolons between them; `#` begins a comment, and a first line without a number names the
///   columns.
/// - `.obj`: the lines `v`, and if there are as many, `vn`.
/// - `.vdb`: a grid of points, FILE.vdb:GRID where there are several; normals are the attribute
/// `N`.
///
/// @throws Error  Io where the file cannot be read; BadInput for another ending, a broken or
///         truncated file (with line or byte), a coordinate that is not finite, a normal that is
///         not finite or zero, or no points
PointCloud readPointCloud(const std::string& file);

/// Throws BadInput, naming the point, unless all is finite and no normal is zero.
void requireUsable(const PointCloud& cloud);

/// Each position once, sorted; of several points in one place the one whose normal is lowest by
/// coordinates, so that the order of the input plays no part.
PointCloud distinctPoints(const PointCloud& cloud);

}  // namespace igeo
