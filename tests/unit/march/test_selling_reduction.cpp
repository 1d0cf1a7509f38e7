// Selling's reduction against its definition, for forms of any direction and ratio.
#include <igeo/march/detail/selling_reduction.h>
#include <support/catch.h>

#include <cmath>
#include <cstdlib>

namespace igeo::test {
namespace {

/// Eigenvalue 1 at `angle`, ratio^2 across.
Form2 form(double angle, double ratio) {
    const double c = std::cos(angle), s = std::sin(angle), r2 = ratio * ratio;
    return {c * c + r2 * s * s, (1 - r2) * c * s, s * s + r2 * c * c};
}

int determinant(Vec2i a, Vec2i b) { return a.x * b.y - a.y * b.x; }

/// The weights rho_k >= 0 of G^-1 = sum_k rho_k e_k e_k^T for an obtuse superbase of G.
std::array<double, 3> dualWeights(const Form2& g, const Superbase& e) {
    const double det = g.xx * g.yy - g.xy * g.xy;
    return {-g(e[1], e[2]) / det, -g(e[2], e[0]) / det, -g(e[0], e[1]) / det};
}

}  // namespace

TEST_CASE("Selling's superbase is obtuse, and decomposes the dual metric with weights >= 0") {
    for (const double ratio : {1.0, 1.5, 3.0, 20.0, 1000.0})
        for (int k = 0; k < 360; ++k) {
            const Form2 g = form(0.0174533 * k, ratio);
            const Superbase e = obtuseSuperbase(g);
            INFO("ratio " << ratio << ", angle " << k);
            CHECK(e[0].x + e[1].x + e[2].x == 0);
            CHECK(e[0].y + e[1].y + e[2].y == 0);
            CHECK(std::abs(determinant(e[0], e[1])) == 1);
            for (std::size_t i = 0; i < 3; ++i) CHECK(g(e[i], e[(i + 1) % 3]) <= 0);

            const std::array<double, 3> rho = dualWeights(g, e);
            double xx = 0, xy = 0, yy = 0;
            for (std::size_t i = 0; i < 3; ++i) {
                CHECK(rho[i] >= 0);
                xx += rho[i] * e[i].x * e[i].x;
                xy += rho[i] * e[i].x * e[i].y;
                yy += rho[i] * e[i].y * e[i].y;
            }
            // G^-1 = (yy, -xy, xx) / det; its largest eigenvalue is 1, and the products cancel by
            // as much as ratio^2 in g's entries.
            const double det = g.xx * g.yy - g.xy * g.xy, tolerance = 1e-15 * ratio * ratio * 100;
            CHECK(std::abs(xx - g.yy / det) <= tolerance);
            CHECK(std::abs(xy + g.xy / det) <= tolerance);
            CHECK(std::abs(yy - g.xx / det) <= tolerance);
        }
}

TEST_CASE("Selling's superbase of the square and of the hexagonal lattice") {
    // Nothing to do for the square lattice: its first superbase has a right angle.
    const Superbase square = obtuseSuperbase({});
    CHECK(determinant(square[0], square[1]) == 1);
    CHECK(dualWeights({}, square) == std::array<double, 3>{1, 1, 0});
    // All products alike, -1/2: three equal weights (2/3 each, as det = 3/4).
    const Form2 hexagonal{1, -0.5, 1};
    for (const double rho : dualWeights(hexagonal, obtuseSuperbase(hexagonal)))
        CHECK(std::abs(rho - 2.0 / 3) < 1e-15);
}

TEST_CASE("Selling's reduction ends for forms next to singular") {
    // Ratios of 1e6 at rational and irrational slopes: the offsets are long, but there are some.
    for (const double angle : {0.0, 0.785398163397448, 1.1, 3.0}) {
        const Form2 g = form(angle, 1e6);
        const Superbase e = obtuseSuperbase(g);
        for (std::size_t i = 0; i < 3; ++i) CHECK(g(e[i], e[(i + 1) % 3]) <= 0);
    }
}

}  // namespace igeo::test
