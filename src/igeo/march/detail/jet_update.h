/// The local solve of scheme `jet`, alone: no grid, no states, no surface.
///
/// A node and its neighbors are seen in the node's tangent plane, the surface between them laid
/// out flat: the node at the origin, neighbor j at -a_j, its gradient turned along with it. There
/// the solve looks for the jet (value and gradient) at the origin that continues its neighbors'
/// jets.
#pragma once

#include <igeo/band/tangent_frame.h>
#include <igeo/base/types.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace igeo {

/// A neighbor in the flat picture.
struct JetNeighbor {
    Vec2f a;       ///< from the neighbor to the node
    Vec2f g;       ///< direction of travel at the neighbor, unit; 0 at a seed
    double u = 0;  ///< its value over the weight
};

/// A node with foot point `chord` back from that of `frame`, normal `nj` (cosine = n . nj),
/// gradient and value, as the local solve sees it.
inline JetNeighbor flattened(const TangentFrame& frame, const Vec3f& chord, const Vec3f& nj,
                             float cosine, const Vec3f& gradient, double value) {
    // The gradient turned along with the plane: the least rotation that takes nj to n.
    const Vec2f g =
        frame.flat(gradient) - (dot(gradient, frame.normal()) / (1 + cosine)) * frame.flat(nj);
    return {frame.way(chord, nj, cosine), g, value};
}

/// A neighbor as a front sees it after the stretch.
/// @param n  its gradient in units of the weight here: as long as the metric there is larger
///           than the one here, in the direction of travel
inline JetNeighbor stretched(const Stretch& stretch, JetNeighbor n) {
    const Vec2f q = stretch.covector(n.g);
    const float len = length(q);
    // Along the direction of travel, not along the chord: the two ends then count as in the
    // trapezoid rule (p_i + p_j) . a / 2 up to terms of third order.
    n.a = (len > 0 ? meanWeight(len, 1) : 1) * stretch.way(n.a);
    n.g = len > 0 ? (1 / len) * q : q;
    return n;
}

/// Value and direction of travel.
struct Jet {
    double u = kInfinity;
    Vec2f g;
    int from = -1;         ///< a neighbor whose front it continues
    bool guarded = false;  ///< from the guard, not from the fit
    bool between = false;  ///< fit: neighbors lie on both sides of the way it came
};

/// Up to 26 neighbors, each quantity in an array of its own, in groups of four for the vector
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

        /// 1 / (|a|^2 (|a|^2 + 0.1)); foot points of one voxel column may coincide.
        Four nearness() const {
            const Four l2 = ax * ax + ay * ay + 1e-12f;
            return 1 / (l2 * (l2 + 0.1f));
        }
    };
    int groups() const { return (count_ + 3) / 4; }
    Group group(int k) const {
        return {load(ax_, k), load(ay_, k), load(gx_, k), load(gy_, k), load(u_, k)};
    }

    bool smooth = true;   ///< S is smooth between the node and all of them
    bool rim = false;     ///< the node may lie at an obstacle, or where S ends
    float pull = 0.005f;  ///< weight of the predicted direction in a fit, of all weights
    float far2 = 2.3f;    ///< the guard takes no segments longer than its root

private:
    using Array = std::array<float, kMax>;
    static Four load(const Array& v, int k) {
        return *reinterpret_cast<const Four*>(v.data() + 4 * k);
    }
    /// What is left of a group counts for nothing: direction 0 belongs to no front.
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

// Directions further apart than 45 degrees belong to two fronts.
constexpr float kSameFront = 0.7f;

/// u_i - u_j for a circular (or straight) front with directions g_i, g_j at its ends: exact in the
/// plane, (g_i + g_j) . a / (1 + g_i . g_j). The trapezoid rule (g_i + g_j) . a / 2 is its limit
/// for a straight front; what that misses near a source, a^3 / (4 r^2), would stay for good.
inline float circularStep(Vec2f gi, Vec2f gj, Vec2f a) {
    return dot(gi + gj, a) / (1 + dot(gi, gj));
}

/// Value carried forward from neighbor k alone along the circle about a source at distance u,
/// relative to base(); to second order, which is enough to compare neighbors.
inline float carry(const JetNeighbors& all, int k, float len) {
    const float along = dot(all.g(k), all.a(k));
    if (along <= 0) return all.u(k) + len;
    const float r = float(all.base()) + all.u(k) + along;
    return all.u(k) + along + (len * len - along * along) / (2 * std::max(r, 1.0f));
}

/// Where the neighbors' directions, bent as circles about a source at distance u, point at the
/// origin; weighted mean over the neighbors of the front of direction `start`. Not normalized.
inline Vec2f predictDirection(const JetNeighbors& all, Vec2f start) {
    Four x{}, y{};
    for (int k = 0; k < all.groups(); ++k) {
        const auto n = all.group(k);
        const Four along = n.gx * n.ax + n.gy * n.ay;
        const auto ok = (start.x * n.gx + start.y * n.gy >= kSameFront) & (along > 0);
        const Four r = n.u + float(all.base());
        const Four wx = r * n.gx + n.ax, wy = r * n.gy + n.ay;
        // |r g + a| is r + along to second order in a / r, and near a source a rough weight will
        // do.
        const Four w = ok ? along * along * n.nearness() / (r + along) : Four{};
        x += w * wx, y += w * wy;
    }
    return {sum(x), sum(y)};
}

/// Weighted least squares for the jet at the origin over the neighbors of one front.
///
/// Equations u - f a.g = u_j + f a.g_j, f = 1 / (1 + g.g_j) (circularStep), linear in (u, g) once f
/// is taken from the last round. Weights: cos^2 of the angle between a_j and the direction of
/// travel over |a|^2 + 0.1, so that neighbors straight behind the node decide. A small Tikhonov
/// term pulls g to the predicted direction where the neighbors leave it open.
/// @param start    direction of the front
/// @param residual weighted root mean square of the equations' misfits
/// @return u = +inf where fewer than two neighbors are behind the node, or they do not agree
inline Jet fitFront(const JetNeighbors& all, Vec2f start, float& residual) {
    constexpr int kRounds = 2;
    Jet jet;
    const Vec2f mean = predictDirection(all, start);
    const float meanLength = length(mean);
    if (!(meanLength > 0)) return jet;
    const Vec2f predicted = (1 / meanLength) * mean;
    Vec2f g = predicted;
    for (int round = 0; round < kRounds; ++round) {
        Four s0{}, sx{}, sy{}, sxx{}, sxy{}, syy{}, b0{}, bx{}, by{};
        int used = 0;
        for (int k = 0; k < all.groups(); ++k) {
            const auto n = all.group(k);
            const Four cosine = g.x * n.gx + g.y * n.gy, along = g.x * n.ax + g.y * n.ay;
            const auto ok = (cosine >= kSameFront) & (along > 0);
            used -= ok[0] + ok[1] + ok[2] + ok[3];
            const Four w = ok ? along * along * n.nearness() : Four{};
            const Four f = 1 / (1 + cosine);
            const Four cx = -f * n.ax, cy = -f * n.ay;
            const Four rhs = n.u + f * (n.ax * n.gx + n.ay * n.gy);
            const Four wx = w * cx, wy = w * cy, wr = w * rhs;
            s0 += w, sx += wx, sy += wy;
            sxx += wx * cx, sxy += wx * cy, syy += wy * cy;
            b0 += wr, bx += wr * cx, by += wr * cy;
        }
        if (used < 2) return jet;
        // Eliminate u.
        const float w = sum(s0), ux = sum(sx), uy = sum(sy), ub = sum(b0), inverse = 1 / w;
        const float pull = all.pull * w;
        const float axx = sum(sxx) - ux * ux * inverse + pull, axy = sum(sxy) - ux * uy * inverse,
                    ayy = sum(syy) - uy * uy * inverse + pull;
        const float rx = sum(bx) - ux * ub * inverse + pull * predicted.x,
                    ry = sum(by) - uy * ub * inverse + pull * predicted.y;
        // The length of g is known (1), so the determinant's is not needed.
        const Vec2f next{rx * ayy - ry * axy, ry * axx - rx * axy};
        const float len = length(next);
        if (!(len > 0) || dot(next, g) < kSameFront * len) return jet;
        g = (1 / len) * next;
    }
    // Neighbors to the left and right of the way the front came; straight behind counts for both.
    constexpr float kStraight = 0.03f;
    Four total{}, value{}, square{};
    int left = 0, right = 0;
    for (int k = 0; k < all.groups(); ++k) {
        const auto n = all.group(k);
        const Four cosine = g.x * n.gx + g.y * n.gy, along = g.x * n.ax + g.y * n.ay;
        const auto ok = (cosine >= kSameFront) & (along > 0);
        const Four across = g.x * n.ay - g.y * n.ax, slack = kStraight * along;
        const auto isLeft = ok & (across >= -slack), isRight = ok & (across <= slack);
        left |= isLeft[0] | isLeft[1] | isLeft[2] | isLeft[3];
        right |= isRight[0] | isRight[1] | isRight[2] | isRight[3];
        const Four w = ok ? along * along * n.nearness() : Four{};
        const Four v = n.u + (along + n.gx * n.ax + n.gy * n.ay) / (1 + cosine);
        total += w, value += w * v, square += w * v * v;
    }
    const float w = sum(total);
    if (!(w > 0)) return jet;
    const float u = sum(value) / w;
    residual = std::sqrt(std::max(sum(square) / w - u * u, 0.0f));
    jet.u = all.base() + double(u);
    jet.g = g;
    jet.between = left && right;
    return jet;
}

/// Least value over the segment between neighbors p and q: cubic Hermite values on it, straight on
/// from there to the origin (Fermat's principle, as in the jet marching of Potter and Cameron
/// 2021).
/// @return whether it is below `best`, relative to base(), which is then updated
inline bool lowerBySegment(const JetNeighbors& all, int p, int q, float& best, Vec2f& direction) {
    // Between directions further apart than that a front may fold: no interpolation.
    if (dot(all.g(p), all.g(q)) < kSameFront) return false;
    const Vec2f ap = all.a(p), e = ap - all.a(q);  // from p to q, as both are at -a
    const float up = all.u(p), du = all.u(q) - up, mp = dot(all.g(p), e), mq = dot(all.g(q), e);
    // Not below `best` anywhere? The cubic dips under its ends by 4/27 of the slopes that point
    // down.
    const float along = std::clamp(dot(ap, e) / std::max(dot(e, e), 1e-12f), 0.0f, 1.0f);
    const float dip = (4.0f / 27) * (std::max(-mp, 0.0f) + std::max(mq, 0.0f));
    if (up + std::min(du, 0.0f) - dip + length(ap - along * e) >= best) return false;
    auto total = [&](float s) {
        const float t = 1 - s;
        return up + s * s * (3 - 2 * s) * du + s * t * (t * mp - s * mq) + length(ap - s * e);
    };
    // Golden section: 8 steps leave 2 % of the segment, where the minimum is flat.
    constexpr float kGolden = 0.618034f;
    float lo = 0, hi = 1, s1 = 1 - kGolden, s2 = kGolden, f1 = total(s1), f2 = total(s2);
    for (int k = 0; k < 8; ++k) {
        if (f1 < f2) {
            hi = s2, s2 = s1, f2 = f1;
            s1 = hi - kGolden * (hi - lo), f1 = total(s1);
        } else {
            lo = s1, s1 = s2, f1 = f2;
            s2 = lo + kGolden * (hi - lo), f2 = total(s2);
        }
    }
    const float s = f1 < f2 ? s1 : s2, v = std::min(f1, f2);
    if (!(v < best)) return false;
    best = v;
    direction = ap - s * e;
    return true;
}

}  // namespace jet

/// The guard: the least of u_j + |a_j| over the neighbors, and over the segments between them.
/// Never below the values it starts from; first order at worst, second where the front is smooth.
inline Jet guardedUpdate(const JetNeighbors& all) {
    Jet jet;
    jet.guarded = true;
    float best = float(kInfinity);
    Vec2f direction;
    for (int k = 0; k < all.count(); ++k)
        if (all.u(k) + all.len(k) < best)
            best = all.u(k) + all.len(k), direction = all.a(k), jet.from = k;
    for (int j = 0; j < all.count(); ++j)
        for (int k = 0; k < j; ++k) {
            // Only segments that can matter: short ones, seen from the node at less than 120
            // degrees.
            const Vec2f e = all.a(j) - all.a(k);
            if (dot(e, e) > all.far2 || dot(all.a(j), all.a(k)) < -0.5f * all.len(j) * all.len(k))
                continue;
            if (std::min(all.u(j), all.u(k)) >= best) continue;
            if (jet::lowerBySegment(all, j, k, best, direction)) jet.from = j;
        }
    if (jet.from < 0) return jet;
    jet.u = all.base() + double(best);
    const float len = length(direction);
    jet.g = len > 0 ? (1 / len) * direction : all.g(jet.from);
    return jet;
}

/// The jet at the origin.
///
/// Fits the front of the neighbor that carries the least value; where other neighbors belong to
/// another front (a cut locus), fits theirs as well and takes the lesser. A fit that does not agree
/// with its neighbors, or says more than the straight way from one of them, is held against the
/// guard, as is every fit over a crease: it stands if they agree within 0.01.
/// @return u = +inf without neighbors
inline Jet jetUpdate(const JetNeighbors& all) {
    constexpr float kResidual = 0.02f, kDoubt = 2e-3f, kSlack = 1e-3f, kFocus = 0.2f;
    constexpr double kAgree = 0.01;
    Jet best;
    if (all.count() == 0) return best;
    std::array<float, JetNeighbors::kMax> carried;
    float bound = float(kInfinity), straight = float(kInfinity), worst = 0;
    bool between = true;  // or in the open, where it makes no difference
    int first = 0;
    for (int k = 0; k < all.count(); ++k) {
        const float len = all.len(k);
        carried[std::size_t(k)] = jet::carry(all, k, len);
        bound = std::min(bound, all.u(k) + len);
        straight = std::min(straight, all.u(k) + dot(all.g(k), all.a(k)));
        if (carried[std::size_t(k)] < carried[std::size_t(first)]) first = k;
    }
    auto tryFront = [&](int k) {
        float residual = 0;
        Jet jet = jet::fitFront(all, all.g(k), residual);
        jet.from = k;
        if (!(jet.u - all.base() <= double(bound + kSlack)) || residual > kResidual) return false;
        // Below all straight fronts: two neighbors always agree, however wrong.
        if (jet.u - all.base() < double(straight - kFocus)) worst = kDoubt;
        worst = std::max(worst, residual);
        between &= jet.between || !all.rim;
        if (jet.u < best.u) best = jet;
        return true;
    };
    bool trusted = tryFront(first);
    int second = -1;
    for (int k = 0; k < all.count(); ++k)
        if (dot(all.g(k), all.g(first)) < jet::kSameFront &&
            (second < 0 || carried[std::size_t(k)] < carried[std::size_t(second)]))
            second = k;
    if (second >= 0 && all.base() + double(carried[std::size_t(second)]) < best.u + 0.2)
        trusted = tryFront(second) && trusted;
    if (trusted && between && all.smooth && worst < kDoubt) return best;
    const Jet guard = guardedUpdate(all);
    // Extrapolated from one side: around a rim a front has no way there but by the last neighbor.
    if (!between && all.smooth) return guard;
    return trusted && std::abs(best.u - guard.u) < kAgree ? best : guard;
}

namespace jet {

/// blendJets for neighbors that may belong to two fronts.
inline Jet blendFronts(const JetNeighbors& all,
                       const std::array<float, JetNeighbors::kMax>& weight) {
    Jet best;
    std::array<bool, JetNeighbors::kMax> done{};
    for (int front = 0; front < 2; ++front) {
        // The front of the neighbor that says least of those not blended yet.
        int lead = -1;
        float least = float(kInfinity);
        for (int k = 0; k < all.count(); ++k) {
            const float said = all.u(k) + dot(all.g(k), all.a(k));
            if (!done[std::size_t(k)] && said < least) lead = k, least = said;
        }
        if (lead < 0) break;
        float sum = 0, total = 0;
        Vec2f g{};
        for (int k = 0; k < all.count(); ++k) {
            if (done[std::size_t(k)]) continue;
            if (k != lead && dot(all.g(k), all.g(lead)) < kSameFront) continue;
            done[std::size_t(k)] = true;
            const float w = weight[std::size_t(k)];
            g = g + w * all.g(k);
            sum += w * (all.u(k) + dot(all.g(k) + all.g(lead), all.a(k)) / 2);
            total += w;
        }
        const double u = all.base() + double(sum / total);
        const float len = length(g);
        if (u < best.u) best = {u, len > 0 ? (1 / len) * g : g, lead, false};
    }
    return best;
}

}  // namespace jet

/// The jet at the origin among jets on all sides of it: interpolation, not marching.
///
/// Every neighbor carries its jet to the origin; the results are blended. Where two fronts meet,
/// each is blended by itself and the lesser value counts.
/// @param weight one per neighbor, > 0; further entries 0
inline Jet blendJets(const JetNeighbors& all, const std::array<float, JetNeighbors::kMax>& weight) {
    if (all.count() == 0) return {};
    jet::Four gx{}, gy{}, total{};
    for (int k = 0; k < all.groups(); ++k) {
        const auto n = all.group(k);
        const jet::Four w{weight[std::size_t(4 * k)], weight[std::size_t(4 * k + 1)],
                          weight[std::size_t(4 * k + 2)], weight[std::size_t(4 * k + 3)]};
        gx += w * n.gx, gy += w * n.gy, total += w;
    }
    const Vec2f mean{jet::sum(gx), jet::sum(gy)};
    const float len = length(mean);
    if (!(len > 0)) return jet::blendFronts(all, weight);
    const Vec2f g = (1 / len) * mean;
    jet::Four value{};
    for (int k = 0; k < all.groups(); ++k) {
        const auto n = all.group(k);
        const jet::Four w{weight[std::size_t(4 * k)], weight[std::size_t(4 * k + 1)],
                          weight[std::size_t(4 * k + 2)], weight[std::size_t(4 * k + 3)]};
        const jet::Four cosine = g.x * n.gx + g.y * n.gy;
        const auto other = (cosine < jet::kSameFront) & (w > 0);
        if (other[0] | other[1] | other[2] | other[3]) return jet::blendFronts(all, weight);
        value += w * (n.u + ((g.x + n.gx) * n.ax + (g.y + n.gy) * n.ay) / (1 + cosine));
    }
    return {all.base() + double(jet::sum(value) / jet::sum(total)), g, 0, false};
}

}  // namespace igeo
