/// Arrays in NumPy's formats. Internal.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace igeo {

/// The bytes of a .npy file, version 1.0: little-endian float64 in C order.
/// @param shape  as Python writes it: "(3, 4)", "(5,)"
std::string npy(const std::vector<double>& values, const std::string& shape);
/// The same of int32.
std::string npy(const std::vector<std::int32_t>& values, const std::string& shape);

/// The bytes of a .npz file: arrays stored uncompressed in a zip archive, each under its name. The
/// same arrays give the same bytes.
/// @param arrays  names, and the bytes of their .npy files
/// @throws Error  InvalidArgument for 4 GiB or more, the limit of plain zip
std::string npz(const std::vector<std::pair<std::string, std::string>>& arrays);

}  // namespace igeo
