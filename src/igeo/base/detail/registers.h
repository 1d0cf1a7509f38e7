/// Registers of four and of eight floats. Internal.
///
/// All that uses them is inlined: what a register holds depends on the processor that a function is
/// compiled for.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>

#define IGEO_INLINE inline __attribute__((always_inline))
#if defined(__x86_64__) && defined(__linux__)
#define IGEO_AVX2 __attribute__((target("avx2")))
#endif

// All is inlined, so it does not matter how a register of eight is passed.
#pragma GCC diagnostic ignored "-Wpsabi"

namespace igeo {

/// Whether functions work in registers of eight floats: where the processor has them. The bits are
/// those of registers of four; tests turn it off.
inline bool& eightAtATime() {
#ifdef IGEO_AVX2
    static bool eight = __builtin_cpu_supports("avx2");
#else
    static bool eight = false;
#endif
    return eight;
}

template <int Width>
struct Registers;
template <>
struct Registers<4> {
    typedef float Vector __attribute__((vector_size(16)));
    typedef std::int32_t Integers __attribute__((vector_size(16)));
};
template <>
struct Registers<8> {
    typedef float Vector __attribute__((vector_size(32)));
    typedef std::int32_t Integers __attribute__((vector_size(32)));
};

template <int Width>
IGEO_INLINE void takeRoots(typename Registers<Width>::Vector& v) {
    using V = typename Registers<Width>::Vector;
    alignas(32) float of[Width];
    *reinterpret_cast<V*>(of) = v;
    for (int k = 0; k < Width; ++k) of[k] = std::sqrt(of[k]);
    v = *reinterpret_cast<const V*>(of);
}

/// A register of numbers that need not be aligned.
template <typename Vector, typename T>
IGEO_INLINE Vector loadAs(const T* from) {
    Vector v;
    std::memcpy(&v, from, sizeof(v));
    return v;
}
template <int Width>
IGEO_INLINE auto loadLanes(const float* from) {
    return loadAs<typename Registers<Width>::Vector>(from);
}
/// Without their signs.
template <typename V>
IGEO_INLINE V absolute(const V& v) {
    using Integers = decltype(v < v);
    const Integers bits = loadAs<Integers>(&v) & 0x7fffffff;
    return loadAs<V>(&bits);
}
template <typename Vector, typename T>
IGEO_INLINE void storeLanes(const Vector& v, T* to) {
    std::memcpy(to, &v, sizeof(v));
}

/// 1, 2, 4 and so on.
template <int Width>
IGEO_INLINE typename Registers<Width>::Integers bitPerLane() {
    if constexpr (Width == 4)
        return typename Registers<Width>::Integers{1, 2, 4, 8};
    else
        return typename Registers<Width>::Integers{1, 2, 4, 8, 16, 32, 64, 128};
}

/// Flags, 0 or -1 each, as bits.
template <int Width>
IGEO_INLINE unsigned bitsOf(const typename Registers<Width>::Integers& flags) {
    using Integers = typename Registers<Width>::Integers;
    if constexpr (Width == 4) {
#ifdef __SSE__
        Registers<4>::Vector signs;
        std::memcpy(&signs, &flags, sizeof signs);
        return unsigned(__builtin_ia32_movmskps(signs));
#endif
        Integers bits = flags & bitPerLane<4>();
        bits |= __builtin_shufflevector(bits, bits, 2, 3, 0, 1);
        return unsigned(bits[0] | bits[1]);
    } else {
        return bitsOf<4>(__builtin_shufflevector(flags, flags, 0, 1, 2, 3)) |
               bitsOf<4>(__builtin_shufflevector(flags, flags, 4, 5, 6, 7)) << 4;
    }
}

/// Whether one of the flags is set.
template <typename Flags>
IGEO_INLINE bool any(const Flags& flags) {
    std::uint64_t of[sizeof flags / 8], all = 0;
    std::memcpy(of, &flags, sizeof flags);
    for (const std::uint64_t two : of) all |= two;
    return all != 0;
}

/// A vector of space per lane.
template <int Width>
struct VectorLanes {
    using V = typename Registers<Width>::Vector;
    V x, y, z;

    IGEO_INLINE VectorLanes operator+(const VectorLanes& v) const {
        return {x + v.x, y + v.y, z + v.z};
    }
    IGEO_INLINE VectorLanes operator-(const VectorLanes& v) const {
        return {x - v.x, y - v.y, z - v.z};
    }
    IGEO_INLINE VectorLanes operator*(const V& s) const { return {s * x, s * y, s * z}; }
};
template <int Width>
IGEO_INLINE auto dot(const VectorLanes<Width>& v, const VectorLanes<Width>& w) {
    return v.x * w.x + v.y * w.y + v.z * w.z;
}
template <int Width>
IGEO_INLINE VectorLanes<Width> cross(const VectorLanes<Width>& v, const VectorLanes<Width>& w) {
    return {v.y * w.z - v.z * w.y, v.z * w.x - v.x * w.z, v.x * w.y - v.y * w.x};
}

/// igeo::anyNormalTo per lane, with the same bits.
template <int Width>
IGEO_INLINE VectorLanes<Width> anyNormalTo(const VectorLanes<Width>& n) {
    using V = typename Registers<Width>::Vector;
    const V x = absolute(n.x), y = absolute(n.y), z = absolute(n.z), zero{};
    const auto byX = (x <= y) & (x <= z), byY = ~byX & (y <= z);
    const VectorLanes<Width> t{byX   ? zero
                               : byY ? -n.z
                                     : n.y,
                               byX   ? n.z
                               : byY ? zero
                                     : -n.x,
                               byX   ? -n.y
                               : byY ? n.x
                                     : zero};
    V len = dot(t, t);
    takeRoots<Width>(len);
    return t * (len > 0 ? 1 / len : zero + 1);
}

/// Four lanes after four, of which each has `row[k]` of four rows: turns rows into columns.
template <int Width>
IGEO_INLINE void transposeFours(const typename Registers<Width>::Vector (&row)[4],
                                typename Registers<Width>::Vector (&column)[4]) {
    using V = typename Registers<Width>::Vector;
    if constexpr (Width == 4) {
        const V a = __builtin_shufflevector(row[0], row[1], 0, 4, 1, 5),
                b = __builtin_shufflevector(row[2], row[3], 0, 4, 1, 5),
                c = __builtin_shufflevector(row[0], row[1], 2, 6, 3, 7),
                d = __builtin_shufflevector(row[2], row[3], 2, 6, 3, 7);
        column[0] = __builtin_shufflevector(a, b, 0, 1, 4, 5);
        column[1] = __builtin_shufflevector(a, b, 2, 3, 6, 7);
        column[2] = __builtin_shufflevector(c, d, 0, 1, 4, 5);
        column[3] = __builtin_shufflevector(c, d, 2, 3, 6, 7);
    } else {
        const V a = __builtin_shufflevector(row[0], row[1], 0, 8, 1, 9, 4, 12, 5, 13),
                b = __builtin_shufflevector(row[2], row[3], 0, 8, 1, 9, 4, 12, 5, 13),
                c = __builtin_shufflevector(row[0], row[1], 2, 10, 3, 11, 6, 14, 7, 15),
                d = __builtin_shufflevector(row[2], row[3], 2, 10, 3, 11, 6, 14, 7, 15);
        column[0] = __builtin_shufflevector(a, b, 0, 1, 8, 9, 4, 5, 12, 13);
        column[1] = __builtin_shufflevector(a, b, 2, 3, 10, 11, 6, 7, 14, 15);
        column[2] = __builtin_shufflevector(c, d, 0, 1, 8, 9, 4, 5, 12, 13);
        column[3] = __builtin_shufflevector(c, d, 2, 3, 10, 11, 6, 7, 14, 15);
    }
}

/// Loads four numbers from each of several places: `of` has the first of all, the second of all,
/// and so on.
/// @param placeOf(lane)
template <int Width, typename PlaceOf>
IGEO_INLINE void loadFours(const PlaceOf& placeOf, typename Registers<Width>::Vector (&of)[4]) {
    using V = typename Registers<Width>::Vector;
    using Four = Registers<4>::Vector;
    Four four[Width];
    for (int lane = 0; lane < Width; ++lane) std::memcpy(&four[lane], placeOf(lane), sizeof(Four));
    V row[4];
    for (int lane = 0; lane < 4; ++lane)
        if constexpr (Width == 4)
            row[lane] = four[lane];
        else
            row[lane] = __builtin_shufflevector(four[lane], four[lane + 4], 0, 1, 2, 3, 4, 5, 6, 7);
    transposeFours<Width>(row, of);
}
/// The same.
/// @param from    where the place with index 0 is
/// @param stride  bytes from one place to the next
/// @param index   of the places, one per lane
template <int Width>
IGEO_INLINE void loadFours(const void* from, std::size_t stride, const std::uint32_t* index,
                           typename Registers<Width>::Vector (&of)[4]) {
    const auto* const bytes = static_cast<const char*>(from);
    loadFours<Width>([&](int lane) { return bytes + stride * index[lane]; }, of);
}

/// The reverse: stores four numbers at each of several places, one after the other.
template <int Width>
IGEO_INLINE void storeFours(const typename Registers<Width>::Vector (&of)[4], void* to,
                            std::size_t stride) {
    using V = typename Registers<Width>::Vector;
    auto* const bytes = static_cast<char*>(to);
    V row[4];
    transposeFours<Width>(of, row);
    for (int lane = 0; lane < Width; ++lane)
        std::memcpy(bytes + stride * std::size_t(lane),
                    reinterpret_cast<const char*>(&row[lane % 4]) + lane / 4 * 16, 16);
}

}  // namespace igeo
