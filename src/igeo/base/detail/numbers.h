/// Numbers in files.
#pragma once

#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <optional>
#include <string>
#include <string_view>

#ifndef __cpp_lib_to_chars
#include <locale.h>
#if __has_include(<xlocale.h>)
#include <xlocale.h>
#endif
#endif

namespace igeo {

/// The decimal number that `text` consists of, with a point in every locale; nan and inf are
/// numbers. Empty for any other text and beyond the range of doubles.
inline std::optional<double> parseDouble(std::string_view text) {
#ifdef __cpp_lib_to_chars
    double value = 0;
    const char* const end = text.data() + text.size();
    const auto [stop, error] = std::from_chars(text.data(), end, value);
    if (error != std::errc() || stop != end) return {};
    return value;
#else
    // libc++ has no from_chars for doubles. strtod also accepts white space, a plus and hexadecimal
    // digits, which are excluded here.
    static const locale_t plain = ::newlocale(LC_ALL_MASK, "C", nullptr);
    if (text.empty() || text.find_first_of(" \t\n\v\f\rxX") != text.npos || text[0] == '+')
        return {};
    const std::string copy(text);
    char* stop = nullptr;
    errno = 0;
    const double value = ::strtod_l(copy.c_str(), &stop, plain);
    // ERANGE is also set for subnormal values.
    if (stop != copy.c_str() + copy.size() ||
        (errno == ERANGE && (value == 0 || std::isinf(value))))
        return {};
    return value;
#endif
}

}  // namespace igeo
