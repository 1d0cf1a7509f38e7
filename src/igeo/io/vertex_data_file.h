/// Files with a value per vertex of a mesh.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace igeo {

/// Whether a file holds values per vertex: by its ending, in any case (.gii .gii.gz .csv .txt .npy
/// .label), or by its first bytes (morphometry of FreeSurfer, lh.curv).
bool isVertexDataFile(const std::string& file);

/// Reads a value for every vertex, numbered as in the mesh's file:
///
/// - `.gii`: the array of values, of any intent and number type, text or binary.
/// - `.csv .txt`: a value per line in the order of the vertices, or lines of a vertex and its value
///   (vertices that are missing have 0). A first line without numbers names the columns; where the
///   first is `vertex`, as in the output of --per-vertex, columns after the value are skipped. `#`
///   starts a comment.
/// - `.npy`: NumPy's format, one dimension (or one column) of integers, booleans or floats.
/// - `.label`: FreeSurfer's list of vertices: 1 at these, 0 at others.
/// - FreeSurfer's morphometry: its floats.
///
/// @param count  number of vertices of the mesh
/// @throws Error  Io where the file cannot be read; BadInput for another kind of file, a damaged
///         one, several arrays or columns, a vertex on two lines, decimal commas (1;1,5), and
///         another number of values than `count`
/// Time O(size). Values may be NaN.
std::vector<double> readVertexData(const std::string& file, std::size_t count);

/// The vertices that a .label file lists, in its order.
/// @throws Error  as readVertexData
std::vector<std::size_t> readLabelFile(const std::string& file);

}  // namespace igeo
