/// Base64 and zlib for binary data in files. Internal.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace igeo {

/// The bytes that a text in base64 stands for; white space in it is skipped, and the padding `=`
/// may be missing. None for any other character. Time O(size).
std::optional<std::string> base64Decoded(std::string_view text);

/// In one line, with padding. Time O(size).
std::string base64Encoded(std::string_view bytes);

/// Whether bytes begin as those of a gzip file.
bool isGzip(std::string_view bytes);

/// What zlib or gzip data (members one after the other) hold, up to `most` bytes of it; what
/// follows is not looked at. None where the data are damaged or end too early.
/// Time and memory O(what is made), whatever the data announce.
std::optional<std::string> inflated(std::string_view bytes, std::size_t most);

/// In zlib's format. The same bytes for the same input and version of zlib.
std::string deflated(std::string_view bytes);

}  // namespace igeo
