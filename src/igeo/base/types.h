/// Small vectors, grid coordinates and the similarity between voxels and the world.
///
/// The library measures in voxels throughout: positions are index coordinates, lengths are
/// multiples of the voxel size dx. World coordinates come in with the seeds and go out with the
/// results, through `Similarity`. So scale, rotation and translation of a grid cannot change a
/// computed bit.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

namespace igeo {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Number of a band voxel. 32 bits: Band refuses more than 2^32 - 2 nodes.
using NodeIndex = std::uint32_t;
constexpr NodeIndex kNoNode = std::numeric_limits<NodeIndex>::max();

/// Largest |index|: every difference of two indices and every box then fits into 32 bits, in
/// OpenVDB's own tools too.
constexpr std::int32_t kFarthestIndex = 1 << 30;
/// Up to this index, positions in single precision, which some tools of OpenVDB use, are right to
/// 0.004 voxels: half a unit in the last place.
constexpr std::int32_t kFarthestInFloat = 1 << 17;

template <typename T>
struct Vec3 {
    T x{}, y{}, z{};

    constexpr Vec3() = default;
    constexpr Vec3(T ax, T ay, T az) : x(ax), y(ay), z(az) {}
    template <typename U>
    explicit constexpr Vec3(const Vec3<U>& v) : x(T(v.x)), y(T(v.y)), z(T(v.z)) {}

    constexpr T& operator[](int i) { return i == 0 ? x : i == 1 ? y : z; }
    constexpr const T& operator[](int i) const { return i == 0 ? x : i == 1 ? y : z; }

    constexpr Vec3& operator+=(const Vec3& b) { return x += b.x, y += b.y, z += b.z, *this; }
    constexpr Vec3& operator-=(const Vec3& b) { return x -= b.x, y -= b.y, z -= b.z, *this; }
    constexpr Vec3& operator*=(T s) { return x *= s, y *= s, z *= s, *this; }
    friend constexpr Vec3 operator+(Vec3 a, const Vec3& b) { return a += b; }
    friend constexpr Vec3 operator-(Vec3 a, const Vec3& b) { return a -= b; }
    friend constexpr Vec3 operator-(const Vec3& a) { return {-a.x, -a.y, -a.z}; }
    friend constexpr Vec3 operator*(T s, Vec3 a) { return a *= s; }
    friend constexpr Vec3 operator*(Vec3 a, T s) { return a *= s; }
    friend constexpr bool operator==(const Vec3& a, const Vec3& b) {
        return a.x == b.x && a.y == b.y && a.z == b.z;
    }
    friend constexpr bool operator!=(const Vec3& a, const Vec3& b) { return !(a == b); }
};

using Vec3f = Vec3<float>;
using Vec3d = Vec3<double>;
using Ijk = Vec3<std::int32_t>;  ///< integer index coordinates of a voxel

template <typename T>
constexpr T dot(const Vec3<T>& a, const Vec3<T>& b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <typename T>
constexpr Vec3<T> cross(const Vec3<T>& a, const Vec3<T>& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
template <typename T>
T length(const Vec3<T>& a) {
    return std::sqrt(dot(a, a));
}
/// a / |a|, or a itself where |a| = 0.
template <typename T>
Vec3<T> normalized(const Vec3<T>& a) {
    const T len = length(a);
    return len > 0 ? a * (1 / len) : a;
}
/// 0 to pi; of parallel vectors as accurate as of others.
template <typename T>
T angleBetween(const Vec3<T>& a, const Vec3<T>& b) {
    return std::atan2(length(cross(a, b)), dot(a, b));
}
/// The part of `a` orthogonal to the unit vector `n`.
template <typename T>
constexpr Vec3<T> tangential(const Vec3<T>& a, const Vec3<T>& n) {
    return a - dot(a, n) * n;
}
/// A unit vector orthogonal to the unit vector `n`.
template <typename T>
Vec3<T> anyNormalTo(const Vec3<T>& n) {
    // The coordinate axis farthest from n gives a long cross product.
    const Vec3<T> m{std::abs(n.x), std::abs(n.y), std::abs(n.z)};
    const Vec3<T> axis = m.x <= m.y && m.x <= m.z ? Vec3<T>{1, 0, 0}
                         : m.y <= m.z             ? Vec3<T>{0, 1, 0}
                                                  : Vec3<T>{0, 0, 1};
    return normalized(cross(n, axis));
}
/// Whether the voxels around a position have 32-bit indices.
inline bool hasIjk(const Vec3d& p) {
    return std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}) < 2147483000.0;
}
inline Ijk roundToIjk(const Vec3d& p) {
    return {std::int32_t(std::floor(p.x + 0.5)), std::int32_t(std::floor(p.y + 0.5)),
            std::int32_t(std::floor(p.z + 0.5))};
}
/// std::floor is a function call in baseline x86-64, and slower.
inline std::int32_t floorToInt(float x) {
    const auto i = std::int32_t(x);
    return i - (x < float(i));
}
inline Ijk floorToIjk(const Vec3d& p) {
    return {std::int32_t(std::floor(p.x)), std::int32_t(std::floor(p.y)),
            std::int32_t(std::floor(p.z))};
}

/// world = dx * Q * index + origin, Q orthogonal (a rotation, or one with a reflection).
struct Similarity {
    double dx = 1;  ///< voxel size, world units
    std::array<Vec3d, 3> axis{Vec3d{1, 0, 0}, Vec3d{0, 1, 0}, Vec3d{0, 0, 1}};  ///< columns of Q
    Vec3d origin{};  ///< world position of index (0, 0, 0)

    Vec3d worldFromIndex(const Vec3d& p) const { return origin + dx * worldFromIndexDirection(p); }
    Vec3d indexFromWorld(const Vec3d& p) const {
        return indexFromWorldDirection(p - origin) * (1 / dx);
    }
    /// Whether Q holds a reflection.
    bool mirrors() const { return dot(cross(axis[0], axis[1]), axis[2]) < 0; }
    /// These turn a direction and keep its length.
    Vec3d worldFromIndexDirection(const Vec3d& v) const {
        return v.x * axis[0] + v.y * axis[1] + v.z * axis[2];
    }
    Vec3d indexFromWorldDirection(const Vec3d& v) const {
        return {dot(axis[0], v), dot(axis[1], v), dot(axis[2], v)};
    }
};

/// A vector in a tangent plane.
struct Vec2f {
    float x = 0, y = 0;
    friend Vec2f operator+(Vec2f a, Vec2f b) { return {a.x + b.x, a.y + b.y}; }
    friend Vec2f operator-(Vec2f a, Vec2f b) { return {a.x - b.x, a.y - b.y}; }
    friend Vec2f operator*(float s, Vec2f a) { return {s * a.x, s * a.y}; }
};
inline float dot(Vec2f a, Vec2f b) { return a.x * b.x + a.y * b.y; }
inline float length(Vec2f a) { return std::sqrt(dot(a, a)); }

/// A point of the plane in which triangles are laid flat.
struct Vec2d {
    double x = 0, y = 0;
    friend Vec2d operator+(Vec2d a, Vec2d b) { return {a.x + b.x, a.y + b.y}; }
    friend Vec2d operator-(Vec2d a, Vec2d b) { return {a.x - b.x, a.y - b.y}; }
    friend Vec2d operator*(double s, Vec2d a) { return {s * a.x, s * a.y}; }
    friend bool operator==(Vec2d a, Vec2d b) { return a.x == b.x && a.y == b.y; }
};
inline double dot(Vec2d a, Vec2d b) { return a.x * b.x + a.y * b.y; }
inline double cross(Vec2d a, Vec2d b) { return a.x * b.y - a.y * b.x; }
inline double length(Vec2d a) { return std::hypot(a.x, a.y); }

}  // namespace igeo
