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

/// The bytes of a .npz file: arrays stored in a zip archive without compression, each under its
/// name. The same bytes whenever it is written.
/// @param arrays  names, and the bytes of their .npy files
/// @throws Error  InvalidArgument where it has 4 GiB or more, which plain zip cannot hold
std::string npz(const std::vector<std::pair<std::string, std::string>>& arrays);

}  // namespace igeo
