/// Rows of numbers in text files. Internal.
#pragma once

#include <istream>
#include <string>
#include <vector>

namespace igeo {

/// Finite numbers with commas between them; empty where a part is none.
std::vector<double> numbersIn(const std::string& text);

/// Numbers line by line, between commas, semicolons, blanks or tabs. Lines may be empty or end in
/// comments (#); the first may name the columns.
/// @param counts  how many numbers may be on a line, as `shape` says in words
/// @throws Error  BadInput, with the line, for any other
std::vector<std::vector<double>> rowsFromText(std::istream& in, const std::string& file,
                                              const std::vector<std::size_t>& counts,
                                              const std::string& shape);

}  // namespace igeo
