/// Column names that every format can store. Internal.
#pragma once

#include <string>

namespace igeo {

/// `name`, with _ in place of all but ASCII letters, digits, dots and hyphens.
inline std::string plainName(const std::string& name) {
    std::string plain;
    for (const char c : name) {
        const bool isPlain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') ||
                             (c >= '0' && c <= '9') || c == '.' || c == '-';
        plain += isPlain ? c : '_';
    }
    return plain;
}

/// The name for the distances from a source.
/// @param name  empty: use the number
inline std::string distanceColumn(const std::string& name, std::size_t number) {
    return "distance_" + (name.empty() ? std::to_string(number) : plainName(name));
}

}  // namespace igeo
