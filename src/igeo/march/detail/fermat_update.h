/// The fallback of scheme `jet`, by Fermat's principle: the minimum, over the neighbors and the
/// segments between them, of the value there plus the length of the straight line from there to the
/// node. It is the update of the jet marching method of S. F. Potter and M. K. Cameron, Jet
/// marching methods for solving the eikonal equation, SIAM J. Sci. Comput. 43 (2021).
#pragma once

#include <igeo/march/detail/jet_neighbors.h>

namespace igeo {

namespace jet {

/// The cost across the segment from neighbor p to neighbor q, relative to base(): total(s) =
/// H(s) + |a_p - s e|, 0 <= s <= 1, with e the segment and H the cubic Hermite interpolant of the
/// jets at its ends.
struct Segment {
    Vec2f ap, e;  ///< from p to the node; from p to q (both neighbors are at -a)
    float up, du, mp, mq;

    Segment(const JetNeighbors& all, int p, int q)
        : ap(all.a(p)),
          e(ap - all.a(q)),
          up(all.u(p)),
          du(all.u(q) - up),
          mp(dot(all.g(p), e)),
          mq(dot(all.g(q), e)) {}

    float total(float s) const {
        const float t = 1 - s;
        return up + s * s * (3 - 2 * s) * du + s * t * (t * mp - s * mq) + length(ap - s * e);
    }
    /// A lower bound of total: the cubic falls below its ends by at most 4/27 of the slopes there.
    float bound() const {
        const float along = std::clamp(dot(ap, e) / std::max(dot(e, e), 1e-12f), 0.0f, 1.0f);
        const float dip = (4.0f / 27) * (std::max(-mp, 0.0f) + std::max(mq, 0.0f));
        return up + std::min(du, 0.0f) - dip + length(ap - along * e);
    }
    /// The minimum of total, by golden section: 8 steps locate it to 2 % of the segment, where
    /// total is flat.
    /// @param at  the position of the minimum
    float least(float& at) const {
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
        at = f1 < f2 ? s1 : s2;
        return std::min(f1, f2);
    }
};

/// Whether the segment between two neighbors can matter: it is short, and the node sees it at less
/// than 120 degrees.
inline bool isSegment(const JetNeighbors& all, int p, int q) {
    const Vec2f e = all.a(p) - all.a(q);
    return dot(e, e) <= all.longest2 && dot(all.a(p), all.a(q)) >= -0.5f * all.len(p) * all.len(q);
}

/// Lowers `best`, relative to base(), to the minimum over the segment between neighbors p and q.
/// @param direction  from the minimum to the node
/// @return whether it was lowered
inline bool lowerBySegment(const JetNeighbors& all, int p, int q, float& best, Vec2f& direction) {
    // Directions of two fronts have no interpolant: the front may fold.
    if (dot(all.g(p), all.g(q)) < kSameFront) return false;
    const Segment segment(all, p, q);
    if (segment.bound() >= best) return false;
    float s = 0;
    const float least = segment.least(s);
    if (!(least < best)) return false;
    best = least;
    direction = segment.ap - s * segment.e;
    return true;
}

}  // namespace jet

/// The fallback: the minimum of u_j + |a_j| over the neighbors, and over the segments between them.
/// Never below the values it starts from; at least first order, second where the front is smooth.
/// @return u = +infinity without neighbors
inline Jet fermatUpdate(const JetNeighbors& all) {
    Jet jet;
    jet.usedFallback = true;
    float best = float(kInfinity);
    Vec2f direction;
    int from = -1;  // the neighbor, or an end of the segment
    for (int k = 0; k < all.count(); ++k)
        if (all.u(k) + all.len(k) < best)
            best = all.u(k) + all.len(k), direction = all.a(k), from = k;
    for (int j = 0; j < all.count(); ++j)
        for (int k = 0; k < j; ++k)
            if (jet::isSegment(all, j, k) && std::min(all.u(j), all.u(k)) < best &&
                jet::lowerBySegment(all, j, k, best, direction))
                from = j;
    if (from < 0) return jet;
    jet.u = all.base() + double(best);
    const float len = length(direction);
    jet.g = len > 0 ? (1 / len) * direction : all.g(from);
    return jet;
}

}  // namespace igeo
