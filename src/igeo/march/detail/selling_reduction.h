/// Selling's reduction of a metric on a lattice of the plane: no grid, no surface.
///
/// A superbase is three integer vectors of sum zero, any two of which are a basis of the lattice.
/// Where it is obtuse (no two at an acute angle in the metric G), its six vectors +-e_k are those
/// by which the dual metric decomposes, G^-1 = sum_k rho_k e_k e_k^T with rho_k >= 0, and
/// neighboring ones enclose no obtuse angle: the stencil of J.-M. Mirebeau, Anisotropic fast
/// marching on Cartesian grids using lattice basis reduction, SIAM J. Numer. Anal. 52 (2014), and
/// Riemannian fast marching on Cartesian grids using Voronoi's first reduction of quadratic forms,
/// SIAM J. Numer. Anal. 57 (2019).
#pragma once

#include <array>

namespace igeo {

struct Vec2i {
    int x = 0, y = 0;
    friend Vec2i operator-(Vec2i a, Vec2i b) { return {a.x - b.x, a.y - b.y}; }
    friend Vec2i operator-(Vec2i a) { return {-a.x, -a.y}; }
};

/// A symmetric, positive definite form of the plane.
struct Form2 {
    double xx = 1, xy = 0, yy = 1;
    double operator()(Vec2i a, Vec2i b) const {
        return xx * a.x * b.x + xy * (double(a.x) * b.y + double(a.y) * b.x) + yy * a.y * b.y;
    }
};

using Superbase = std::array<Vec2i, 3>;

/// The obtuse superbase of Z^2: while two of its vectors are at an acute angle, negate one of them
/// and let the third compensate. Every round shortens |e0|^2 + |e1|^2 + |e2|^2 by four times their
/// product, so the loop ends, after O(log of the ratio of g's eigenvalues) rounds.
/// @param g  positive definite
inline Superbase obtuseSuperbase(const Form2& g) {
    Superbase e{Vec2i{1, 0}, Vec2i{0, 1}, Vec2i{-1, -1}};
    for (int settled = 0, k = 0; settled < 3; k = (k + 1) % 3) {
        Vec2i &a = e[std::size_t(k)], &b = e[std::size_t((k + 1) % 3)],
              &c = e[std::size_t((k + 2) % 3)];
        if (g(a, b) > 0) {
            c = a - b;
            a = -a;
            settled = 0;
        } else {
            ++settled;
        }
    }
    return e;
}

}  // namespace igeo
