/// Text of what libfmt does not know. Internal.
#pragma once

#include <fmt/core.h>
#include <igeo/base/types.h>

#include <string>

namespace igeo {

inline std::string textOf(const Vec3d& p) {
    return fmt::format("{:.6g},{:.6g},{:.6g}", p.x, p.y, p.z);
}

}  // namespace igeo
