#include <igeo/base/parallel.h>
#include <igeo/metric/grid_sampling.h>
#include <igeo/surface/level_set_band.h>
#include <support/analytic_band.h>
#include <support/catch.h>
#include <support/errors.h>
#include <support/expect_error.h>
#include <support/openvdb.h>
#include <support/shapes.h>

#include <cmath>

namespace igeo::test {
namespace {

const Vec3d kBallCenter{1.37, -2.91, 4.13};
constexpr double kBallRadius = 6;

/// A sphere whose placement in the world is anything but plain.
Band placedSphere() {
    Band band = sphereBand(kBallCenter, kBallRadius, 1.8);
    const auto m = rotatedTransform(0.25, {1, -2, 3}, 40, {10, -20, 5});
    const auto image = [&](const openvdb::Vec3d& p) {
        const openvdb::Vec3d q = m->indexToWorld(p);
        return Vec3d{q.x(), q.y(), q.z()};
    };
    band.transform.dx = 0.25;
    band.transform.origin = image({0, 0, 0});
    for (int a = 0; a < 3; ++a) {
        openvdb::Vec3d unit(0.0);
        unit[a] = 1;
        band.transform.axis[std::size_t(a)] = (image(unit) - band.transform.origin) * 4.0;
    }
    return band;
}

/// Voxels thrice as long along one axis as along another, slanted, turned and moved.
openvdb::math::Transform::Ptr slanted() {
    const auto t = openvdb::math::Transform::createLinearTransform(0.2);
    t->preScale(openvdb::Vec3d(1, 0.5, 1.5));
    t->preShear(0.3, openvdb::math::X_AXIS, openvdb::math::Y_AXIS);
    t->postRotate(0.7, openvdb::math::Z_AXIS);
    t->postTranslate({10, -20, 5});
    return t;
}

/// The values of a function of the world position in all voxels of a box around the sphere.
template <typename Grid, typename F>
typename Grid::Ptr sampled(const openvdb::math::Transform::Ptr& transform, const Band& band,
                           const F& f) {
    const auto grid = Grid::create();
    grid->setTransform(transform);
    const Vec3d middle = band.transform.worldFromIndex(kBallCenter);
    const openvdb::Coord c = openvdb::Coord::round(
        transform->worldToIndex(openvdb::Vec3d(middle.x, middle.y, middle.z)));
    const auto box = openvdb::CoordBBox::createCube(c.offsetBy(-32), 64);
    for (auto it = box.begin(); it; ++it)
        grid->tree().setValueOn(*it, f(transform->indexToWorld(*it)));
    return grid;
}

LoadedGrid weightOf(const openvdb::FloatGrid::Ptr& grid) { return {grid, "w.vdb", "cost", false}; }

LoadedGrid constant(float value, float background, const Ijk& low, const Ijk& high) {
    const auto grid = openvdb::FloatGrid::create(background);
    grid->denseFill({{low.x, low.y, low.z}, {high.x, high.y, high.z}}, value);
    return weightOf(grid);
}
const Ijk kLow{-20, -20, -20}, kHigh{20, 20, 20};  ///< around all of the sphere

TensorGrids tensorOf(const openvdb::Vec3SGrid::Ptr& diagonal,
                     const openvdb::Vec3SGrid::Ptr& offdiagonal = nullptr) {
    return {diagonal, offdiagonal, "g.vdb", "diagonal"};
}

/// The length of a vector, squared.
double squared(const Tensor& g, const Vec3d& v) {
    return g.xx * v.x * v.x + g.yy * v.y * v.y + g.zz * v.z * v.z +
           2 * (g.xy * v.x * v.y + g.xz * v.x * v.z + g.yz * v.y * v.z);
}

}  // namespace

TEST_CASE("sampleWeight: a linear weight is exact, whatever the grid's placement") {
    const Band band = placedSphere();
    const auto linear = [](const openvdb::Vec3d& p) {
        return float(20 + 0.3 * p.x() - 0.5 * p.y() + 0.7 * p.z());
    };
    for (const auto& transform : {slanted(), rotatedTransform(0.3, {0, 1, 1}, 130, {9, -21, 6})}) {
        const auto weight =
            sampleWeight(weightOf(sampled<openvdb::FloatGrid>(transform, band, linear)), band);
        REQUIRE(weight.size() == band.size());
        for (NodeIndex i = 0; i < band.size(); ++i) {
            const openvdb::Vec3d p = worldOf(band, band.footPoint(i));
            // Voxels and result are floats below 64: half of 2^-18 each.
            REQUIRE(std::abs(weight[i] - (20 + 0.3 * p.x() - 0.5 * p.y() + 0.7 * p.z())) < 4e-6);
        }
    }
}

TEST_CASE("sampleWeight: on the band's own voxels the world has no effect") {
    Band band = sphereBand(kBallCenter, kBallRadius, 1.8);
    const auto grid = openvdb::FloatGrid::create(3);
    for (NodeIndex i = 0; i < band.size(); ++i) {
        const Ijk v = band.ijk(i);
        grid->tree().setValueOn({v.x, v.y, v.z}, 1 + float(i % 97));
    }
    const auto plain = sampleWeight(weightOf(grid), band);
    const Band placed = placedSphere();
    grid->setTransform(rotatedTransform(0.25, {1, -2, 3}, 40, {10, -20, 5}));
    CHECK(sampleWeight(weightOf(grid), placed) == plain);
}

TEST_CASE("sampleWeight: constant along normals, and the same on any number of threads") {
    const Band band = sphereBand(kBallCenter, 3 * kBallRadius, 1.8);
    const auto grid = sampled<openvdb::FloatGrid>(
        openvdb::math::Transform::createLinearTransform(0.7), band,
        [](const openvdb::Vec3d& p) { return float(2 + std::sin(p.x()) * std::cos(p.y())); });
    const auto weight = sampleWeight(weightOf(grid), band);
    for (NodeIndex i = 0; i < band.size(); ++i) {
        const NodeIndex j = band.nodeAt(roundToIjk(Vec3d(band.ijk(i)) + Vec3d(band.normal[i])));
        if (j == kNoNode) continue;
        // The gradient of the weight is at most sqrt(2).
        const double apart = length(band.footPoint(i) - band.footPoint(j));
        REQUIRE(std::abs(weight[i] - weight[j]) <= 1.5 * apart + 1e-6);
    }
    const ThreadLimit one(1);
    CHECK(sampleWeight(weightOf(grid), band) == weight);
}

TEST_CASE("sampleWeight: voxels that are not active count as the background") {
    const Band band = sphereBand(kBallCenter, kBallRadius, 1.8);
    LoadedGrid half = constant(2, 5, kLow, {1, 20, 20});
    editable(half).tree().setValueOff({3, -3, 10}, 77);  // inactive, and not to be seen
    const auto weight = sampleWeight(half, band);
    for (NodeIndex i = 0; i < band.size(); ++i) {
        const double x = band.footPoint(i).x;
        REQUIRE(weight[i] == Approx(2 + 3 * std::clamp(x - 1, 0.0, 1.0)).epsilon(1e-6));
    }
}

TEST_CASE("sampleWeight: refuses what is no weight, with place, value and remedy") {
    const Band band = placedSphere();
    const auto bad = Error::Kind::BadInput;
    const auto put = [&](float value, float background = 0) {
        LoadedGrid w = constant(2, background, kLow, kHigh);
        editable(w).setTransform(rotatedTransform(0.25, {1, -2, 3}, 40, {10, -20, 5}));
        // Around the foot point of node 1234.
        const Ijk v = floorToIjk(band.footPoint(1234));
        editable(w).denseFill({{v.x, v.y, v.z}, {v.x + 1, v.y + 1, v.z + 1}}, value);
        return w;
    };
    expectError(
        bad,
        {"the weight is 0 there", "w.vdb", "'cost'", "positive", "MetricDefinition::obstacles"},
        [&] { sampleWeight(put(0), band); });
    expectError(bad, {"the weight is -3.5"}, [&] { sampleWeight(put(-3.5f), band); });
    expectError(bad, {"nan"}, [&] { sampleWeight(put(std::nanf("")), band); });
    expectError(bad, {"inf"}, [&] { sampleWeight(put(float(kInfinity)), band); });
    // Not where the surface is.
    LoadedGrid far = put(2);
    editable(far).tree().setValueOn({1, -3, 4}, -1);
    CHECK_NOTHROW(sampleWeight(far, band));

    // The first place in node order and how many, whatever the number of threads.
    LoadedGrid half = constant(2, 0, kLow, {1, 20, 20});
    editable(half).setTransform(rotatedTransform(0.25, {1, -2, 3}, 40, {10, -20, 5}));
    NodeIndex first = kNoNode;
    int count = 0;
    for (NodeIndex i = 0; i < band.size(); ++i)
        if (band.footPoint(i).x > 1) first = std::min(first, i), ++count;
    const Vec3d place = band.transform.worldFromIndex(band.footPoint(first));
    char at[99];
    std::snprintf(at, sizeof at, "at %.6g,%.6g,%.6g", place.x, place.y, place.z);
    for (const int threads : {1, 0}) {
        const ThreadLimit limit(threads);
        expectError(bad,
                    {at, "first of " + std::to_string(count) + " bad",
                     "does not cover the surface there: background is 0"},
                    [&] { sampleWeight(half, band); });
    }
    struct Stop : Progress {
        bool cancelled() const override { return true; }
    } stop;
    expectError(Error::Kind::Cancelled, {}, [&] { sampleWeight(put(2), band, stop); });
}

TEST_CASE("sampleWeight: refuses a grid that lies elsewhere or nowhere") {
    const Band band = sphereBand(kBallCenter, kBallRadius, 1.8);
    const auto bad = Error::Kind::BadInput;
    // Positive as its background is.
    expectError(bad, {"none of the grid's active voxels", "99.5,-0.5,-0.5 to 103.5,5.5,6.5"}, [&] {
        sampleWeight(constant(2, 1, {100, 0, 0}, {103, 5, 6}), band);
    });
    expectError(bad, {"no active voxels"},
                [&] { sampleWeight(weightOf(openvdb::FloatGrid::create(1)), band); });
    LoadedGrid frustum = constant(2, 1, kLow, kHigh);
    editable(frustum).setTransform(openvdb::math::Transform::createFrustumTransform(
        openvdb::BBoxd(openvdb::Vec3d(-30.0), openvdb::Vec3d(30.0)), 0.5, 60, 1));
    expectError(bad, {"not linear", "resample"}, [&] { sampleWeight(frustum, band); });
}

TEST_CASE("leastWeight bounds the weights from below") {
    LoadedGrid w = constant(2, 5, {0, 0, 0}, {3, 3, 3});
    CHECK(leastWeight(w) == 2);
    editable(w).tree().setValueOn({1, 1, 1}, std::nanf(""));
    editable(w).tree().setValueOn({100, 1, 1}, 1.5f);
    editable(w).tree().setValueOff({101, 1, 1}, 0.1f);
    CHECK(leastWeight(w) == 1.5);
    CHECK(leastWeight(constant(2, 0.5f, kLow, kHigh)) == 0.5);
    // A background that is refused where it is met does not count; a weight that would be does.
    CHECK(leastWeight(constant(2, 0, kLow, kHigh)) == 2);
    CHECK(leastWeight(constant(-2, 1, kLow, kHigh)) == 0);
    // Active tiles.
    const auto tiles = openvdb::FloatGrid::create(9);
    tiles->sparseFill({{0, 0, 0}, {63, 63, 63}}, 4);
    CHECK(leastWeight(weightOf(tiles)) == 4);
}

TEST_CASE("sampleTensor: turned into index axes, lengths stay") {
    const Band band = placedSphere();
    const auto d = [](const openvdb::Vec3d& p) {
        return openvdb::Vec3s(float(20 + p.x()), float(30 + 0.5 * p.y()), float(25 - 0.3 * p.z()));
    };
    const auto o = [](const openvdb::Vec3d& p) {
        return openvdb::Vec3s(float(1 + 0.1 * p.y()), 2, float(-0.2 * p.x()));
    };
    // The two grids need not agree in their voxels.
    const auto tensor =
        sampleTensor(tensorOf(sampled<openvdb::Vec3SGrid>(slanted(), band, d),
                              sampled<openvdb::Vec3SGrid>(
                                  rotatedTransform(0.3, {0, 1, 1}, 130, {9, -21, 6}), band, o)),
                     band);
    REQUIRE(tensor.size() == band.size());
    for (NodeIndex i = 0; i < band.size(); ++i) {
        const openvdb::Vec3d p = worldOf(band, band.footPoint(i));
        const openvdb::Vec3s m = d(p), n = o(p);
        const Tensor world{m[0], m[1], m[2], n[0], n[1], n[2]};
        for (const Vec3d v : {Vec3d{1, 0, 0}, Vec3d{0, 1, 0}, Vec3d{0, 0, 1}, Vec3d{0.6, -0.5, 1}})
            // Six components of floats below 64, off by 2^-18 with the turn, over |v|^2 < 2.
            REQUIRE(std::abs(squared(tensor[i], v) -
                             squared(world, band.transform.worldFromIndexDirection(v))) <
                    4.8e-6);  // measured 3.2e-6
    }
}

TEST_CASE("sampleTensor: refuses what is no metric, with place and eigenvalue") {
    const Band band = sphereBand(kBallCenter, kBallRadius, 1.8);
    const auto bad = Error::Kind::BadInput;
    const auto vectors = [&](const openvdb::Vec3s& value, const openvdb::Vec3s& background = {}) {
        const auto grid = openvdb::Vec3SGrid::create(background);
        grid->denseFill({{-20, -20, -20}, {20, 20, 20}}, value);
        return grid;
    };
    const openvdb::Vec3s one(1, 1, 1);
    // Eigenvalues of [1 2; 2 1] are 3 and -1.
    expectError(bad, {"not positive definite", "least eigenvalue is -1", "g.vdb", "'diagonal'"},
                [&] {
                    sampleTensor(tensorOf(vectors(one), vectors({0, 2, 0})), band);
                });
    expectError(bad, {"least eigenvalue is 0"}, [&] {
        sampleTensor(tensorOf(vectors({1, 0, 1})), band);
    });
    expectError(bad, {"1e-6 of the largest"}, [&] {
        sampleTensor(tensorOf(vectors({1, 1, 9e-7f})), band);
    });
    CHECK_NOTHROW(sampleTensor(tensorOf(vectors({1, 1, 2e-6f})), band));
    expectError(bad, {"NaN"}, [&] {
        sampleTensor(tensorOf(vectors(one), vectors({0, std::nanf(""), 0})), band);
    });
    // A part of the surface without a tensor.
    const auto half = vectors(one);
    half->tree().fill({{3, -20, -20}, {20, 20, 20}}, openvdb::Vec3s(0.0f), false);
    expectError(bad, {"does not cover the surface there: background is [0, 0, 0]"},
                [&] { sampleTensor(tensorOf(half), band); });
    // A background is usable, and off-diagonal components may end where they like.
    const auto all = vectors(one, {2, 3, 4});
    all->tree().fill({{3, -20, -20}, {20, 20, 20}}, openvdb::Vec3s(0.0f), false);
    const auto mixed = vectors({0.5f, 0, 0});
    mixed->tree().fill({{3, -20, -20}, {20, 20, 20}}, openvdb::Vec3s(9.0f), false);
    const auto tensor = sampleTensor(tensorOf(all, mixed), band);
    for (NodeIndex i = 0; i < band.size(); ++i) {
        const double outside = std::clamp(band.footPoint(i).x - 2, 0.0, 1.0);
        REQUIRE(tensor[i].zz == Approx(1 + 3 * outside).epsilon(1e-6));
        REQUIRE(tensor[i].xy == Approx(0.5 * (1 - outside)).margin(1e-6));
    }
}

}  // namespace igeo::test
