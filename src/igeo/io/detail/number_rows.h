/// Rows of numbers in text files. Internal.
#pragma once

#include <istream>
#include <string>
#include <string_view>
#include <vector>

namespace igeo {

/// The finite numbers of a text, separated by commas; empty where a part is no number.
std::vector<double> numbersIn(const std::string& text);

/// The names of the columns in a header, in lower case, without blanks, quotes and slashes around
/// them.
std::vector<std::string> namesInHeader(std::string_view header);

/// Whether each column holds a color, the intensity or a class of the point, by its name. r, g and
/// b count together only: in a,b,c the b is no blue.
std::vector<bool> extraColumns(const std::vector<std::string>& names);

/// Refuses a header that names a coordinate, a part of a normal or of a color (x, nx, red; r, g and
/// b together) in a column that is read as something else: y,x,z, or x,y,z,r,g,b where columns 4 to
/// 6 are normals. Columns that may be left out are read under their own name only: x,y,z,id has no
/// start. Other names are allowed.
/// @param columns  what is read, in order: "x,y,z,nx,ny,nz"
/// @param numbers  in a line below the header
/// @throws Error  BadInput, with the line
void requireColumns(const std::string& file, std::size_t number, std::string_view header,
                    const std::string& columns, std::size_t numbers);

/// Rows of numbers, separated by commas, semicolons, blanks or tabs. Lines may be empty or end in
/// comments (#); the first may name the columns.
/// @param columns  what is read, as for requireColumns
/// @param counts   allowed numbers per line, which `shape` states in words
/// @throws Error  BadInput, with the line, for any other, decimal commas and a header that names
///         other columns
std::vector<std::vector<double>> rowsFromText(std::istream& in, const std::string& file,
                                              const std::string& columns,
                                              const std::vector<std::size_t>& counts,
                                              const std::string& shape);

}  // namespace igeo
