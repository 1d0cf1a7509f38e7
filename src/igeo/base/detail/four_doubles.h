/// Registers of four doubles. Internal; as registers.h, for all that is inlined.
#pragma once

#include <igeo/base/detail/registers.h>

#include <cmath>
#include <cstdint>

namespace igeo {

typedef double FourDoubles __attribute__((vector_size(32)));
typedef std::int64_t FourFlags __attribute__((vector_size(32)));  ///< 0 or -1 each

/// Flags as bits.
IGEO_INLINE unsigned bitsOf(const FourFlags& flags) {
    return bitsOf<4>(__builtin_convertvector(flags, Registers<4>::Integers));
}

/// A vector of space per lane.
struct FourVectors {
    FourDoubles x, y, z;

    IGEO_INLINE FourVectors operator-(const FourVectors& v) const {
        return {x - v.x, y - v.y, z - v.z};
    }
    IGEO_INLINE FourVectors operator*(const FourDoubles& s) const { return {s * x, s * y, s * z}; }
};
IGEO_INLINE FourDoubles dot(const FourVectors& v, const FourVectors& w) {
    return v.x * w.x + v.y * w.y + v.z * w.z;
}
IGEO_INLINE FourVectors cross(const FourVectors& v, const FourVectors& w) {
    return {v.y * w.z - v.z * w.y, v.z * w.x - v.x * w.z, v.x * w.y - v.y * w.x};
}
/// igeo::normalized per lane, with the same bits.
IGEO_INLINE FourVectors normalized(const FourVectors& v) {
    alignas(32) double roots[4];
    storeLanes(dot(v, v), roots);
    for (double& root : roots) root = std::sqrt(root);
    const auto length = loadAs<FourDoubles>(roots);
    return v * (length > 0 ? 1 / length : FourDoubles{} + 1);
}

}  // namespace igeo
