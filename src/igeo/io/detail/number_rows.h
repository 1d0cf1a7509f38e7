/// Rows of numbers in text files. Internal.
#pragma once

#include <istream>
#include <string>
#include <vector>

namespace igeo {

/// The finite numbers of a text, separated by commas; empty where a part is no number.
std::vector<double> numbersIn(const std::string& text);

/// Rows of numbers, separated by commas, semicolons, blanks or tabs. Lines may be empty or end in
/// comments (#); the first may name the columns.
/// @param counts  allowed numbers per line, which `shape` states in words
/// @throws Error  BadInput, with the line, for any other
std::vector<std::vector<double>> rowsFromText(std::istream& in, const std::string& file,
                                              const std::vector<std::size_t>& counts,
                                              const std::string& shape);

}  // namespace igeo
