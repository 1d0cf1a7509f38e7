/// Text of what libfmt does not know. Internal.
#pragma once

#include <fmt/core.h>
#include <igeo/base/types.h>

#include <string>

namespace igeo {

inline std::string textOf(const Vec3d& p, int digits = 6) {
    return fmt::format("{:.{}g},{:.{}g},{:.{}g}", p.x, digits, p.y, digits, p.z, digits);
}

}  // namespace igeo
