/// Whole files in memory. Internal.
#pragma once

#include <string>
#include <string_view>

namespace igeo {

/// @throws Error  Io, with the system's reason, for a file that does not exist, is a folder or is
///         not readable
std::string fileBytes(const std::string& file);

/// A text without the byte order mark with which spreadsheets and editors start files in UTF-8.
std::string_view withoutByteOrderMark(std::string_view text);

/// Cuts the first line off a text and returns it, without its end: a line feed, a carriage return
/// or both.
std::string_view cutLine(std::string_view& text);

/// Whether bytes begin like a gzip file.
bool isGzip(std::string_view bytes);

/// The same, decompressed if it is a gzip file.
/// @throws Error  BadInput also for damaged data and for more than 2^36 bytes
std::string inflatedFileBytes(const std::string& file);

/// The ending of a file's name in lower case, ".obj"; of FILE.gii.gz ".gii".
std::string endingBeforeGz(const std::string& file);

/// @param what  follows the file's name: "is cut off"
/// @throws Error  BadInput
[[noreturn]] void refuseFile(const std::string& file, const std::string& what,
                             const std::string& remedy);

}  // namespace igeo
