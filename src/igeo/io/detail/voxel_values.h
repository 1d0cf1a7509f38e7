/// Voxel values in files. Internal.
#pragma once

#include <igeo/base/error.h>
#include <igeo/io/detail/byte_reader.h>

#include <array>
#include <string>
#include <string_view>
#include <vector>

namespace igeo {

/// The name of a type for messages: "int16".
const char* nameOf(NumberType type);

/// @throws Error  BadInput for a size of more than 2^34 voxels in all
std::size_t voxelCount(const std::string& file, const std::array<std::size_t, 3>& size);

/// Bytes `begin` to `end` of data.
/// @throws Error  BadInput where there are fewer
std::string rawDataOf(const std::string& file, std::string_view data, std::size_t begin,
                      std::size_t end);
/// The same of decompressed gzip data; other data are used as they are.
/// @throws Error  BadInput also for damaged data
std::string dataOf(const std::string& file, std::string_view data, std::size_t begin,
                   std::size_t end);

/// value * scale + shift for the numbers in `bytes`.
std::vector<float> voxelsOf(const std::string& file, std::string_view bytes, NumberType type,
                            bool bigEndian, double scale = 1, double shift = 0);

}  // namespace igeo
