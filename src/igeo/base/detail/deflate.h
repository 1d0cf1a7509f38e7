/// zlib, kept behind two names.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace igeo {

/// `bytes` in zlib's format (RFC 1950).
/// @param level  1 to 9; of numbers as in a page 4 takes half the time of 6, for 3 % more bytes
std::string deflated(std::string_view bytes, int level = 6);

/// What zlib's or gzip's `bytes` hold; gzip members that follow each other are joined.
/// @param limit  bytes that the result may have: a file of a few bytes can hold gigabytes of zeros
/// @throws Error  BadInput for damaged or cut bytes, and beyond the limit
std::string inflated(std::string_view bytes, std::size_t limit);

/// The first bytes of that, `most` or, if there are no more, all. What follows is not looked at.
/// @throws Error  BadInput for damaged or cut bytes
std::string inflatedStart(std::string_view bytes, std::size_t most);

/// CRC-32 as in gzip, zip and PNG.
unsigned long crc32Of(std::string_view bytes);

}  // namespace igeo
