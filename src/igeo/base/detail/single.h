/// Rounding to single precision. Internal.
#pragma once

#include <igeo/base/types.h>

namespace igeo {

/// A position in single precision. In place of Vec3d(Vec3f(p)): GCC 12 leaves the rounding out
/// where it converts two coordinates in one register.
inline Vec3d inSingle(const Vec3d& p) {
    const volatile float x = float(p.x), y = float(p.y), z = float(p.z);
    return {double(x), double(y), double(z)};
}

}  // namespace igeo
