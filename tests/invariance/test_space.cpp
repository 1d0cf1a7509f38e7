// Distances do not depend on where the surface lies, how it is turned and how large its units are.
#include <support/catch.h>
#include <support/errors.h>
#include <support/march_cases.h>
#include <support/openvdb.h>
#include <support/shapes.h>

namespace igeo::test {
namespace {

constexpr double kH = 2.5;

const auto kSame = [](const Ijk& v) { return v; };

}  // namespace

TEST_CASE("turns by 90 degrees and reflections leave distances") {
    // The scheme has no preferred axis; sums run in another order, so values differ by roundings.
    // The march may accept nodes in another order where they differ by less than the 6e-8 of its
    // keys, which moves values by that much; 1e-5 leaves a margin for its building up.
    const auto grid = torusGrid();
    const std::vector<Vec3d> points = torusPoints();
    for (const int order : {kJet, 1, 2}) {
        const Band band = bandOf(grid, kH);
        const Field field = march(band, {points[0], points[1]}, order);
        for (const Turn& turn : allTurns()) {
            const Band turned = bandOf(mapVoxels(*grid, turn), kH);
            REQUIRE(turned.size() == band.size());
            const Field other = march(turned, {turn(points[0]), turn(points[1])}, order);
            INFO("order " << order << ", axes " << turn.axis[0] << turn.axis[1] << turn.axis[2]
                          << ", signs " << turn.sign[0] << " " << turn.sign[1] << " "
                          << turn.sign[2]);
            CHECK(worstDifference(field, other, turn) <= roundingTolerance(field, order, 1e-5));
        }
    }
}

TEST_CASE("turns leave the default band and its distances") {
    const auto grid = torusGrid();
    const Turn turn{{1, 2, 0}, {1, -1, 1}};
    for (const int order : {kJet, 1, 2}) {
        const Band band = bandOf(grid, 0, order), turned = bandOf(mapVoxels(*grid, turn), 0, order);
        CHECK(turned.h == band.h);
        const Vec3d seed = torusPoints()[2];
        const Field field = march(band, {seed}, order);
        CHECK(worstDifference(field, march(turned, {turn(seed)}, order), turn) <=
              roundingTolerance(field, order, 1e-5));
    }
}

TEST_CASE("units scaled by a power of two scale distances bitwise") {
    // Divisions by dx are exact, so not a bit of the computation in voxels changes.
    const auto grid = torusGrid();
    const Band band = bandOf(grid, kH);
    for (const int order : {kJet, 1, 2}) {
        const Field field = march(band, torusPoints(), order);
        for (const double factor : {0x1p-10, 0.25, 2.0, 0x1p30}) {
            const Band other = bandOf(inUnits(*grid, factor), kH);
            CHECK(other.transform.dx == factor);
            CHECK(worstDifference(field, march(other, torusPoints(), order), kSame) == 0);
        }
    }
}

TEST_CASE("the voxel size of a turned grid scales with the unit bitwise") {
    // The three sides of a turned voxel differ in their last bits, and what they agree on is
    // rounded.
    for (int k = 0; k < 50; ++k) {
        const double side = 0.7 + 0.011 * k;
        const auto grid = inUnits(*torusGrid(), side);
        grid->setTransform(rotatedTransform(side, {1, 2, 3}, 7.0 * k, {0, 0, 0}));
        const double dx = checkedLevelSet(inUnits(*grid, 0.125)).transform.dx;
        INFO("turned by " << 7 * k);
        CHECK(checkedLevelSet(inUnits(*grid, 32)).transform.dx == 256 * dx);
    }
}

TEST_CASE("units scaled by any factor leave distances in voxels") {
    // psi / dx changes by a float rounding or two, 1.2e-7 of 4 voxels, and seeds move by as much.
    const auto grid = torusGrid();
    const Band band = bandOf(grid, kH);
    for (const int order : {kJet, 1, 2}) {
        const Field field = march(band, torusPoints(), order);
        for (const double factor : {0.01, 0.3, 7.7, 1e6}) {
            const Band other = bandOf(inUnits(*grid, factor), kH);
            CHECK(worstDifference(field, march(other, torusPoints(), order), kSame) <=
                  roundingTolerance(field, order, 1e-6));
        }
    }
}

TEST_CASE("a moved or turned transform leaves distances bitwise") {
    const auto grid = torusGrid();
    const Band band = bandOf(grid, kH);
    for (const int order : {kJet, 1, 2}) {
        const Field field = march(band, torusPoints(), order);
        for (const auto& transform : {rotatedTransform(1, {0, 0, 1}, 0, {1e6, -3.7, 0.123}),
                                      rotatedTransform(1, {1, 2, 3}, 30, {5, -7, 11}),
                                      rotatedTransform(1, {-1, 0.2, 0.1}, 179, {0, 0, 1e-3})}) {
            auto moved = grid->deepCopy();
            moved->setTransform(transform);
            const Band other = bandOf(moved, kH);
            CHECK(worstDifference(field, march(other, torusPoints(), order), kSame) == 0);
        }
    }
}

TEST_CASE("index coordinates shifted by leaves leave distances bitwise") {
    const auto grid = torusGrid();
    const Band band = bandOf(grid, kH);
    for (const int order : {kJet, 1, 2}) {
        const SurfacePoint seed = dyadicSeed(band, torusPoints()[0]);
        const Field field = marchFrom(band, {seed}, order);
        for (const Ijk& by : {Ijk{8, -16, 24}, Ijk{-4096, 4088, 1 << 20}}) {
            const auto shift = [&](const Ijk& v) { return v + by; };
            const Band other = bandOf(mapVoxels(*grid, shift), kH);
            const Field moved = marchFrom(other, {shifted(seed, band, other, by)}, order);
            CHECK(worstDifference(field, moved, shift) == 0);
        }
    }
}

TEST_CASE("index coordinates shifted by any amount leave distances") {
    // Nodes are numbered differently, and the march accepts nodes whose keys tie (6e-8) by number.
    const auto grid = torusGrid();
    const Band band = bandOf(grid, kH);
    for (const int order : {kJet, 1, 2}) {
        const SurfacePoint seed = dyadicSeed(band, torusPoints()[0]);
        const Field field = marchFrom(band, {seed}, order);
        for (const Ijk& by : {Ijk{1, 0, 0}, Ijk{3, 5, -6}, Ijk{-1234567, 89, 7}}) {
            const auto shift = [&](const Ijk& v) { return v + by; };
            const Band other = bandOf(mapVoxels(*grid, shift), kH);
            const Field moved = marchFrom(other, {shifted(seed, band, other, by)}, order);
            CHECK(worstDifference(field, moved, shift) <= 1e-5);
        }
    }
}

}  // namespace igeo::test
