// Inputs that no voxel grid resolves, or that are no distances: results may be rough, but a march
// ends, reaches what it can, and every value leads down to a seed.
#include <igeo/march/jet.h>
#include <igeo/surface/level_set_band.h>
#include <support/catch.h>
#include <support/errors.h>
#include <support/expect_error.h>
#include <support/field_checks.h>
#include <support/openvdb.h>
#include <support/shapes.h>

#include <random>

namespace igeo::test {
namespace {

using Point = openvdb::Vec3d;

/// Off every lattice plane; the direction is off every axis.
const Point kWay = Point(1, 2, 3).unit();

struct HardCase {
    std::string name;
    openvdb::FloatGrid::Ptr grid;
    std::vector<Point> seeds;
};

openvdb::FloatGrid::Ptr gridOf(const Shape& shape) { return makeLevelSet(shape, 1, 3); }

/// The lesser distance: exact where the two are apart.
openvdb::FloatGrid::Ptr gridOf(const Shape& a, const Shape& b) {
    Shape shape = a;
    shape.bounds.expand(b.bounds);
    shape.sdf = [=](const Point& p) { return std::min(a.sdf(p), b.sdf(p)); };
    return gridOf(shape);
}

/// A torus with other values.
openvdb::FloatGrid::Ptr changed(const std::function<float(float)>& change) {
    auto grid = gridOf(torus(kOffLattice, 14, 6));
    for (auto value = grid->beginValueOn(); value; ++value) value.setValue(change(*value));
    return grid;
}
const Point kOnTorus = kOffLattice + Point(14, 0.3, 6);

openvdb::FloatGrid::Ptr scaled(float factor) {
    return changed([=](float v) { return factor * v; });
}

/// Noise of up to `size` voxels, the same in every run.
openvdb::FloatGrid::Ptr noisy(float size) {
    std::mt19937 bits(7);
    return changed([&](float v) { return v + size * float(bits() / 2147483648.0 - 1); });
}

/// Two balls of radii 10 and `radius`, `gap` apart.
openvdb::FloatGrid::Ptr twoBalls(double gap, double radius) {
    return gridOf(sphere(kOffLattice, 10),
                  sphere(kOffLattice + (10 + gap + radius) * kWay, radius));
}
const Point kFarSide = kOffLattice - 10 * kWay;

Band bandOf(const openvdb::FloatGrid::Ptr& grid) {
    return bandFromLevelSet(checkedLevelSet(grid), std::sqrt(3.0));
}

Field march(const Band& band, const std::vector<Point>& seeds) {
    std::vector<SurfacePoint> points;
    for (const Point& p : seeds) points.push_back(pointOn(band, p));
    return marchJet(band, {}, points);
}

/// What a result has to be, whatever the input. Along a path d is read to a tenth of a voxel.
void checkResult(const std::string& name, const Field& field) {
    const FieldChecks c = checkField(field, Nodes::Marched);
    const PathChecks p = checkPaths(field);
    std::printf(
        "%s: %zu of %zu nodes, below the straight line by %.3f, paths rise by %.3f, %zu of %zu "
        "lost\n",
        name.c_str(), field.reached, field.band->size(), c.shortcut, p.rise, p.lost, p.traced);
    INFO(name);
    CHECK(field.reached > 0);
    CHECK(c.notNumbers == 0);
    CHECK(c.missed == 0);
    CHECK(c.negative == 0);
    CHECK(c.stuck == 0);
    CHECK(c.shortcut < 0.5);
    CHECK(p.traced > 0);
    CHECK(p.lost == 0);
    CHECK(p.rise < 0.1);
}

}  // namespace

TEST_CASE("hard surfaces: the march ends and leads down to the seed") {
    const Point half(12.3, 9.7, 14.2), onEdge(half.x(), 1.7, half.z());
    const auto sharp = gridOf(box(kOffLattice, half)),
               cone = gridOf(frustum(kOffLattice, 12, 0.5, 15));
    const auto smooth = gridOf(torus(kOffLattice, 14, 6));
    const auto thin = gridOf(box(kOffLattice, {20, 14, 0.6}));
    const std::vector<HardCase> cases{
        {"plate of 1.2 voxels", thin, {kOffLattice + Point(3.3, 1.2, 0.6)}},
        {"ball next to a speck", twoBalls(2, 0.7), {kFarSide}},
        {"psi scaled by 0.92", scaled(0.92f), {kOnTorus}},
        {"psi with noise of 0.1", noisy(0.1f), {kOnTorus}},
        {"from an edge", sharp, {kOffLattice + onEdge}},
        {"from a corner", sharp, {kOffLattice + half}},
        {"from a rim", cone, {kOffLattice + Point(12, 0, -15)}},
        {"from a tip", cone, {kOffLattice + Point(0, 0, 15)}},
        {"from two seeds a third of a voxel apart",
         smooth,
         {kOnTorus, kOnTorus + Point(0.3, 0.1, 0)}},
        {"from an edge and a hundredth of a voxel beside it",
         sharp,
         {kOffLattice + onEdge, kOffLattice + onEdge + Point(0, 0.01, 0)}},
    };
    for (const HardCase& c : cases) {
        const Band band = bandOf(c.grid);
        checkResult(c.name, march(band, c.seeds));
    }
}

TEST_CASE("hard surfaces: nothing crosses a gap of 1.5 voxels") {
    const Point half(15, 12, 2.5), up(0, 0, 6.5), seed = kOffLattice + Point(1.1, 2.3, 2.5);
    const Shape low = roundedBox(kOffLattice, half, 2.5),
                high = roundedBox(kOffLattice + up, half, 2.5);
    const Band band = bandOf(gridOf(low, high));
    const Field field = march(band, {seed});
    checkResult("two plates 1.5 voxels apart", field);
    for (std::size_t k = 0; k < band.size(); ++k)
        if (field.distance[k] < kInfinity && band.inCore(NodeIndex(k)))
            REQUIRE(band.footPoint(NodeIndex(k)).z < kOffLattice.z() + up.z() / 2);
}

TEST_CASE("hard surfaces: a speck is a surface of its own") {
    const Band band = bandOf(twoBalls(2, 0.7));
    const Field field = march(band, {kFarSide}), back = march(band, {kOffLattice + 13.4 * kWay});
    std::size_t onSpeck = 0;
    for (std::size_t k = 0; k < band.size(); ++k) {
        const auto i = NodeIndex(k);
        if (!band.inCore(i)) continue;
        const bool onBall = (worldOf(band, band.footPoint(i)) - kOffLattice).length() < 11;
        REQUIRE((field.distance[i] < kInfinity) == onBall);
        REQUIRE((back.distance[i] < kInfinity) != onBall);
        onSpeck += !onBall;
    }
    CHECK(onSpeck > 0);
}

TEST_CASE("hard surfaces: a plate without a voxel inside is refused") {
    // Between two planes of voxels.
    const auto grid = gridOf(box({0, 0, 0.5}, {20, 14, 0.3}));
    expectError(Error::Kind::BadInput, {"psi is positive everywhere"},
                [&] { checkedLevelSet(grid); });
}

TEST_CASE("hard surfaces: the gradient check warns of noise that matters") {
    CHECK(checkedLevelSet(scaled(0.92f)).stats.gradientMedian == Approx(0.92).epsilon(0.01));
    const LevelSet divided = checkedLevelSet(scaled(0.92f));
    CHECK(divided.stats.dividedBy == Approx(0.92).epsilon(0.00093));  // measured 0.00062
    REQUIRE(divided.warnings.size() == 1);
    CHECK(divided.warnings[0].find("it was divided by") != std::string::npos);
    // A central difference of noise up to e is at most e in each axis: |grad psi| stays within
    // 0.1 sqrt(3) of 1, and 0.25 is allowed.
    CHECK(checkedLevelSet(noisy(0.1f)).warnings.empty());
    // Of the differences along the normal, the share (1 - 0.25 / 0.4)^2 = 14 % lies beyond 0.25.
    const auto warnings = checkedLevelSet(noisy(0.4f)).warnings;
    REQUIRE(warnings.size() == 1);
    CHECK(warnings[0].find("rough distance") != std::string::npos);
}

TEST_CASE("hard surfaces: a seed given twice counts once") {
    const Band band = bandOf(gridOf(torus(kOffLattice, 14, 6)));
    const Field once = march(band, {kOnTorus}), twice = march(band, {kOnTorus, kOnTorus});
    CHECK(twice.distance == once.distance);
    CHECK(twice.gradient == once.gradient);
    CHECK(twice.fallbackCount == once.fallbackCount);
    for (const std::uint32_t label : twice.label) REQUIRE(label == 0);
}

TEST_CASE("hard surfaces: seeds on either face of a plate thinner than a voxel") {
    // Its middle is 0.09 voxels from a plane of voxels, so that they are inside.
    const Point middle(kOffLattice.x(), kOffLattice.y(), 0.09);
    for (const double thickness : {1.0, 0.8, 0.6, 0.4})
        for (const double side : {-0.5, 0.5}) {
            const Band band = bandOf(gridOf(box(middle, {20, 14, thickness / 2})));
            const Field field = march(band, {middle + Point(3.3, 1.2, side * thickness)});
            CHECK(field.reached == band.size());
            checkResult("plate of " + std::to_string(thickness), field);
        }
}

TEST_CASE("hard surfaces: a gap of 1.5 voxels with sharp rims") {
    // At the rims the two edges, 1.5 voxels apart, look like one groove, and the front may cross.
    const Point half(15, 12, 2.5), up(0, 0, 6.5), seed = kOffLattice + Point(1.1, 2.3, 2.5);
    const Band band = bandOf(gridOf(box(kOffLattice, half), box(kOffLattice + up, half)));
    checkResult("two sharp plates 1.5 voxels apart", march(band, {seed}));
}

TEST_CASE("hard surfaces: balls that overlap, touch or nearly do") {
    for (const double gap : {-0.3, 0.0, 0.5, 1.0}) {
        const Band band = bandOf(twoBalls(gap, 8));
        checkResult("balls " + std::to_string(gap) + " apart", march(band, {kFarSide}));
    }
}

TEST_CASE("hard surfaces: no distance is negative") {
    const Point half(12.3, 9.7, 14.2), aside(0.3, -0.2, 0.1);
    const auto negative = [](const openvdb::FloatGrid::Ptr& grid, const std::vector<Point>& seeds) {
        const Band band = bandOf(grid);
        return checkField(march(band, seeds), Nodes::All).negative;
    };
    CHECK(negative(gridOf(box(kOffLattice, half)), {kOffLattice + half}) == 0);
    CHECK(negative(gridOf(torus(kOffLattice, 14, 6)), {kOnTorus, kOnTorus + Point(0.3, 0.1, 0)}) ==
          0);
    for (const double radius : {0.7, 1.0, 1.5, 3.0}) {
        const Point pole = kOffLattice - radius * kWay;
        INFO("radius " << radius);
        CHECK(negative(gridOf(sphere(kOffLattice, radius)), {pole}) == 0);
        CHECK(negative(gridOf(sphere(kOffLattice, radius)), {pole, pole + aside}) == 0);
    }
}

}  // namespace igeo::test
