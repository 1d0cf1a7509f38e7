#include <igeo/surface/band_bounds.h>
#include <support/catch.h>
#include <support/expect_error.h>

#include <cmath>

namespace igeo::test {
namespace {

const double kSqrt3 = std::sqrt(3.0);

}  // namespace

TEST_CASE("bandBounds: the smaller of radius of curvature and reach") {
    const BandBounds round = bandBounds(0.1, 3, 3);
    CHECK(round.lower == kSqrt3);
    CHECK(round.upper == Approx(10).epsilon(1e-14));
    CHECK(round.resolved);
    CHECK(round.why.find("curvature") != std::string::npos);

    const BandBounds thin = bandBounds(0.1, 2.5, 3);
    CHECK(thin.upper == 2.5);
    CHECK(thin.resolved);
    CHECK(thin.why.find("two sheets") != std::string::npos);

    // A reach of the half-width itself is no reach: psi is not known beyond.
    CHECK(bandBounds(0.01, 3, 3).upper == Approx(100).epsilon(1e-14));
    // Nothing bends: any width is right.
    CHECK(bandBounds(0, 3, 3).upper == 1e6);
    CHECK(bandBounds(1e-9, 3, 3).upper == 1e6);
}

TEST_CASE("bandBounds: an unresolved surface leaves sqrt(3)") {
    for (const BandBounds& b : {bandBounds(1, 3, 3), bandBounds(0.1, 1, 3)}) {
        CHECK(!b.resolved);
        CHECK(b.upper == kSqrt3);
        CHECK(defaultBandWidth(1, 1, b) == kSqrt3);
        CHECK(requireBandWidth(kSqrt3, b, 1) == kSqrt3);
    }
}

TEST_CASE("defaultBandWidth: powers of the radius, within the bounds") {
    const double k = 1.0 / 40;
    const BandBounds b = bandBounds(k, 9, 9);
    CHECK(defaultBandWidth(1, k, b) == Approx(std::pow(40.0, 0.3)).epsilon(1e-14));
    CHECK(defaultBandWidth(2, k, b) == kSqrt3);
    CHECK(defaultBandWidth(2, 1e-4, bandBounds(1e-4, 9, 9)) ==
          Approx(std::pow(1e4, 0.12)).epsilon(1e-14));
    // Never beyond 6 voxels, nor up to the upper bound.
    CHECK(defaultBandWidth(1, 1e-5, bandBounds(1e-5, 9, 9)) == 6);
    CHECK(defaultBandWidth(1, 0, bandBounds(0, 9, 9)) == 6);
    const BandBounds thin = bandBounds(k, 2, 3);
    CHECK(defaultBandWidth(1, k, thin) < 2);
    CHECK(defaultBandWidth(1, k, thin) > 1.99);
}

TEST_CASE("requireBandWidth: holds M&S (14) and explains itself") {
    const BandBounds b = bandBounds(0.2, 4, 5);
    CHECK(requireBandWidth(2.5, b, 0.1) == 2.5);
    // sqrt(3) typed with a few digits counts as sqrt(3).
    CHECK(requireBandWidth(1.732, b, 0.1) == kSqrt3);
    CHECK(requireBandWidth(std::nextafter(4.0, 0.0), b, 0.1) < 4);
    const auto kind = Error::Kind::InvalidArgument;
    expectError(kind, {"h = 0.1 (1 voxels)", "M&S (14)", "sqrt(3) voxels", "0.4 (4 voxels)"},
                [&] { requireBandWidth(1, b, 0.1); });
    expectError(kind, {"two sheets", "leave SolverOptions::band out"},
                [&] { requireBandWidth(4, b, 0.1); });
    expectError(kind, {"curvature"}, [&] { requireBandWidth(12, bandBounds(0.1, 3, 3), 0.1); });
    expectError(kind, {"take smaller voxels"},
                [&] { requireBandWidth(3, bandBounds(1, 3, 3), 0.1); });
    expectError(kind, {}, [&] { requireBandWidth(std::nan(""), b, 0.1); });
    expectError(kind, {}, [&] { requireBandWidth(-2, b, 0.1); });
}

}  // namespace igeo::test
