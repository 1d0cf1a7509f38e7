/// Point clouds from files.
#pragma once

#include <igeo/io/point_cloud.h>

#include <string>

namespace igeo {

/// Whether a file can only be a point cloud, by its ending in any case: .xyz .txt .csv .pts .asc
/// .pwn.
bool isPointFile(const std::string& file);

/// Reads a cloud, in the format that the ending of the file's name gives:
///
/// - `.ply`: text or binary of either byte order; x y z and, if all three exist, nx ny nz of the
///   element `vertex`. Everything else is skipped.
/// - `.xyz .txt .csv .pts .asc`: a point per line, x y z or x y z nx ny nz, separated by blanks,
///   commas or semicolons; `#` starts a comment, and a first line without a number names the
///   columns, in this order. Columns that it names as colors, intensity, label or class are
///   skipped. Normals have any length where it names nx, else length 1, to 10 %.
/// - `.pwn`: a count, then as many lines x y z, then as many nx ny nz; or lines x y z nx ny nz.
/// - `.obj`: the lines `v`, and, if there are as many, `vn`.
/// - `.vdb`: a grid of points, FILE.vdb:GRID where there are several; normals are the attribute
///   `N`.
///
/// A byte order mark before text is skipped.
/// @throws Error  Io where the file cannot be read; BadInput for another ending, a broken or
///         truncated file (with line or byte), decimal commas (1,5;2,5 or 1,5 2,5), a header that
///         names x y z nx ny nz in another order, columns 4 to 6 without a name that are no unit
///         vector, a coordinate that is not finite, a normal that is not finite or zero, or no
///         points. Time O(size)
PointCloud readPointCloud(const std::string& file);

}  // namespace igeo
