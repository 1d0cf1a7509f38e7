/// Tangent vectors carried from plane to plane. Internal.
#pragma once

#include <igeo/base/types.h>

namespace igeo {

/// A tangent vector turned along with its plane: the least rotation that takes one normal to the
/// other. Over a crease both planes are unfolded.
inline Vec3d turned(const Vec3d& v, const Vec3d& fromNormal, const Vec3d& toNormal) {
    constexpr double kOpposite = -0.9;
    const double cosine = dot(fromNormal, toNormal);
    if (cosine < kOpposite) return v;
    return v - (dot(v, toNormal) / (1 + cosine)) * (fromNormal + toNormal);
}

}  // namespace igeo
