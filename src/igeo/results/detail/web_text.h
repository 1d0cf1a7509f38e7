/// Text that becomes part of a page. Internal.
#pragma once

#include <map>
#include <string>
#include <string_view>

namespace igeo {

/// The bytes as UTF-8: what is none becomes U+FFFD, byte by byte.
std::string utf8(std::string_view bytes);

/// As text of HTML, and in the quotes of an attribute: markup is shown.
std::string htmlText(std::string_view text);

/// A string of JSON, with quotes, in ASCII. It has no `<`, so that no element around it ends.
std::string jsonString(std::string_view text);

/// The address of a picture that holds its bytes.
std::string pngAddress(std::string_view png);

/// The text with what is in `values` in place of {{name}}; other braces stay. Values are not looked
/// into.
std::string filledIn(std::string_view text, const std::map<std::string, std::string>& values);

}  // namespace igeo
