// What is found once for many voxels is what is found for each: points around a block, differences
// of a row, bins of curvature, facing pairs.
#include <igeo/surface/detail/histogram.h>
#include <igeo/surface/detail/leaf_block.h>
#include <igeo/surface/detail/points_around.h>
#include <igeo/surface/detail/psi_tally.h>
#include <support/catch.h>
#include <support/clouds.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <utility>

namespace igeo::test {

TEST_CASE("Points around a ball are those of the tree, bit by bit") {
    PointTree tree(torusCloud(2000, 2, 0.7, {}).points);
    std::vector<double> reach(tree.size());
    for (std::size_t i = 0; i < reach.size(); ++i) reach[i] = 0.1 + 0.02 * double(i % 11);
    tree.setReach(reach);
    PointsAround around(tree);
    std::vector<PointTree::Found> expected;
    for (const Vec3d& middle : {Vec3d{2.5, 0.1, 0.2}, Vec3d{0, 1.5, 0.6}, Vec3d{0, 0, 0}}) {
        constexpr double kRadius = 0.3;
        around.moveTo(middle, kRadius, 0.4);
        for (const Vec3d& off : {Vec3d{}, Vec3d{0.17, -0.17, 0.17}, Vec3d{0, kRadius, 0}}) {
            const Vec3d p = middle + off;
            tree.nearest(p, PointsAround::kNearest, expected);
            const auto& found = around.nearest(p);
            REQUIRE(found.size() == expected.size());
            for (std::size_t k = 0; k < found.size(); ++k) {
                CHECK(found[k].point == expected[k].point);
                CHECK(found[k].squared == expected[k].squared);
            }
            // Also beyond what was gathered.
            for (const double more : {0.0, 0.3, 2.0}) {
                std::vector<PointTree::Index> all, some;
                tree.forReaching(p, more, [&](PointTree::Index i) { all.push_back(i); });
                around.forReaching(p, more, [&](PointTree::Index i) { some.push_back(i); });
                CHECK(some == all);
            }
        }
    }
}

TEST_CASE("A row of a block shows what each of its voxels shows, also where voxels are missing") {
    const openvdb::FloatGrid::Ptr grid = openvdb::FloatGrid::create(3);
    const openvdb::Coord origin(8, 0, -8);
    for (int x = -1; x <= 8; ++x)
        for (int y = -1; y <= 8; ++y)
            for (int z = -1; z <= 8; ++z) {
                const openvdb::Coord c = origin.offsetBy(x, y, z);
                const auto value = float(length(Vec3d(x, y - 3, 1.1 * z)) - 5);
                if ((7 * x + 5 * y + 3 * z) % 11) grid->tree().setValueOn(c, value);
            }
    LeafBlock block;
    block.gather(LeafBlock::Accessor(grid->constTree()), origin, 0.5);
    std::size_t complete = 0, smooth = 0;
    for (int x = 0; x < 8; ++x)
        for (int y = 0; y < 8; ++y) {
            const PsiRow<> row(block, x, y);
            for (int z = 0; z < 8; ++z) {
                const PsiDifferences d(block, x, y, z);
                const auto k = std::size_t(z);
                const bool is = grid->constTree().isValueOn(origin.offsetBy(x, y, z));
                REQUIRE(bool(row.active >> z & 1) == is);
                REQUIRE(std::isnan(block.at(x, y, z)) == !is);
                REQUIRE(bool(row.complete >> z & 1) == d.complete());
                REQUIRE(bool(row.smooth >> z & 1) == d.smooth());
                complete += d.complete(), smooth += d.smooth();
                if (d.complete())
                    REQUIRE(double(row.slope[k]) == Approx(length(d.central())).epsilon(1e-6));
            }
        }
    CHECK(complete > 50);
    CHECK(complete < 450);
    CHECK(smooth < complete);
}

TEST_CASE("Counts of active voxels are those of each, also beyond the first shells") {
    constexpr double kVoxel = 0.3;
    const float inf = float(kInfinity), none = kMissingVoxel;
    const openvdb::FloatGrid::Ptr grid = openvdb::FloatGrid::create(1);
    // Multiples of a third of a voxel: those between two shells as well, as floats round them.
    for (int k = 0; k < 8 * 512; ++k)
        if (k % 5)
            grid->tree().setValueOn(openvdb::Coord(k >> 6, k >> 3 & 7, k & 7),
                                    float(kVoxel * (k * 7 % 43 - 21) / 3));
    const bool withBad = GENERATE(false, true);
    if (withBad)
        for (const float bad : {none, inf, -inf})
            grid->tree().setValueOn(openvdb::Coord(int(std::isnan(bad)), 1, bad > 0), bad);
    std::uint64_t active = 0, negative = 0, bad = 0;
    float widest = 0;
    Shells shells;
    for (auto it = grid->tree().cbeginValueOn(); it; ++it) {
        ++active, negative += *it < 0, bad += !std::isfinite(*it);
        if (!std::isfinite(*it)) continue;
        widest = std::max(widest, std::abs(*it));
        shells.add(double(std::abs(*it)) / kVoxel);
    }
    std::vector<const LeafBlock::Leaf*> leaves;
    grid->constTree().getNodes(leaves);
    const bool eight = eightAtATime();
    for (const bool by : {false, eight}) {
        eightAtATime() = by;
        PsiRange range;
        range.addLeaves(kVoxel, {leaves.data(), 3});
        PsiRange rest;
        rest.addLeaves(kVoxel, {leaves.data() + 3, leaves.size() - 3});
        range.add(rest);
        CHECK(range.active == active);
        CHECK(range.negative == negative);
        CHECK(range.bad == bad);
        CHECK(range.widest == widest);
        for (std::size_t shell = 0; shell < 9; ++shell)
            CHECK(range.shells.count(shell) == shells.count(shell));
    }
    eightAtATime() = eight;
    CHECK(bad == (withBad ? 3 : 0));
    CHECK(shells.count(6) > 0);
}

TEST_CASE(
    "Curvatures of a row are those of a torus at its foot points, NaN beside missing voxels") {
    constexpr double kMajor = 30, kMinor = 12;
    const openvdb::FloatGrid::Ptr grid = openvdb::FloatGrid::create(3);
    double largest = 0;
    std::size_t seen = 0, missing = 0;
    for (const openvdb::Coord& origin :
         {openvdb::Coord(40, 0, 0), openvdb::Coord(16, 0, 0), openvdb::Coord(16, 16, 8)}) {
        auto polar = [&](int x, int y, int z) {
            const Vec3d p(origin.x() + x + 0.3, origin.y() + y, origin.z() + z - 0.2);
            return std::pair(std::hypot(p.x, p.y) - kMajor, p.z);
        };
        for (int x = -1; x <= 8; ++x)
            for (int y = -1; y <= 8; ++y)
                for (int z = -1; z <= 8; ++z) {
                    const auto [across, up] = polar(x, y, z);
                    if (x + y + z != 20)
                        grid->tree().setValueOn(origin.offsetBy(x, y, z),
                                                float(std::hypot(across, up) - kMinor));
                }
        LeafBlock block;
        block.gather(LeafBlock::Accessor(grid->constTree()), origin, 1);
        for (int x = 0; x < 8; ++x)
            for (int y = 0; y < 8; ++y) {
                const RowCurvatures row(block, x, y);
                for (int z = 0; z < 8; ++z) {
                    const float found = row.largest[std::size_t(z)];
                    if (std::isnan(found)) {
                        ++missing;
                        REQUIRE(x + y + z > 20 - 3);
                        continue;
                    }
                    if (!(std::abs(block.at(x, y, z)) < 1)) continue;
                    const auto [across, up] = polar(x, y, z);
                    const double cosine = across / std::hypot(across, up);
                    const double exact =
                        std::max(1 / kMinor, std::abs(cosine / (kMajor + kMinor * cosine)));
                    largest = std::max(largest, std::abs(double(found) / exact - 1));
                    ++seen;
                }
            }
        grid->clear();
    }
    std::printf("%zu voxels, curvature off by up to %.3g, %zu beside missing ones\n", seen, largest,
                missing);
    CHECK(seen > 100);
    CHECK(missing > 0);
    CHECK(largest < 1.5 * 0.0027);  // second differences
}

TEST_CASE("Bins of curvature are those of the logarithm") {
    const CurvatureBins bins;
    for (double k = 3e-7; k < 30; k *= 1.00037) {
        const double clamped = std::max(k, 1e-6);
        REQUIRE(bins(k) == Histogram::binOf(scaleOfCurvature(clamped)));
    }
}

}  // namespace igeo::test
