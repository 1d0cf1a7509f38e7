/// The fit of scheme `jet`: the jet at a node by weighted least squares over one front.
///
/// For a circular front in the plane with directions g, g_j at two of its points, a_j apart,
///
///     u - u_j = (g + g_j) . a_j / (1 + g . g_j)                                  (circular step)
///
/// exactly, and for a straight front as its limit (docs/method.md, "2. Circular step"). The
/// trapezoid rule (g + g_j) . a_j / 2 misses a^3 / (4 r^2) next to a source, and that stays for
/// good.
///
/// Each neighbor gives the equation u - f_j g . a_j = u_j + f_j g_j . a_j, f_j = 1 / (1 + g . g_j),
/// linear in (u, g) once f_j is taken from the round before. Its weight is cos^2 of the angle
/// between a_j and the direction of travel over |a_j|^2 + 0.1, so that neighbors straight behind
/// the node decide. A small Tikhonov term pulls g to the predicted direction where the neighbors
/// leave it open.
#pragma once

#include <igeo/march/detail/jet_neighbors.h>

namespace igeo::jet {

/// Where the neighbors' directions, bent as circles about a source at distance u, point at the
/// origin: weighted mean of r_j g_j + a_j over the neighbors of the front of direction `start`. Not
/// normalized.
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

/// One round of the fit: the direction that solves the normal equations with f_j and the weights
/// taken from the direction g. Not normalized: their determinant is left out, as |g| = 1 is known.
/// @return 0 where fewer than two neighbors of the front lie behind the node
inline Vec2f solveDirection(const JetNeighbors& all, Vec2f g, Vec2f predicted) {
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
    if (used < 2) return {};
    // Eliminate u.
    const float w = sum(s0), ux = sum(sx), uy = sum(sy), ub = sum(b0), inverse = 1 / w;
    const float pull = all.pull * w;
    const float axx = sum(sxx) - ux * ux * inverse + pull, axy = sum(sxy) - ux * uy * inverse,
                ayy = sum(syy) - uy * uy * inverse + pull;
    const float rx = sum(bx) - ux * ub * inverse + pull * predicted.x,
                ry = sum(by) - uy * ub * inverse + pull * predicted.y;
    return {rx * ayy - ry * axy, ry * axx - rx * axy};
}

/// The jet of a front whose direction g is known: u is the weighted mean of what its neighbors say
/// by the circular step.
/// @param residual  standard deviation of what they say, by the same weights
/// @return u = +inf where no neighbor of the front lies behind the node
inline Jet evaluateFit(const JetNeighbors& all, Vec2f g, float& residual) {
    // Neighbors to the left and right of the ray; straight behind counts for both.
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
    Jet jet;
    if (!(w > 0)) return jet;
    const float u = sum(value) / w;
    residual = std::sqrt(std::max(sum(square) / w - u * u, 0.0f));
    jet.u = all.base() + double(u);
    jet.g = g;
    jet.fromBothSides = left && right;
    return jet;
}

/// The jet at the origin of the front that has direction `start` at one of the neighbors, in two
/// rounds.
/// @param residual  weighted root mean square of the equations' misfits, relative to the weights
/// @return u = +inf where fewer than two neighbors are behind the node, or they do not agree
inline Jet fitFront(const JetNeighbors& all, Vec2f start, float& residual) {
    constexpr int kRounds = 2;
    const Vec2f mean = predictDirection(all, start);
    const float meanLength = length(mean);
    if (!(meanLength > 0)) return {};
    const Vec2f predicted = (1 / meanLength) * mean;
    Vec2f g = predicted;
    for (int round = 0; round < kRounds; ++round) {
        const Vec2f next = solveDirection(all, g, predicted);
        const float len = length(next);
        if (!(len > 0) || dot(next, g) < kSameFront * len) return {};
        g = (1 / len) * next;
    }
    return evaluateFit(all, g, residual);
}

}  // namespace igeo::jet
