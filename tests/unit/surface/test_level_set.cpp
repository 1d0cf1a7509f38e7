// What checkLevelSet measures; test_level_set_refusals.cpp has what it refuses.
#include <igeo/geodesic_solver.h>
#include <igeo/surface/level_set_check.h>
#include <openvdb/tools/Filter.h>
#include <openvdb/tools/MeshToVolume.h>
#include <support/catch.h>
#include <support/errors.h>
#include <support/openvdb.h>
#include <support/shapes.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <vector>

namespace igeo::test {
namespace {

LevelSetStats statsOf(const Shape& shape, double dx, double halfWidth = 3) {
    return checkedLevelSet(makeLevelSet(shape, dx, halfWidth)).stats;
}

/// The exact distance to a comb along z, in voxels, turned in space.
/// @param thick  its teeth and its back; slots are a fifth of a voxel wider
Shape comb(double thick) {
    constexpr int kTeeth = 5;
    constexpr double kDeep = 12, kLong = 9;
    const double pitch = 2 * thick + 0.2, low = -(kTeeth * pitch - thick) / 2;
    std::vector<openvdb::Vec2d> outline{{low, -thick}};
    for (int k = 0; k < kTeeth; ++k) {
        const double left = low + k * pitch, right = left + thick;
        if (k > 0) outline.emplace_back(left, 0);
        outline.emplace_back(left, kDeep), outline.emplace_back(right, kDeep);
        if (k + 1 < kTeeth) outline.emplace_back(right, 0);
    }
    outline.emplace_back(-low, -thick);
    const auto sdf = [=](const openvdb::Vec3d& p) {
        const openvdb::Vec3d q(0.6 * p.x() - 0.8 * p.y(), 0.48 * p.x() + 0.36 * p.y() - 0.8 * p.z(),
                               0.64 * p.x() + 0.48 * p.y() + 0.6 * p.z());
        const openvdb::Vec2d at(q.x(), q.y());
        double least = 1e9;
        bool inside = false;
        for (std::size_t i = 0; i < outline.size(); ++i) {
            const openvdb::Vec2d a = outline[i], b = outline[(i + 1) % outline.size()], ab = b - a;
            const double along = std::clamp((at - a).dot(ab) / ab.dot(ab), 0.0, 1.0);
            least = std::min(least, (at - a - along * ab).length());
            inside ^= (a.y() > at.y()) != (b.y() > at.y()) &&
                      at.x() < a.x() + (at.y() - a.y()) / ab.y() * ab.x();
        }
        const double across = inside ? -least : least, beyond = std::abs(q.z()) - kLong;
        return std::min(std::max(across, beyond), 0.0) +
               std::hypot(std::max(across, 0.0), std::max(beyond, 0.0));
    };
    const openvdb::BBoxd bounds(openvdb::Vec3d(-20), openvdb::Vec3d(20));
    return {"comb", sdf, bounds, true, nullptr};
}

}  // namespace

TEST_CASE("checkLevelSet: counts and widths of a sphere") {
    const double dx = 0.05;
    const auto grid = makeLevelSet(sphere(kOffLattice, 1), dx, 3);
    const LevelSet s = checkedLevelSet(grid);
    CHECK(s.warnings.empty());
    CHECK(s.stats.activeVoxels == grid->activeVoxelCount());
    std::uint64_t negative = 0, near = 0;
    for (auto it = grid->cbeginValueOn(); it; ++it) {
        negative += *it < 0;
        near += std::abs(*it / dx) < 1;
    }
    CHECK(s.stats.negative == negative);
    CHECK(s.stats.nearSurface == near);
    CHECK(s.stats.badVoxels == 0);
    CHECK(s.stats.cutVoxels == 0);
    // Thousands of voxels: some lie within a hundredth of the edge at 3.
    CHECK(s.stats.halfWidth < 3);
    CHECK(s.stats.halfWidth > 2.99);
    CHECK(s.stats.reach == s.stats.halfWidth);
    // Central differences of |x| are short by at most 1 / (2 R^2), R > 17; bins are 0.001 wide.
    // Measured: 0.00049.
    CHECK(std::abs(s.stats.gradientMedian - 1) < 0.00074);
    CHECK(s.stats.gradientShare == 1);
}

TEST_CASE("checkLevelSet: 95th percentile of curvature within 1 percent on a sphere") {
    // Second differences of |x| are off by (dx / R)^2 times a number below 1: 1/400 at R = 20
    // voxels; the bins of the histogram are 0.4 % wide.
    for (const double radius : {20.0, 33.3, 60.0}) {
        const double k = statsOf(sphere(kOffLattice, radius * 0.05), 0.05).largestCurvature;
        CHECK(k * radius == Approx(1).epsilon(0.0031));  // measured 0.002
    }
}

TEST_CASE("checkLevelSet: 95th percentile of curvature on a torus is that of the tube") {
    // The tube bends by 1/r everywhere, the inner equator by 1/(R - r), which is less here. Errors
    // are (dx / r)^2 again, 1/256 and less.
    for (const double r : {16.0, 24.0}) {
        const double dx = 0.4 / r;
        const double k = statsOf(torus(kOffLattice, 1, 0.4), dx).largestCurvature;
        CHECK(k * r == Approx(1).epsilon(0.0016));  // measured 0.001
    }
}

TEST_CASE("checkLevelSet: a twentieth of the surface may bend more") {
    // Two spheres of radii 30 and r voxels: the small one has r^2 / (900 + r^2) of the area.
    for (const auto& [r, expected] : {std::pair<double, double>{10, 10}, {6, 30}}) {
        const auto both =
            twoSpheres(kOffLattice, 30 * 0.05, kOffLattice + openvdb::Vec3d(3, 0, 0), r * 0.05);
        INFO("share " << r * r / (900 + r * r));
        // (dx / r)^2 of error at r = 10, and bins of 0.4 %.
        CHECK(statsOf(both, 0.05).largestCurvature * expected == Approx(1).epsilon(0.015));
    }
}

TEST_CASE("checkLevelSet: a plane has no curvature to speak of") {
    // Second differences of floats near 3: 1e-6 of rounding each. Enough to bend within a band.
    const auto st = statsOf(planePatch(kOffLattice, {0.36, 0.48, -0.8}, 2), 0.05);
    CHECK(st.largestCurvature < 1.5e-6);  // measured 1.0e-6
}

TEST_CASE("checkLevelSet: reach of a thin sheet is half its thickness") {
    // Sheets meet where psi = -thickness / 2; voxels that see it lie up to half a voxel off.
    for (const double thickness : {2.4, 3.0, 4.1}) {
        const auto st = statsOf(thinSheet(kOffLattice, 1, 1, thickness * 0.05), 0.05);
        INFO("thickness " << thickness << ", reach " << st.reach);
        CHECK(std::abs(st.reach - thickness / 2) < 0.39);  // measured 0.26
    }
    // Thicker than the narrow band: nothing to see.
    const auto thick = statsOf(thinSheet(kOffLattice, 1, 1, 8 * 0.05), 0.05);
    CHECK(thick.reach == thick.halfWidth);
}

TEST_CASE("checkLevelSet: the share of the surface that the grid does not resolve") {
    const double dx = 0.05;
    const auto beside = [](const Shape& a, const Shape& b) {
        const auto sdf = [=](const openvdb::Vec3d& p) { return std::min(a.sdf(p), b.sdf(p)); };
        openvdb::BBoxd bounds = a.bounds;
        bounds.expand(b.bounds);
        return Shape{"two", sdf, bounds, true, nullptr};
    };
    const openvdb::Vec3d away(3, 0, 0);
    const Shape ball = sphere(kOffLattice, 20 * dx);
    const double areaOfBall = 4 * std::numbers::pi * 400;
    CHECK(statsOf(ball, dx).unresolvedShare == 0);
    // Sheets of 40 by 40 voxels, whose sides meet: two sides and a rim.
    for (const double thick : {2.4, 3.2}) {
        const double area = 2 * 40 * 40, share = area / (area + 4 * 40 * thick + areaOfBall);
        const Shape sheet = thinSheet(kOffLattice + away, 1, 1, thick * dx);
        const double found = statsOf(beside(ball, sheet), dx).unresolvedShare;
        INFO("thick " << thick << ", share " << share << ", found " << found);
        CHECK(found / share == Approx(1).epsilon(0.14));  // measured 0.089: the rim bends
    }
    // Small balls, all of which bends.
    for (const double radius : {1.3, 1.6}) {
        const double area = 4 * std::numbers::pi * radius * radius,
                     share = area / (area + areaOfBall);
        const double found =
            statsOf(beside(ball, sphere(kOffLattice + away, radius * dx)), dx).unresolvedShare;
        INFO("radius " << radius << ", share " << share << ", found " << found);
        CHECK(found / share == Approx(1).epsilon(0.47));  // measured 0.31, of some 40 voxels
    }
}

TEST_CASE("checkLevelSet: closed surfaces see the other sign next to them") {
    // A plane whose normal is the space diagonal has the least: voxels within 1/sqrt(3) of 1.
    for (const Shape& shape :
         {sphere(kOffLattice, 1), torus(kOffLattice, 1, 0.4), box(kOffLattice, {1, 0.8, 0.7}),
          cylinder(kOffLattice, 0.6, 0.7), trefoilTube(kOffLattice, 0.5, 0.25),
          thinSheet(kOffLattice, 1, 1, 0.2), planePatch(kOffLattice, {1, 1, 1}, 2)}) {
        const auto st = statsOf(shape, 0.05);
        INFO(shape.name << ": " << st.crossingShare);
        CHECK(st.crossingShare > 0.45);
    }
}

TEST_CASE("checkLevelSet: walls of 1.5 voxels are distances, though most voxels lie at kinks") {
    for (const double thick : {1.3, 1.5, 1.7}) {
        const LevelSet s = checkedLevelSet(makeLevelSet(comb(thick), 1, 3));
        INFO(thick << ": " << s.stats.gradientShare);
        CHECK(s.stats.gradientShare < 0.7);  // the limit for distances with few kinks
        REQUIRE(!s.warnings.empty());
        CHECK_THAT(s.warnings.back(), contains("psi has a kink between two sheets"));
    }
    // What is none stays none: a mean over 27 voxels, a slope of 0.8.
    const auto smooth = makeLevelSet(sphere(kOffLattice, 1), 0.05, 3);
    const auto flat = smooth->deepCopy();
    openvdb::tools::Filter<openvdb::FloatGrid>(*smooth).mean(2, 3);
    for (auto it = flat->beginValueOn(); it; ++it) it.setValue(0.8f * *it);
    CHECK_THROWS_WITH(checkedLevelSet(smooth), contains("psi is not a distance"));
    CHECK_THROWS_WITH(checkedLevelSet(flat), contains("psi is not a distance"));
}

TEST_CASE("checkLevelSet: a distance times a constant is divided by it") {
    double most = 0, mostOfSlope = 0;
    for (const Shape& shape :
         {sphere(kOffLattice, 0.5), torus(kOffLattice, 1, 0.4), box(kOffLattice, {0.9, 0.7, 0.5})})
        for (const float slope : {0.92f, 0.97f, 1.03f, 1.08f}) {
            CAPTURE(shape.name, slope);
            const auto exact = makeLevelSet(shape, *rotatedTransform(0.05, {1, 2, 3}, 40, {}), 3),
                       scaled = exact->deepCopy();
            for (auto it = scaled->beginValueAll(); it; ++it) it.setValue(slope * *it);
            const LevelSet s = checkedLevelSet(scaled);
            REQUIRE(s.warnings.size() == 1);
            CHECK_THAT(s.warnings[0], contains("it was divided by"));
            mostOfSlope = std::max(mostOfSlope, std::abs(s.stats.dividedBy / double(slope) - 1));
            CHECK(s.stats.halfWidth == Approx(3).epsilon(0.0020));  // measured 0.0013
            for (auto it = exact->cbeginValueOn(); it; ++it)
                most = std::max(most, std::abs(s.psi->tree().getValue(it.getCoord()) - *it) / 0.05);
            CHECK(*scaled->cbeginValueOn() == slope * *exact->cbeginValueOn());
        }
    std::printf("a distance times a constant: slope off by %.2g, psi by up to %.2g voxels\n",
                mostOfSlope, most);
    CHECK(mostOfSlope < 0.0020);  // measured 0.0013
    CHECK(most < 0.0058);         // measured 0.0039
}

TEST_CASE("checkLevelSet: distances are not divided") {
    for (const double voxels : {1.5, 2.0, 3.0, 5.0, 20.0})
        for (const double halfWidth : {1.0, 2.0, 3.0, 6.0}) {
            CAPTURE(voxels, halfWidth);
            CHECK(statsOf(sphere(kOffLattice, voxels), 1, halfWidth).dividedBy == 1);
            CHECK(statsOf(torus(kOffLattice, 2 * voxels, voxels), 1, halfWidth).dividedBy == 1);
            CHECK(statsOf(cylinder(kOffLattice, voxels, 20), 1, halfWidth).dividedBy == 1);
        }
}

TEST_CASE("checkLevelSet: a level set that was scaled along one axis is no distance") {
    // Values of a sphere, on an ellipsoid.
    Shape flat = sphere(kOffLattice, 1);
    flat.sdf = [of = flat.sdf](const openvdb::Vec3d& p) {
        return of(kOffLattice + (p - kOffLattice) * openvdb::Vec3d(0.9, 0.9, 1));
    };
    flat.bounds =
        openvdb::BBoxd(kOffLattice - openvdb::Vec3d(1.2), kOffLattice + openvdb::Vec3d(1.2));
    const LevelSet s = checkedLevelSet(makeLevelSet(flat, 0.05, 3));
    CHECK(s.stats.dividedBy == 1);
    REQUIRE(s.warnings.size() == 1);
    CHECK_THAT(s.warnings[0], contains("as where it was filtered, or scaled along one axis"));
}

TEST_CASE("checkLevelSet: the transform becomes a similarity") {
    const openvdb::Vec3d shift(5, -7, 11);
    const auto transform = rotatedTransform(0.05, {1, 2, 3}, 77, shift);
    const LevelSet s = checkedLevelSet(makeLevelSet(sphere({4.9, -7.1, 11.2}, 1), *transform, 3));
    CHECK(s.transform.dx == Approx(0.05).epsilon(1e-14));
    for (const Vec3d& p : {Vec3d{0, 0, 0}, Vec3d{10, 0, 0}, Vec3d{-3, 7.5, 100}}) {
        const openvdb::Vec3d w = transform->indexToWorld(openvdb::Vec3d(p.x, p.y, p.z));
        // A hundred voxels of 0.05, a few roundings.
        CHECK(length(s.transform.worldFromIndex(p) - Vec3d{w.x(), w.y(), w.z()}) < 1e-13);
    }
    // Exactly dx where the map says so, and mirrored grids are fine.
    CHECK(checkedLevelSet(makeLevelSet(sphere(kOffLattice, 1), 0.07, 3)).transform.dx == 0.07);
    openvdb::Mat4d mirror = openvdb::Mat4d::identity();
    mirror(0, 0) = mirror(1, 1) = 0.05, mirror(2, 2) = -0.05;
    const auto mirrored = openvdb::math::Transform::createLinearTransform(mirror);
    CHECK(checkedLevelSet(makeLevelSet(sphere(kOffLattice, 1), *mirrored, 3)).warnings.empty());
}

TEST_CASE("checkLevelSet: stray voxels decide no width, and are left out") {
    const double dx = 0.05;
    const auto sound = makeLevelSet(sphere(kOffLattice, 1), dx, 3);
    const LevelSetStats expected = checkedLevelSet(sound).stats;
    const openvdb::Coord far(60, 2, 3), inBand = sound->beginValueOn().getCoord();
    for (const float voxels : {-499.0f, 12.5f, 1e30f}) {
        const auto grid = sound->deepCopy();
        grid->tree().setValueOn(far, voxels * float(dx));
        const LevelSet s = checkedLevelSet(grid);
        CHECK(s.stats.strayVoxels == 1);
        CHECK(s.stats.halfWidth == expected.halfWidth);
        CHECK(s.stats.activeVoxels == expected.activeVoxels);
        CHECK(s.stats.negative == expected.negative);
        CHECK(s.stats.reach == expected.reach);
        CHECK_FALSE(s.psi->tree().isValueOn(far));
        REQUIRE(s.warnings.size() == 1);
        for (const char* part : {"1 of", "at index 60,2,3", "voxels at most", "rebuild"})
            CHECK(s.warnings[0].find(part) != std::string::npos);
        CHECK(grid->tree().isValueOn(far));  // the grid given stays as it is
    }
    // Some hundred of all sizes, and one of them in the band.
    const auto noisy = sound->deepCopy();
    for (int k = 0; k < 200; ++k)
        noisy->tree().setValueOn({100 + k, 3 * k, 7},
                                 float(dx) * (k % 2 ? 5.0f : -5.0f) * float(k + 1));
    noisy->tree().setValueOn(inBand, 80 * float(dx));
    const LevelSet s = checkedLevelSet(noisy);
    CHECK(s.stats.strayVoxels == 201);
    CHECK(s.stats.halfWidth == expected.halfWidth);
}

TEST_CASE("checkLevelSet: single voxels with the sign of the other side are turned") {
    // A slot of 2.6 voxels in a block, in general position.
    const auto transform = rotatedTransform(1, {1, 2, 3}, 40, {0.1, 0.2, 0.3});
    const auto right = makeLevelSet(
        partOf({{{-12, -12, -16}, {12, 12, 0}}, {{-1.3, -14, -10}, {1.3, 14, 2}, true}}),
        *transform, 3);
    const auto wrong = right->deepCopy();
    std::size_t turned = 0;
    for (auto it = wrong->beginValueOn(); it; ++it) {
        const auto p = transform->indexToWorld(it.getCoord());
        // In the middle of the slot, as OpenVDB's meshToVolume leaves them.
        const bool inside = std::abs(p.x()) < 0.3 && std::abs(p.y()) < 9 && std::abs(p.z() + 5) < 3;
        if (inside && it.getCoord().y() % 7 == 0) it.setValue(-*it), ++turned;
    }
    CHECK(turned > 5);
    const LevelSet s = checkedLevelSet(wrong), expected = checkedLevelSet(right);
    REQUIRE(s.warnings.size() == expected.warnings.size() + 1);
    CHECK(s.warnings.front().find("surface: " + std::to_string(turned) + ",") != std::string::npos);
    CHECK(s.stats.negative == expected.stats.negative);
    for (auto it = right->cbeginValueOn(); it; ++it)
        if (s.psi->tree().getValue(it.getCoord()) != *it) FAIL_CHECK(it.getCoord());
}

TEST_CASE("checkLevelSet: psi that is negative outside gets the other sign") {
    const auto right = makeLevelSet(torus(kOffLattice, 0.8, 0.3),
                                    *rotatedTransform(0.05, {1, 2, 3}, 40, {0.1, 0.2, 0.3}), 3);
    for (const double background : {1.0, -1.0}) {
        const auto wrong = right->deepCopy();
        for (auto it = wrong->beginValueAll(); it; ++it) it.setValue(-*it);
        wrong->tree().root().setBackground(float(background) * right->background(), false);
        const LevelSet s = checkedLevelSet(wrong), expected = checkedLevelSet(right);
        CHECK(expected.warnings.empty());
        REQUIRE(s.warnings.size() == 1);
        CHECK(s.warnings.front().find("negative outside") != std::string::npos);
        CHECK(s.stats.negative == expected.stats.negative);
        CHECK(s.psi->background() == right->background());
        CHECK(wrong->tree().getValue(right->cbeginValueOn().getCoord()) ==
              -*right->cbeginValueOn());
        for (auto it = right->cbeginValueOn(); it; ++it)
            if (s.psi->tree().getValue(it.getCoord()) != *it) FAIL_CHECK(it.getCoord());
    }
    // An open surface has no outside.
    const auto patch = makeLevelSet(planePatch(kOffLattice, {1, 2, 3}, 1), 0.05, 3);
    for (auto it = patch->beginValueAll(); it; ++it) it.setValue(-*it);
    for (const std::string& w : checkedLevelSet(patch).warnings)
        CHECK(w.find("negative outside") == std::string::npos);
}

TEST_CASE("checkLevelSet: hollow edges that OpenVDB's conversion rounds are set right") {
    // A step, in general position.
    const auto transform = rotatedTransform(1, {1, 2, 3}, 40, {0.1, 0.2, 0.3});
    const auto exact = makeLevelSet(
        partOf({{{-16, -12, -8}, {16, 12, 0}}, {{-16, -12, 0}, {0, 12, 8}}}), *transform, 3);
    using openvdb::Vec3s;
    std::vector<Vec3s> points;
    for (const float y : {-12.0f, 12.0f})
        for (const auto& [x, z] : std::vector<std::array<float, 2>>{
                 {-16, -8}, {16, -8}, {16, 0}, {0, 0}, {0, 8}, {-16, 8}})
            points.emplace_back(x, y, z);
    std::vector<openvdb::Vec4I> quads{{0, 3, 4, 5}, {0, 1, 2, 3}, {11, 10, 9, 6}, {9, 8, 7, 6}};
    for (unsigned k = 0; k < 6; ++k) quads.emplace_back(k, 6 + k, 6 + (k + 1) % 6, (k + 1) % 6);
    const auto made =
        openvdb::tools::meshToLevelSet<openvdb::FloatGrid>(*transform, points, {}, quads);
    const auto lowered = [&](const openvdb::FloatGrid& psi) {
        std::size_t count = 0;
        for (auto it = exact->cbeginValueOn(); it; ++it)
            count += std::abs(*it) < 1 && psi.tree().getValue(it.getCoord()) < *it - 0.1f;
        return count;
    };
    const LevelSet s = checkedLevelSet(made);
    const std::size_t before = lowered(*made);
    CHECK(before > 40);
    CHECK(lowered(*s.psi) < 26);  // measured 17 of 44: where the faces end, and beside them
    CHECK(s.stats.loweredVoxels > before / 2);
    std::uint64_t negative = 0;
    for (auto it = s.psi->cbeginValueOn(); it; ++it) negative += *it < 0;
    CHECK(s.stats.negative == negative);
    REQUIRE(s.warnings.size() == 1);
    CHECK(s.warnings.front().find("hollow edges are rounded") != std::string::npos);

    const LevelSet sharp = checkedLevelSet(exact);
    CHECK(sharp.psi == exact);
    CHECK(sharp.stats.loweredVoxels == 0);
}

TEST_CASE("checkLevelSet: a level set that fills its inside has no strays") {
    // Its shells shrink to a point, and another piece has its own.
    const double dx = 0.05;
    for (const double halfWidth : {3.0, 3.001, 7.3, 25.0}) {
        const auto grid = makeLevelSet(sphere(kOffLattice, 1), dx, halfWidth);
        for (auto it = grid->beginValueOn(); it; ++it)
            if (*it > 3 * float(dx)) it.setValueOff();
        const LevelSetStats s = checkedLevelSet(grid).stats;
        CHECK(s.strayVoxels == 0);
        CHECK(s.halfWidth > std::min(halfWidth, 20.0) - 0.5);
    }
}

TEST_CASE("checkLevelSet: a narrow level set is widened to take differences") {
    const LevelSet s = checkedLevelSet(makeLevelSet(sphere(kOffLattice, 1), 0.05, 1.5));
    CHECK(s.stats.halfWidth == 3);
    REQUIRE(s.warnings.size() == 1);
    CHECK(s.warnings[0].find("widened by fast sweeping") != std::string::npos);
}

TEST_CASE("checkLevelSet: a level set that is narrow on one side only is widened too") {
    const double dx = 0.05;
    for (const Shape& shape : {sphere(kOffLattice, 1), torus(kOffLattice, 1, 0.4)})
        for (const double width : {1.2, 1.5, 1.9, 2.5})
            for (const int side : {-1, 1}) {
                INFO(shape.name << ", " << width << " voxels on side " << side);
                const auto grid = makeLevelSet(shape, dx, 4);
                const auto most = float(width * dx), sign = float(side);
                for (auto it = grid->beginValueOn(); it; ++it)
                    if (sign * *it > most) it.setValue(sign * most), it.setValueOff();
                const LevelSet s = checkedLevelSet(grid);
                CHECK(s.stats.cutVoxels == 0);
                REQUIRE(s.warnings.size() == (width < 2 ? 1 : 0));
                if (width < 2)
                    CHECK(s.warnings[0].find("widened by fast sweeping") != std::string::npos);
                if (shape.name != "sphere") continue;
                const Vec3d center = fromVdb(kOffLattice), out{1, 0, 0};
                const Distance d = GeodesicSolver(Surface(*grid)).distance({center + out});
                const double off = std::abs(d.at(center - out) / std::numbers::pi - 1);
                std::printf("sphere, %.1f voxels on side %d: off by %.5f %%\n", width, side,
                            100 * off);
                CHECK(off < 0.0001);  // measured 0.000065
            }
    // One that is thin on one side is no narrower.
    const LevelSetStats plate = statsOf(thinSheet(kOffLattice, 0.8, 0.6, 3 * dx), dx, 4);
    CHECK(plate.halfWidth > 3.98);
    CHECK(plate.cutVoxels == 0);
}

TEST_CASE("widen: fills the band up to the width asked for") {
    const double dx = 0.05;
    for (const Shape& shape : {sphere(kOffLattice, 1), torus(kOffLattice, 1, 0.5)}) {
        for (const double width : {3.5, 5.0, 6.2}) {
            LevelSet s = checkedLevelSet(makeLevelSet(shape, dx, 3));
            widen(s, width);
            INFO(shape.name << ", " << width << " voxels");
            CHECK(s.stats.halfWidth == width);
            const auto exact = makeLevelSet(shape, dx, width);
            std::size_t missing = 0, total = 0;
            double worst = 0;
            for (auto it = exact->cbeginValueOn(); it; ++it, ++total) {
                float value = 0;
                // Sweeping is off by less than its step to the edge: look half a voxel inside.
                if (std::abs(*it) > (width - 0.5) * dx) continue;
                if (!s.psi->tree().probeValue(it.getCoord(), value))
                    ++missing;
                else
                    worst = std::max(worst, double(std::abs(value - *it) / dx));
            }
            CHECK(total > 1000);
            CHECK(missing == 0);
            // First order over the new voxels, at most 3.2 of them, at radii above 4 voxels: a
            // twentieth of a voxel per voxel, measured 1 / 1.5 of this.
            CHECK(worst < 0.067 * (width - 3) + 0.033);
        }
    }
}

TEST_CASE("widen: does nothing to a level set that is wide enough") {
    LevelSet s = checkedLevelSet(makeLevelSet(sphere(kOffLattice, 1), 0.05, 3));
    const auto before = s.psi;
    widen(s, s.stats.halfWidth);
    widen(s, 2);
    // 3 dx / dx is 2.9999998 for some dx.
    widen(s, s.stats.halfWidth + 5e-5);
    CHECK(s.psi == before);
    CHECK(s.warnings.empty());
}

}  // namespace igeo::test
