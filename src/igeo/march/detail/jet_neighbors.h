/// The neighbors of a node as the local solve of scheme `jet` takes them: no grid, no states, no
/// surface.
///
/// The chart of a node is its tangent plane, with the surface around it laid out flat: the node at
/// the origin, neighbor j at -a_j, its gradient turned along with it (docs/method.md, "1. Chart").
#pragma once

#include <igeo/band/tangent_frame.h>
#include <igeo/base/types.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace igeo {

/// A neighbor in the chart of a node.
struct JetNeighbor {
    Vec2f a;       ///< from the neighbor to the node
    Vec2f g;       ///< direction of travel at the neighbor, unit; 0 at a seed
    double u = 0;  ///< its value over the weight
};

/// A tangent vector at a neighbor in the chart of a node: turned along with the plane, by the least
/// rotation that takes nj to n.
/// @param nj  normal at the neighbor; cosine = n . nj
inline Vec2f turnedInto(const TangentFrame& frame, const Vec3f& nj, float cosine, const Vec3f& v) {
    return frame.flat(v) - (dot(v, frame.normal()) / (1 + cosine)) * frame.flat(nj);
}

/// A neighbor laid out in the chart.
/// @param frame   tangent plane of the node
/// @param chord   from the foot point of the neighbor to that of the node
/// @param nj      normal at the neighbor; cosine = n . nj
/// @param gradient, value  of the distance at the neighbor, over the weight at the node
inline JetNeighbor flattened(const TangentFrame& frame, const Vec3f& chord, const Vec3f& nj,
                             float cosine, const Vec3f& gradient, double value) {
    return {frame.unfold(chord, nj, cosine), turnedInto(frame, nj, cosine, gradient), value};
}

/// A neighbor in coordinates in which the metric at the node is Euclidean (Stretch).
/// @param n  its gradient in units of the weight here: as long as the metric there is larger
///           than the one here, in the direction of travel
inline JetNeighbor stretched(const Stretch& stretch, JetNeighbor n) {
    const Vec2f q = stretch.covector(n.g);
    const float len = length(q);
    // Along the direction of travel, not along the chord: the two ends then count as in the
    // trapezoid rule (p_i + p_j) . a / 2 up to terms of third order.
    n.a = (len > 0 ? meanWeight(len, 1) : 1) * stretch.vector(n.a);
    n.g = len > 0 ? (1 / len) * q : q;
    return n;
}

/// Value and direction of travel.
struct Jet {
    double u = kInfinity;
    Vec2f g;
    bool usedFallback = false;  ///< in doubt: from fermatUpdate, or blended beside a focus
    bool ofOneFront = true;     ///< blended; else the first of several fronts
};

/// Up to 28 neighbors, each quantity in an array of its own, in groups of four for the vector
/// units. Values are kept relative to the first one's, so single precision (1e-7 of a voxel) is
/// enough.
class JetNeighbors {
public:
    static constexpr int kMax = 28;

    void add(const JetNeighbor& n) {
        const auto k = std::size_t(count_);
        if (k % 4 == 0) pad(k);
        if (k == 0) base_ = n.u;
        ax_[k] = n.a.x, ay_[k] = n.a.y, gx_[k] = n.g.x, gy_[k] = n.g.y;
        u_[k] = float(n.u - base_);
        ++count_;
    }
    int count() const { return count_; }
    double base() const { return base_; }
    Vec2f a(int k) const { return {ax_[std::size_t(k)], ay_[std::size_t(k)]}; }
    Vec2f g(int k) const { return {gx_[std::size_t(k)], gy_[std::size_t(k)]}; }
    float u(int k) const { return u_[std::size_t(k)]; }  ///< relative to base()
    float len(int k) const { return length(a(k)); }

    typedef float Four __attribute__((vector_size(16)));
    struct Group {
        Four ax, ay, gx, gy, u;
    };
    int groups() const { return (count_ + 3) / 4; }
    Group group(int k) const {
        return {load(ax_, k), load(ay_, k), load(gx_, k), load(gy_, k), load(u_, k)};
    }

    static constexpr float kLongest2 = 2.3f;
    float longest2 = kLongest2;  ///< squared length up to which fermatUpdate takes segments

private:
    using Array = std::array<float, kMax>;
    static Four load(const Array& v, int k) {
        return *reinterpret_cast<const Four*>(v.data() + 4 * k);
    }
    /// The rest of a group has no effect: direction 0 belongs to no front.
    void pad(std::size_t k) {
        for (std::size_t i = k; i < k + 4; ++i) ax_[i] = ay_[i] = gx_[i] = gy_[i] = u_[i] = 0;
    }

    alignas(16) Array ax_, ay_, gx_, gy_, u_;
    double base_ = 0;
    int count_ = 0;
};

namespace jet {

using Four = JetNeighbors::Four;

inline float sum(Four v) { return (v[0] + v[1]) + (v[2] + v[3]); }
inline Four roots(const Four& v) {
    alignas(16) std::array<float, 4> of;
    *reinterpret_cast<Four*>(of.data()) = v;
    for (float& r : of) r = std::sqrt(r);
    return *reinterpret_cast<const Four*>(of.data());
}

/// Directions further apart than 45 degrees belong to two fronts.
constexpr float kSameFront = 0.7f;

}  // namespace jet

/// Tells whether fronts meet across a point: whether neighbors on its left and right travel toward
/// each other, by more than 14 degrees in all. Those of a front that narrows to a focus do so as
/// well, those around a seed or behind a corner do not.
class FrontsMeet {
public:
    /// @param g  direction of travel at the point
    explicit FrontsMeet(Vec2f g) : g_(g) {}
    /// @return the sine of the angle by which it turns toward the point's side
    float add(const JetNeighbor& n) {
        const float side = across(n.a), turn = across(n.g),
                    sine = dot(g_, n.g) > 0 ? turn : std::copysign(1.0f, turn),
                    toward = side > 0   ? sine
                             : side < 0 ? -sine
                                        : 0;
        float& most = side > 0 ? fromRight_ : fromLeft_;
        most = std::max(most, toward);
        return toward;
    }
    bool meet() const { return turn() > kTurn; }
    float turn() const { return fromLeft_ + fromRight_; }
    static constexpr float kTurn = 0.24f;

private:
    float across(Vec2f v) const { return g_.x * v.y - g_.y * v.x; }

    const Vec2f g_;
    float fromLeft_ = 0, fromRight_ = 0;  ///< sines of the largest turns toward the other side
};

}  // namespace igeo
