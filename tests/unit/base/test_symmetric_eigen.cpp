// Eigenvalues and eigenvectors against matrices made of them.
#include <igeo/base/symmetric_eigen.h>
#include <support/catch.h>

#include <random>

namespace igeo {
namespace {

Vec3d product(const SymmetricMatrix3& m, const Vec3d& v) {
    return {m.xx * v.x + m.xy * v.y + m.xz * v.z, m.xy * v.x + m.yy * v.y + m.yz * v.z,
            m.xz * v.x + m.yz * v.y + m.zz * v.z};
}

}  // namespace

TEST_CASE("symmetricEigen: three rows, to rounding of the largest eigenvalue") {
    std::mt19937 random(5);
    std::uniform_real_distribution<double> entry(-1, 1);
    for (const double scale : {1.0, 1e-9, 1e9}) {
        for (int k = 0; k < 1000; ++k) {
            SymmetricMatrix3 m{scale * entry(random), scale * entry(random), scale * entry(random),
                               scale * entry(random), scale * entry(random), scale * entry(random)};
            if (k % 3 == 0) m.xy = m.xz = 0;
            if (k % 5 == 0) m.zz = m.yy, m.yz = 0;
            const SymmetricEigen3 e = symmetricEigen(m);
            CHECK(e.value == symmetricEigenvalues(m));
            CHECK(e.value[0] <= e.value[1]);
            CHECK(e.value[1] <= e.value[2]);
            for (std::size_t i = 0; i < 3; ++i) {
                CHECK(length(product(m, e.vector[i]) - e.value[i] * e.vector[i]) < 4e-15 * scale);
                for (std::size_t j = 0; j < 3; ++j)
                    CHECK(std::abs(dot(e.vector[i], e.vector[j]) - double(i == j)) < 4e-15);
            }
        }
    }
}

TEST_CASE("symmetricEigen: two rows") {
    std::mt19937 random(6);
    std::uniform_real_distribution<double> entry(-1, 1);
    for (int k = 0; k < 1000; ++k) {
        const double xx = entry(random), xy = k % 4 ? entry(random) : 0, yy = entry(random);
        const SymmetricEigen2 e = symmetricEigen(xx, xy, yy);
        CHECK(std::abs(xx * e.x + xy * e.y - e.largest() * e.x) < 4e-15);
        CHECK(std::abs(xy * e.x + yy * e.y - e.largest() * e.y) < 4e-15);
        CHECK(std::abs(e.least() + e.largest() - (xx + yy)) < 4e-15);
        CHECK(std::abs(e.least() * e.largest() - (xx * yy - xy * xy)) < 4e-15);
        CHECK(e.largestMagnitude() == std::max(std::abs(e.least()), std::abs(e.largest())));
    }
    const SymmetricEigen2 same = symmetricEigen(3, 0, 3);
    CHECK((same.radius == 0 && same.x == 0 && same.y == 0));
}

TEST_CASE("largestEigenvalueOfUnitDeterminant keeps its digits next to 1") {
    for (const double s : {1.0, 1 + 1e-12, 1.5, 20.0}) {
        // s and 1 / s: trace / 2 - 1 = (s - 1)^2 / (2 s).
        const double excess = (s - 1) * (s - 1) / (2 * s);
        CHECK(std::abs(largestEigenvalueOfUnitDeterminant(excess) - s) < 4e-16 * s * s);
    }
}

}  // namespace igeo
