/// Parts of distance matrices, as --matrix-rows writes them.
#pragma once

#include <string>
#include <vector>

/// The whole matrix, byte by byte as one run would write it.
/// @param files  parts, in any order
/// @param output its ending gives the format, as for --matrix: .csv, .json or .npy; -: .csv
/// @throws igeo::Error  Io; BadInput for parts of different matrices, gaps and overlaps
std::string joinedMatrix(const std::vector<std::string>& files, const std::string& output);
