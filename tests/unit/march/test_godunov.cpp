// What marchGodunov refuses and promises in small; its accuracy is another label's.
#include <igeo/march/godunov.h>
#include <support/analytic_band.h>
#include <support/catch.h>
#include <support/expect_error.h>

namespace igeo::test {
namespace {

Band flat() { return planeBand({0, 0, 1}, 0, {-20, -20, -3}, {20, 20, 3}, 2); }

}  // namespace

TEST_CASE("marchGodunov: refuses what it cannot march") {
    const Band band = flat();
    const SurfacePoint seed = nearestSurfacePoint(band, {0, 0, 0});
    const auto kind = Error::Kind::InvalidArgument;
    GodunovOptions third;
    third.order = 3;
    expectError(kind, {"order 3"}, [&] { marchGodunov(band, {}, {seed}, third); });
    expectError(kind, {"seed"}, [&] { marchGodunov(band, {}, {}); });
    for (const double limit : {0.0, -1.0, std::nan("")}) {
        GodunovOptions options;
        options.maxDistance = limit;
        expectError(kind, {"largest distance"}, [&] { marchGodunov(band, {}, {seed}, options); });
    }
    Metric metric;
    metric.weight.assign(band.size() - 1, 1);
    expectError(kind, {"weights for a band of"},
                [&] { marchGodunov(band, std::make_shared<Metric>(metric), {seed}); });
    for (const float w : {0.0f, -1.0f, std::nanf(""), float(kInfinity)}) {
        metric.weight.assign(band.size(), 1);
        metric.weight[5] = w;
        expectError(kind, {"weight", "allowed are 1e-15 to 1e+15"},
                    [&] { marchGodunov(band, std::make_shared<Metric>(metric), {seed}); });
    }
    // Cancelled within 16384 nodes.
    const Band large = planeBand({0, 0, 1}, 0, {-50, -50, -3}, {50, 50, 3}, 2);
    struct Stop : Progress {
        bool cancelled() const override { return true; }
    } stop;
    expectError(Error::Kind::Cancelled, {}, [&] {
        marchGodunov(large, {}, {nearestSurfacePoint(large, {0, 0, 0})}, {}, stop);
    });
}

TEST_CASE("marchGodunov: a front along an axis is exact") {
    // One row of voxels: d is the distance itself at either order, on both sides of the seed.
    std::vector<Ijk> row;
    for (int x = -30; x <= 30; ++x) row.push_back({x, 0, 0});
    Band band = bandOfVoxels(row);
    SurfacePoint seed;
    seed.node = band.nodeAt({2, 0, 0});
    seed.pIndex = {2.25, 0, 0};
    for (const int order : {1, 2}) {
        GodunovOptions options;
        options.order = order;
        const Field field = marchGodunov(band, {}, {seed}, options);
        CHECK(field.reached == band.size());
        // 30 sums.
        for (std::size_t k = 0; k < band.size(); ++k)
            REQUIRE(std::abs(field.distance[k] - std::abs(band.ijk(NodeIndex(k)).x - 2.25)) <
                    30 * 4e-15);
    }
}

TEST_CASE("marchGodunov: distances on a plane are within the scheme's error") {
    // The error e grows along a ray by what differences leave out (h = 1 voxel, c and s cosine and
    // sine of its direction): at order 1 e' = 1/2 c s (c + s) / r, at 45 degrees 0.354 / r; so
    // e = 0.354 log(r / r0), with r0 = 3.5 and r = 28.9 at the corner 0.75. At order 2
    // e' = 2 c^2 s^2 / r^2, so e < 0.5 / r0 = 0.15, and about a step at order 1 next to the start
    // disc, 0.354 / r0 = 0.1, as not every node there has two upwind voxels.
    const Band band = flat();
    const SurfacePoint seed = nearestSurfacePoint(band, {0.2, 0.3, 0});
    for (const int order : {1, 2}) {
        GodunovOptions options;
        options.order = order;
        const Field field = marchGodunov(band, {}, {seed}, options);
        double worst = 0;
        for (std::size_t k = 0; k < band.size(); ++k)
            if (band.ijk(NodeIndex(k)).z == 0)
                worst =
                    std::max(worst, std::abs(field.distance[k] -
                                             length(Vec3d(band.ijk(NodeIndex(k))) - seed.pIndex)));
        INFO("order " << order << ": " << worst << " voxels");
        CHECK(worst < (order == 1 ? 0.75 : 0.25));
    }
}

TEST_CASE("marchGodunov: describes its result") {
    const Band band = flat();
    const SurfacePoint seed = nearestSurfacePoint(band, {0, 0, 0});
    GodunovOptions options;
    options.order = 1;
    options.startRadius = 2.5;
    const Field field = marchGodunov(band, {}, {seed}, options);
    CHECK(field.scheme == "godunov, order 1");
    CHECK(field.startRadius == 2.5);
    CHECK(field.seeds.size() == 1);
    CHECK(field.seeds[0].weight == 1);
    CHECK(field.reached == band.size());
    CHECK(field.maxDistance == *std::max_element(field.distance.begin(), field.distance.end()));
    CHECK(!field.stoppedEarly);
}

}  // namespace igeo::test
