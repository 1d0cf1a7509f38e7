/// All of a file at once. Internal.
#pragma once

#include <string>
#include <string_view>

namespace igeo {

/// @throws Error  Io, with the reason of the system, for a file that is not there, is a folder or
///         may not be read
std::string fileBytes(const std::string& file);

/// Whether bytes begin as those of a gzip file.
bool isGzip(std::string_view bytes);

/// The same, inflated where it is a gzip file.
/// @throws Error  BadInput also for damaged data and for more than 2^36 bytes
std::string inflatedFileBytes(const std::string& file);

/// The ending of a file's name in lower case, ".obj"; of FILE.gii.gz ".gii".
std::string endingBeforeGz(const std::string& file);

}  // namespace igeo
