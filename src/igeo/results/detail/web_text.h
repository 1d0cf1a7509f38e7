/// Text for pages. Internal.
#pragma once

#include <map>
#include <string>
#include <string_view>

namespace igeo {

/// The bytes as UTF-8; each invalid byte becomes U+FFFD.
std::string utf8(std::string_view bytes);

/// Escaped for HTML text and quoted attributes, so that markup is shown as text.
std::string htmlText(std::string_view text);

/// A JSON string, with quotes, in ASCII. It contains no `<`, so it cannot end the element around
/// it.
std::string jsonString(std::string_view text);

/// A data URL with the bytes of a picture.
std::string pngAddress(std::string_view png);

/// Replaces {{name}} by `values[name]`; other braces stay. Values are not searched.
std::string filledIn(std::string_view text, const std::map<std::string, std::string>& values);

}  // namespace igeo
