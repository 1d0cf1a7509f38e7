/// Least-squares fit of a quadric to points near a plane.
#pragma once

#include <igeo/base/symmetric_eigen.h>
#include <igeo/base/types.h>

#include <array>
#include <cmath>
#include <cstddef>

namespace igeo {

/// f(d) = value + gradient . d + d . H d, d relative to the center of the fit: approximately the
/// signed distance to the fitted surface.
struct Quadric {
    double value = 0;
    Vec3d gradient;
    Vec3d diagonal, mixed;  ///< H: xx, yy, zz; xy, xz, yz

    Vec3d bend(const Vec3d& d) const {
        return {diagonal.x * d.x + mixed.x * d.y + mixed.y * d.z,
                mixed.x * d.x + diagonal.y * d.y + mixed.z * d.z,
                mixed.y * d.x + mixed.z * d.y + diagonal.z * d.z};
    }
    double at(const Vec3d& d) const { return value + dot(gradient + bend(d), d); }
    Vec3d gradientAt(const Vec3d& d) const { return gradient + 2.0 * bend(d); }
    /// The same function, relative to a center at d from its own.
    Quadric movedBy(const Vec3d& d) const { return {at(d), gradientAt(d), diagonal, mixed}; }
    Quadric operator-() const { return {-value, -gradient, -diagonal, -mixed}; }
};

/// Least squares for the height over a plane, z = c0 + c1 u + c2 v + c3 u^2 + c4 u v + c5 v^2.
class QuadricFit {
public:
    /// @param radius  divisor of u and v, which makes all terms of similar size
    QuadricFit(const Vec3d& normal, double radius) : n_(normal), radius_(radius) {
        s_ = anyNormalTo(n_);
        t_ = cross(n_, s_);
    }

    /// @param d  a point, relative to the center
    void add(const Vec3d& d, double weight) {
        const auto phi = basis(d);
        const double z = dot(n_, d);
        for (std::size_t a = 0; a < 6; ++a) {
            for (std::size_t b = 0; b <= a; ++b) matrix_[a][b] += weight * phi[a] * phi[b];
            right_[a] += weight * phi[a] * z;
        }
    }

    /// Solves for the coefficients, in units of the radius. Call before the functions below.
    void solve() {
        // Terms that the points hardly determine come out small; others lose 1e-6 of their value.
        // Half as much for u v makes the penalty the norm of the Hessian, which does not depend on
        // the axes in the plane.
        const double ridge = 1e-6 * matrix_[0][0];
        for (const std::size_t a : {1u, 2u, 3u, 5u}) matrix_[a][a] += ridge;
        matrix_[4][4] += ridge / 2;
        for (std::size_t a = 0; a < 6; ++a)
            for (std::size_t b = 0; b <= a; ++b) {
                double& m = matrix_[a][b];
                for (std::size_t k = 0; k < b; ++k) m -= matrix_[a][k] * matrix_[b][k];
                m = a == b ? std::sqrt(m) : m / matrix_[b][b];
            }
        c_ = solved(right_);
    }

    /// The share of the center point, of weight 1, in its own height: without it the fit would pass
    /// farther from it, by a factor of 1 / (1 - share).
    double ownShare() const { return solved({1, 0, 0, 0, 0, 0})[0]; }

    /// Coordinates along the plane.
    std::array<double, 2> flat(const Vec3d& d) const { return {dot(s_, d), dot(t_, d)}; }

    /// Height of a point over the fitted surface.
    double residual(const Vec3d& d) const {
        const auto phi = basis(d);
        double z = dot(n_, d);
        for (std::size_t a = 0; a < 6; ++a) z -= c_[a] * phi[a];
        return z;
    }
    /// Unit normal of the fitted surface above the center.
    Vec3d normal() const {
        return normalized(n_ - (c_[1] / radius_) * s_ - (c_[2] / radius_) * t_);
    }
    /// The larger principal curvature there, unsigned; for small slopes.
    double curvature() const {
        return symmetricEigen(2 * c_[3], c_[4], 2 * c_[5]).largestMagnitude() / (radius_ * radius_);
    }
    /// The fitted surface as f = 0 with |grad f| = 1 at the center.
    Quadric quadric() const {
        const Vec3d g = n_ - (c_[1] / radius_) * s_ - (c_[2] / radius_) * t_;
        const double scale = 1 / length(g), bend = -scale / (radius_ * radius_);
        const double uu = bend * c_[3], uv = bend * c_[4] / 2, vv = bend * c_[5];
        auto entry = [&](int a, int b) {
            return uu * s_[a] * s_[b] + uv * (s_[a] * t_[b] + t_[a] * s_[b]) + vv * t_[a] * t_[b];
        };
        return {-scale * c_[0],
                scale * g,
                {entry(0, 0), entry(1, 1), entry(2, 2)},
                {entry(0, 1), entry(0, 2), entry(1, 2)}};
    }

private:
    using Terms = std::array<double, 6>;

    /// By the Cholesky factor in matrix_.
    Terms solved(Terms x) const {
        for (std::size_t a = 0; a < 6; ++a) {
            for (std::size_t k = 0; k < a; ++k) x[a] -= matrix_[a][k] * x[k];
            x[a] /= matrix_[a][a];
        }
        for (std::size_t a = 6; a-- > 0;) {
            for (std::size_t b = a + 1; b < 6; ++b) x[a] -= matrix_[b][a] * x[b];
            x[a] /= matrix_[a][a];
        }
        return x;
    }

    Terms basis(const Vec3d& d) const {
        const double u = dot(s_, d) / radius_, v = dot(t_, d) / radius_;
        return {1, u, v, u * u, u * v, v * v};
    }

    Vec3d n_, s_, t_;
    double radius_;
    std::array<Terms, 6> matrix_{};  ///< lower half; after solve() its Cholesky factor
    Terms right_{}, c_{};
};

}  // namespace igeo
