/// zlib behind a small interface.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace igeo {

/// `bytes` in zlib's format (RFC 1950).
/// @param level  1 to 9; for the numbers of a page 1 takes a third of the time of 6 and 6 % more
///               bytes
std::string deflated(std::string_view bytes, int level = 6);

/// The decompressed content of zlib or gzip `bytes`; consecutive gzip members are joined.
/// @param limit  most bytes of the result: a file of a few bytes can hold gigabytes of zeros
/// @throws Error  BadInput for damaged or cut bytes, and beyond the limit
std::string inflated(std::string_view bytes, std::size_t limit);

/// The first `most` bytes of the content, or all of it if it is shorter. The rest is not read.
/// @throws Error  BadInput for damaged or cut bytes
std::string inflatedStart(std::string_view bytes, std::size_t most);

/// CRC-32 as in gzip, zip and PNG.
unsigned long crc32Of(std::string_view bytes);

}  // namespace igeo
