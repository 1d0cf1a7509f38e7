/// The local solve of scheme `jet`, alone: no grid, no states, no surface.
///
/// A node and its neighbours are seen in the node's tangent plane, the surface between them laid
/// out flat: the node at the origin, neighbour j at -a_j, its gradient turned along with it. There
/// the solve looks for the jet (value and gradient) at the origin that continues its neighbours'
/// jets.
#pragma once

#include <igeo/types.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace igeo {

struct Vec2d {
    double x = 0, y = 0;
    friend Vec2d operator+(Vec2d a, Vec2d b) { return {a.x + b.x, a.y + b.y}; }
    friend Vec2d operator-(Vec2d a, Vec2d b) { return {a.x - b.x, a.y - b.y}; }
    friend Vec2d operator*(double s, Vec2d a) { return {s * a.x, s * a.y}; }
};
inline double dot(Vec2d a, Vec2d b) { return a.x * b.x + a.y * b.y; }
inline double cross(Vec2d a, Vec2d b) { return a.x * b.y - a.y * b.x; }
inline double length(Vec2d a) { return std::sqrt(dot(a, a)); }

/// A neighbour in the flat picture. Gradients are unit: d over the weight.
struct JetNeighbour {
    Vec2d a;     ///< from the neighbour to the node
    Vec2d g;     ///< direction of travel at the neighbour
    double u;    ///< its value, divided by the weight
    double len;  ///< |a|
};

/// Value and direction of travel.
struct Jet {
    double u = kInfinity;
    Vec2d g;
    int from = -1;         ///< a neighbour whose front it continues
    bool guarded = false;  ///< from the guard, not from the fit
};

/// Up to 26 neighbours.
struct JetNeighbours {
    std::array<JetNeighbour, 26> at;
    int count = 0;
    bool smooth = true;  ///< S is smooth between the node and all of them
    void add(const JetNeighbour& n) { at[std::size_t(count++)] = n; }
};

/// u_i - u_j for a circular (or straight) front with directions g_i, g_j at its ends: exact in the
/// plane, (g_i + g_j) . a / (1 + g_i . g_j). The trapezoid rule (g_i + g_j) . a / 2 is its limit
/// for a straight front; what it misses near a source, a^3 / (4 r^2), would stay for good.
inline double circularStep(Vec2d gi, const JetNeighbour& n) {
    return dot(gi + n.g, n.a) / (1 + dot(gi, n.g));
}

/// Value carried forward from one neighbour alone by the circle about the source at distance u.
inline double carry(const JetNeighbour& n) {
    const double along = dot(n.g, n.a), across2 = n.len * n.len - along * along;
    if (along <= 0) return n.u + n.len;
    const double r = n.u + along;
    return r + across2 / (r + std::sqrt(r * r + across2));
}

namespace jet {

// Directions further apart than 45 degrees belong to two fronts.
constexpr double kSameFront = 0.7;

/// Weighted least squares for the jet at the origin over the neighbours of one front.
///
/// Equations u - f a.g / 2 = u_j + f a.g_j / 2, f = 2 / (1 + g.g_j), linear in (u, g) once f is
/// taken from the last round. Weights: cos^2 of the angle between a_j and the direction of travel
/// over |a|^2 + 0.1, so that neighbours straight behind the node decide.
/// @param start direction of travel to begin with, unit
/// @param used  which neighbours were behind the node and of this front
/// @return u = +inf where fewer than 2 neighbours qualify or the front turns by more than 45
/// degrees
inline Jet fitFront(const JetNeighbours& all, Vec2d start, double& residual) {
    constexpr int kRounds = 3;
    constexpr double kPull = 0.005;  // Tikhonov: towards the last direction
    Jet jet;
    Vec2d g = start, mean{};
    for (int k = 0; k < all.count; ++k) {
        const JetNeighbour& n = all.at[std::size_t(k)];
        const double along = dot(n.g, n.a);
        if (dot(start, n.g) < kSameFront || along <= 0) continue;
        // Where the circle about a source at distance u would send it.
        const Vec2d way = n.u * n.g + n.a;
        mean = mean + (along * along / (n.len * n.len * (n.len * n.len + 0.1) * length(way))) * way;
    }
    if (!(dot(mean, mean) > 0)) return jet;
    g = (1 / length(mean)) * mean;
    const Vec2d predicted = g;
    double sum = 0, value = 0;
    for (int round = 0; round < kRounds; ++round) {
        // Normal equations, u relative to the first neighbour's so that no digits are lost.
        double s0 = 0, sx = 0, sy = 0, sxx = 0, sxy = 0, syy = 0, b0 = 0, bx = 0, by = 0;
        const double origin = all.at[0].u;
        int used = 0;
        for (int k = 0; k < all.count; ++k) {
            const JetNeighbour& n = all.at[std::size_t(k)];
            const double cosine = dot(g, n.g), along = dot(g, n.a);
            if (cosine < kSameFront || along <= 0) continue;
            const double w = along * along / (n.len * n.len * (n.len * n.len + 0.1));
            const double f = 1 / (1 + cosine);
            const Vec2d c = -f * n.a;
            const double rhs = n.u - origin + f * dot(n.a, n.g);
            s0 += w, sx += w * c.x, sy += w * c.y;
            sxx += w * c.x * c.x, sxy += w * c.x * c.y, syy += w * c.y * c.y;
            b0 += w * rhs, bx += w * rhs * c.x, by += w * rhs * c.y;
            ++used;
        }
        if (used < 2) return jet;
        // Eliminate u, pull g towards the last direction.
        const double pull = kPull * s0;
        const double axx = sxx - sx * sx / s0 + pull, axy = sxy - sx * sy / s0,
                     ayy = syy - sy * sy / s0 + pull;
        const double rx = bx - sx * b0 / s0 + pull * predicted.x,
                     ry = by - sy * b0 / s0 + pull * predicted.y;
        const double det = axx * ayy - axy * axy;
        Vec2d next{(rx * ayy - ry * axy) / det, (ry * axx - rx * axy) / det};
        const double len = length(next);
        if (!(len > 0.5)) return jet;
        next = (1 / len) * next;
        if (dot(next, g) < kSameFront) return jet;
        g = next;
        sum = s0;
    }
    residual = 0, sum = 0, value = 0;
    const double origin = all.at[0].u;
    for (int k = 0; k < all.count; ++k) {
        const JetNeighbour& n = all.at[std::size_t(k)];
        const double along = dot(g, n.a);
        if (dot(g, n.g) < kSameFront || along <= 0) continue;
        const double w = along * along / (n.len * n.len * (n.len * n.len + 0.1));
        const double v = n.u - origin + circularStep(g, n);
        sum += w, value += w * v, residual += w * v * v;
    }
    if (!(sum > 0)) return jet;
    value /= sum;
    residual = std::sqrt(std::max(residual / sum - value * value, 0.0));
    jet.u = origin + value;
    jet.g = g;
    return jet;
}

/// Least value over the segment between two neighbours: cubic Hermite values on it, straight on
/// from there to the origin (Fermat's principle, as in the jet marching of Potter and Cameron
/// 2021).
inline bool lowerBySegment(const JetNeighbour& p, const JetNeighbour& q, Jet& best) {
    // Between directions further apart than that a front may fold: no interpolation.
    if (dot(p.g, q.g) < 0.9) return false;
    const Vec2d e = p.a - q.a;  // from p to q, as both are at -a
    const double du = q.u - p.u, mp = dot(p.g, e), mq = dot(q.g, e);
    auto valueAt = [&](double s) {
        const double t = 1 - s;
        return p.u + s * s * (3 - 2 * s) * du + s * t * (t * mp - s * mq);
    };
    auto total = [&](double s) { return valueAt(s) + length(p.a - s * e); };
    // Golden section: 8 steps leave 2 % of the segment, where the minimum is flat.
    constexpr double kGolden = 0.6180339887498949;
    double lo = 0, hi = 1, s1 = 1 - kGolden, s2 = kGolden, f1 = total(s1), f2 = total(s2);
    for (int k = 0; k < 8; ++k) {
        if (f1 < f2) {
            hi = s2, s2 = s1, f2 = f1;
            s1 = hi - kGolden * (hi - lo), f1 = total(s1);
        } else {
            lo = s1, s1 = s2, f1 = f2;
            s2 = lo + kGolden * (hi - lo), f2 = total(s2);
        }
    }
    const double s = f1 < f2 ? s1 : s2, v = std::min(f1, f2);
    if (!(v < best.u)) return false;
    const Vec2d way = p.a - s * e;
    best.u = v;
    best.g = (1 / length(way)) * way;
    return true;
}

}  // namespace jet

/// The guard: the least of u_j + |a_j| over the neighbours, and over the segments between them.
/// Never below the values it starts from; first order at worst, second where the front is smooth.
inline Jet guardedUpdate(const JetNeighbours& all) {
    Jet best;
    best.guarded = true;
    for (int k = 0; k < all.count; ++k) {
        const JetNeighbour& n = all.at[std::size_t(k)];
        if (n.u + n.len < best.u) best.u = n.u + n.len, best.g = (1 / n.len) * n.a, best.from = k;
    }
    for (int j = 0; j < all.count; ++j)
        for (int k = 0; k < j; ++k) {
            const JetNeighbour &p = all.at[std::size_t(j)], &q = all.at[std::size_t(k)];
            // Only segments that can matter: short ones, seen from the node at less than 120
            // degrees.
            const Vec2d e = p.a - q.a;
            if (dot(e, e) > 2.3 || dot(p.a, q.a) < -0.5 * p.len * q.len) continue;
            if (std::min(p.u, q.u) >= best.u) continue;
            if (jet::lowerBySegment(p, q, best)) best.from = j;
        }
    return best;
}

/// The jet at the origin.
///
/// Fits the front of the neighbour that carries the least value; where other neighbours belong to
/// another front (a cut locus), fits theirs as well and takes the lesser. A fit that does not agree
/// with its neighbours (residual above 2 % of a voxel), or says more than the straight way from a
/// neighbour, is replaced by the guard.
/// @return u = +inf without neighbours
inline Jet jetUpdate(const JetNeighbours& all) {
    constexpr double kResidual = 0.02, kSlack = 1e-3, kDoubt = 2e-3, kAgree = 0.01;
    Jet best;
    if (all.count == 0) return best;
    std::array<double, 26> carried;
    double bound = kInfinity;
    int first = 0;
    for (int k = 0; k < all.count; ++k) {
        const auto s = std::size_t(k);
        carried[s] = carry(all.at[s]);
        bound = std::min(bound, all.at[s].u + all.at[s].len);
        if (carried[s] < carried[std::size_t(first)]) first = k;
    }
    double worst = 0;
    auto tryFront = [&](int k) {
        double residual = 0;
        Jet jet = jet::fitFront(all, all.at[std::size_t(k)].g, residual);
        jet.from = k;
        if (!(jet.u <= bound + kSlack) || residual > kResidual) return false;
        worst = std::max(worst, residual);
        if (jet.u < best.u) best = jet;
        return true;
    };
    bool trusted = tryFront(first);
    int second = -1;
    for (int k = 0; k < all.count; ++k)
        if (dot(all.at[std::size_t(k)].g, all.at[std::size_t(first)].g) < jet::kSameFront &&
            (second < 0 || carried[std::size_t(k)] < carried[std::size_t(second)]))
            second = k;
    if (second >= 0 && carried[std::size_t(second)] < best.u + 0.2)
        trusted = tryFront(second) && trusted;
    if (trusted && all.smooth && worst < kDoubt) return best;
    const Jet guard = guardedUpdate(all);
    const bool agree = std::abs(best.u - guard.u) < (trusted ? kAgree : 0);
    return agree ? best : guard;
}

/// The jet at the origin among jets on all sides of it: interpolation, not marching.
///
/// Every neighbour carries its jet to the origin; the results are blended. Where two fronts meet,
/// each is blended by itself and the lesser value counts.
/// @param weight one per neighbour, > 0
inline Jet blendJets(const JetNeighbours& all, const std::array<double, 26>& weight) {
    Jet best;
    std::array<bool, 26> done{};
    for (int front = 0; front < 2; ++front) {
        // The front of the neighbour that says least of those not blended yet.
        int lead = -1;
        double least = kInfinity;
        for (int k = 0; k < all.count; ++k) {
            const JetNeighbour& n = all.at[std::size_t(k)];
            const double said = n.u + dot(n.g, n.a);
            if (!done[std::size_t(k)] && said < least) lead = k, least = said;
        }
        if (lead < 0) break;
        const Vec2d leadG = all.at[std::size_t(lead)].g;
        Vec2d g{};
        double sum = 0, total = 0;
        auto belongs = [&](int k) {
            const Vec2d gk = all.at[std::size_t(k)].g;
            return !done[std::size_t(k)] && (k == lead || dot(gk, leadG) >= jet::kSameFront);
        };
        for (int k = 0; k < all.count; ++k)
            if (belongs(k)) g = g + weight[std::size_t(k)] * all.at[std::size_t(k)].g;
        const double len = length(g);
        for (int k = 0; k < all.count; ++k) {
            if (!belongs(k)) continue;
            const JetNeighbour& n = all.at[std::size_t(k)];
            sum +=
                weight[std::size_t(k)] * (n.u + (len > 0 ? circularStep((1 / len) * g, n) : n.len));
            total += weight[std::size_t(k)];
            done[std::size_t(k)] = true;
        }
        if (sum / total < best.u) best = {sum / total, len > 0 ? (1 / len) * g : g, lead, false};
    }
    return best;
}

}  // namespace igeo
