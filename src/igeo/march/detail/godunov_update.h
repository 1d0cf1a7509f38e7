/// The local solve of the Godunov scheme: no grid, no states.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

namespace igeo {

/// One axis of the upwind difference: the one-sided derivative at the unknown T is coefficient * (T
/// - base), used only where it is positive.
struct UpwindTerm {
    /// m_j of M&S (13), the smaller neighbor along the axis, at order 1; (4 m_j - m'_j) / 3 at
    /// order 2, m'_j one voxel farther: at least m_j
    double base;
    double coefficient;  ///< 1 at order 1, 3/2 at order 2
};

inline UpwindTerm firstOrderTerm(double m) { return {m, 1.0}; }

/// Second-order one-sided difference (3 T - 4 m + mm) / 2, for mm <= m: both upwind of T.
inline UpwindTerm secondOrderTerm(double m, double mm) { return {m + (m - mm) / 3, 1.5}; }

/// Solves sum_j max(coefficient_j (T - base_j), 0)^2 = cost^2 for T over the first `n` terms:
/// M&S (13) in voxel units, P = cost. Terms whose base is not below T drop out, so the result
/// depends only on smaller values (causality).
/// @param terms reordered by base
/// @param n     1 to 3 terms
/// @return T > every value used; the root is unique, because the left side never falls with T
inline double godunovSolve(std::array<UpwindTerm, 3>& terms, int n, double cost) {
    auto order = [&](int i, int j) {
        if (terms[std::size_t(j)].base < terms[std::size_t(i)].base)
            std::swap(terms[std::size_t(i)], terms[std::size_t(j)]);
    };
    if (n > 1) order(0, 1);
    if (n > 2) order(1, 2), order(0, 1);

    // Relative to the first base, so that the squares lose no digits far from the seed.
    const double origin = terms[0].base;
    double t = cost / terms[0].coefficient;  // T - origin from the first term alone
    double a = terms[0].coefficient * terms[0].coefficient, b = 0, c = -cost * cost;
    for (int j = 1; j < n; ++j) {
        const double r = terms[std::size_t(j)].base - origin;
        if (t <= r) break;
        const double w = terms[std::size_t(j)].coefficient * terms[std::size_t(j)].coefficient;
        a += w, b += w * r, c += w * r * r;
        // Negative only by rounding: at T = base_j the terms before do not reach cost^2.
        t = (b + std::sqrt(std::max(b * b - a * c, 0.0))) / a;
    }
    return origin + t;
}

}  // namespace igeo
