/// Registers of four and of eight floats. Internal.
///
/// All that uses them is inlined: what a register holds depends on the processor that a function is
/// compiled for.
#pragma once

#include <cmath>

#define IGEO_INLINE inline __attribute__((always_inline))
#if defined(__x86_64__) && defined(__linux__)
#define IGEO_AVX2 __attribute__((target("avx2")))
#endif

namespace igeo {

template <int Width>
struct Registers;
template <>
struct Registers<4> {
    typedef float Vector __attribute__((vector_size(16)));
};
template <>
struct Registers<8> {
    typedef float Vector __attribute__((vector_size(32)));
};

template <int Width>
IGEO_INLINE void takeRoots(typename Registers<Width>::Vector& v) {
    using V = typename Registers<Width>::Vector;
    alignas(32) float of[Width];
    *reinterpret_cast<V*>(of) = v;
    for (int k = 0; k < Width; ++k) of[k] = std::sqrt(of[k]);
    v = *reinterpret_cast<const V*>(of);
}

}  // namespace igeo
