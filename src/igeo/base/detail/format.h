/// Numbers in sentences, for the program alone: the library uses libfmt, and this goes once the
/// program does.
#pragma once

#include <igeo/base/types.h>

#include <array>
#include <cstdio>
#include <string>

namespace igeo {

/// Of up to three doubles, by a pattern of printf.
inline std::string format(const char* pattern, double a, double b = 0, double c = 0) {
    std::array<char, 256> text{};
    std::snprintf(text.data(), text.size(), pattern, a, b, c);
    return text.data();
}

inline std::string format(const Vec3d& p) { return format("%.6g,%.6g,%.6g", p.x, p.y, p.z); }

}  // namespace igeo
