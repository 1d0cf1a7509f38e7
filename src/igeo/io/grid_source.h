/// A grid in a file, as named: FILE[:GRID].
#pragma once

#include <string>

namespace igeo {

/// The file "-" is standard input.
struct GridSource {
    std::string file;
    std::string grid;  ///< empty: the only one that can be meant; of a tensor: what its names begin
                       ///< with

    bool operator==(const GridSource&) const = default;
    /// FILE[:GRID]
    std::string text() const { return grid.empty() ? file : file + ":" + grid; }
};

/// Splits FILE[:GRID] at the last colon; a file whose whole name exists wins.
GridSource parseGridSource(const std::string& text);

}  // namespace igeo
