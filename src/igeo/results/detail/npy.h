/// Arrays in NumPy's format. Internal.
#pragma once

#include <string>
#include <vector>

namespace igeo {

/// Version 1.0: little-endian float64 in C order.
/// @param shape  as Python writes it: "(3, 4)", "(5,)"
std::string npy(const std::vector<double>& values, const std::string& shape);

}  // namespace igeo
