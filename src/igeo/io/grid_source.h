/// The name of a grid in a file: FILE[:GRID].
#pragma once

#include <string>

namespace igeo {

/// The file "-" is standard input.
struct GridSource {
    std::string file;
    std::string grid;  ///< empty: the only usable one; for tensors: the start of the two grid names

    bool operator==(const GridSource&) const = default;
    /// FILE[:GRID]
    std::string text() const { return grid.empty() ? file : file + ":" + grid; }
};

/// Splits FILE[:GRID] at the last colon; if a file with the whole name exists, it is the file.
GridSource parseGridSource(const std::string& text);

}  // namespace igeo
