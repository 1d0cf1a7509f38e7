/// Numbers in sentences.
#pragma once

#include <igeo/types.h>

#include <cstdio>
#include <string>

inline std::string text(const char* pattern, double a, double b = 0, double c = 0) {
    char buffer[256];
    std::snprintf(buffer, sizeof buffer, pattern, a, b, c);
    return buffer;
}

inline std::string text(const igeo::Vec3d& p) { return text("%.9g,%.9g,%.9g", p.x, p.y, p.z); }
