/// The ending of a file's name.
#pragma once

#include <string>

/// With its dot; empty if there is none.
inline std::string endingOf(const std::string& file) {
    const auto dot = file.rfind('.');
    return dot == std::string::npos ? "" : file.substr(dot);
}
