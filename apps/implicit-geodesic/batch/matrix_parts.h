/// Parts of distance matrices, as --matrix-rows writes them.
#pragma once

#include <string>
#include <vector>

#include "console.h"

/// The whole matrix, byte by byte as one run would write it. Warns of pairs of seeds with a path in
/// one direction only, as that run does; the parts cannot know of them.
/// @param files  parts, in any order
/// @param output its ending gives the format, as for --matrix: .csv, .json or .npy; -: .csv
/// @throws igeo::Error  Io; BadInput for parts of different matrices, gaps and overlaps
std::string joinedMatrix(const std::vector<std::string>& files, const std::string& output,
                         const Console& console);
