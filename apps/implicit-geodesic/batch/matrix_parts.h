/// Distance matrices in parts, as --matrix-rows writes them.
#pragma once

#include <string>
#include <vector>

/// The whole matrix as one run would have written it, byte by byte.
/// @param files  parts, in any order
/// @param output its ending says which format, as for --matrix: .csv, .json or .npy; -: .csv
/// @throws igeo::Error  Io; BadInput for parts that are not of one matrix, gaps and overlaps
std::string joinedMatrix(const std::vector<std::string>& files, const std::string& output);
