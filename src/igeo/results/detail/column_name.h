/// Names of columns that every format can hold. Internal.
#pragma once

#include <string>

namespace igeo {

/// `name`, with _ for what is no letter, digit, dot or hyphen of ASCII.
inline std::string plainName(const std::string& name) {
    std::string plain;
    for (const char c : name) {
        const bool isPlain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') ||
                             (c >= '0' && c <= '9') || c == '.' || c == '-';
        plain += isPlain ? c : '_';
    }
    return plain;
}

/// That of the distances from a source.
/// @param name  empty: it has a number only
inline std::string distanceColumn(const std::string& name, std::size_t number) {
    return "distance_" + (name.empty() ? std::to_string(number) : plainName(name));
}

}  // namespace igeo
