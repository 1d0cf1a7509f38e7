/// A value per vertex of a mesh, from a file beside it.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace igeo {

/// Whether a file holds values per vertex by the ending of its name, in any case: .gii (.gii.gz)
/// .csv .txt .npy .label; or is a morphometry file of FreeSurfer (lh.curv) by its first bytes.
bool isVertexDataFile(const std::string& file);

/// Reads a value for every vertex, under the numbers of the mesh's file:
///
/// - `.gii`: the array of values, of any intent; of any number type, text or binary.
/// - `.csv .txt`: a value per line in the order of the vertices, or lines of a vertex and its value
///   (vertices that are not named have 0). A first line without numbers names the columns; where
///   the first is `vertex`, as in what --per-vertex writes, columns behind the value are skipped.
///   `#` begins a comment.
/// - `.npy`: NumPy's format, one dimension (or one column) of integers, booleans or floats.
/// - `.label`: FreeSurfer's list of vertices: 1 at those, 0 at others.
/// - FreeSurfer's morphometry: its floats.
///
/// @param count  how many vertices the mesh has
/// @throws Error  Io where the file cannot be read; BadInput for another kind of file, a damaged
///         one, several arrays or columns, and another number of values than `count`
/// Time O(size). Values may be NaN.
std::vector<double> readVertexData(const std::string& file, std::size_t count);

/// The vertices that a .label file lists, in its order.
/// @throws Error  as readVertexData
std::vector<std::size_t> readLabelFile(const std::string& file);

}  // namespace igeo
