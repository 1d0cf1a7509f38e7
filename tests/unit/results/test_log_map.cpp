// The logarithmic map: exact on the plane, frames, labels, weights, grids.
#include <igeo/base/parallel.h>
#include <igeo/march/godunov.h>
#include <igeo/march/jet.h>
#include <igeo/results/field_grids.h>
#include <igeo/results/log_map.h>
#include <support/analytic_band.h>
#include <support/catch.h>
#include <support/expect_error.h>
#include <support/openvdb.h>

#include <cstring>

namespace igeo::test {
namespace {

const Vec3d kNormal = normalized(Vec3d{0.2, -0.3, 1});

Band tiltedPlane() { return planeBand(kNormal, 0.4, {-20, -16, -12}, {20, 16, 12}, 2); }

/// By how much the map leads past a node, sideways: what it has closer than the field, whose
/// distances are those of the map. Voxels.
double worstOnPlane(const Field& field, const LogMap& map, double weight = 1) {
    const Band& band = *field.band;
    double worst = 0;
    for (NodeIndex i = 0; i < band.size(); ++i) {
        const std::size_t k = field.label.empty() ? 0 : field.label[i];
        const SurfacePoint& seed = field.seeds[k];
        const Vec3d way = weight * (band.footPoint(i) - seed.pIndex);
        const LogMap::Frame& f = map.frames[k];
        const Vec2f at = map.position[i];
        const double d = std::hypot(at.x, at.y);
        REQUIRE(d == Approx(field.distance[i] - seed.start).margin(1e-5));
        if (d < 1e-3) continue;
        CHECK(at.x * dot(way, f.u) + at.y * dot(way, f.v) > 0);
        worst = std::max(worst, std::abs(at.x * dot(way, f.v) - at.y * dot(way, f.u)) / d);
    }
    return worst;
}

// jet is exact on a plane up to the floats of its gradients. Measured 2.7e-5, with a weight of 3
// 1.1e-4.
constexpr double kFloat = 5.7e-5;

}  // namespace

TEST_CASE("logMap: the plane itself") {
    const Band band = tiltedPlane();
    const SurfacePoint seed = nearestSurfacePoint(band, {1.3, -2.2, 0});
    const Field field = marchJet(band, {}, {seed});
    const LogMap map = logMap(field);
    REQUIRE(map.frames.size() == 1);
    REQUIRE(map.position.size() == band.size());
    const LogMap::Frame& f = map.frames[0];
    // Of the axes, x is the least along this normal.
    CHECK(length(f.u - normalized(tangential(Vec3d{1, 0, 0}, kNormal))) <
          9.5e-09);                                      // measured 6.3e-09
    CHECK(length(cross(f.u, f.v) - kNormal) < 1.3e-08);  // measured 8.4e-09
    CHECK(worstOnPlane(field, map) < kFloat);

    const Vec3d reference{-1, 2, 7};
    const LogMap other = logMap(field, reference);
    CHECK(length(other.frames[0].u - normalized(tangential(reference, kNormal))) <
          1.7e-08);  // measured 1.1e-08
    CHECK(worstOnPlane(field, other) < kFloat);
    CHECK(length(logMap(field, 4.0 * kNormal).frames[0].u - f.u) < 1e-6);
}

TEST_CASE("logMap: u x v is the normal in the world, where voxels are mirrored too") {
    Band band = tiltedPlane();
    const Field plain = marchJet(band, {}, {nearestSurfacePoint(band, {1.3, -2.2, 0})});
    const LogMap before = logMap(plain);
    band.transform.axis[1] = -band.transform.axis[1];
    const Field field = marchJet(band, {}, plain.seeds);
    const LogMap map = logMap(field);
    const LogMap::Frame& f = map.frames[0];
    auto inWorld = [&](const Vec3d& v) { return band.transform.worldFromIndexDirection(v); };
    CHECK(length(cross(inWorld(f.u), inWorld(f.v)) - inWorld(kNormal)) < 1.3e-8);
    CHECK(worstOnPlane(field, map) < kFloat);
    CHECK(map.position[0].y == -before.position[0].y);
}

TEST_CASE("logMap: each node in the frame of the seed it is nearest to; starts are no length") {
    const Band band = tiltedPlane();
    SurfacePoint late = nearestSurfacePoint(band, {-12, 5, 0});
    late.start = 4;
    const Field field = marchJet(band, {}, {nearestSurfacePoint(band, {9, -4, 0}), late});
    const LogMap map = logMap(field);
    REQUIRE(map.frames.size() == 2);
    // Where fronts meet, nodes lack the neighbors on the other side, and gradients are off by
    // some 2e-3.
    CHECK(worstOnPlane(field, map) < 0.036);  // measured 0.024
    std::size_t second = 0;
    for (const auto l : field.label) second += l;
    CHECK(second > band.size() / 10);
}

TEST_CASE("logMap: a constant weight scales it") {
    const Band band = tiltedPlane();
    const auto metric = std::make_shared<Metric>();
    metric->weight.assign(band.size(), 3.0f);
    const Field field = marchJet(band, metric, {nearestSurfacePoint(band, {1.3, -2.2, 0})});
    CHECK(worstOnPlane(field, logMap(field), 3) < 3 * kFloat);
}

TEST_CASE("logMap: a cylinder unrolled") {
    constexpr double kR = 9;
    const Band band = analyticBand([](const Vec3d& p) { return std::hypot(p.x, p.y) - kR; },
                                   [](const Vec3d& p) {
                                       return normalized(Vec3d{p.x, p.y, 0});
                                   },
                                   {-12, -12, -15}, {12, 12, 15}, 2);
    const SurfacePoint seed = nearestSurfacePoint(band, {kR, 0.3, 0.2});
    const Field field = marchJet(band, {}, {seed});
    const LogMap map = logMap(field, {0, 0, 1});
    double worst = 0;
    for (NodeIndex i = 0; i < band.size(); ++i) {
        const Vec3d q = band.footPoint(i);
        const double turn = std::remainder(
            std::atan2(q.y, q.x) - std::atan2(seed.pIndex.y, seed.pIndex.x), 2 * M_PI);
        // The far side is reached from both sides.
        if (std::abs(turn) > 0.85 * M_PI) continue;
        // u up, and v = n x u: against the turn.
        const Vec2f at = map.position[i];
        worst = std::max(worst, std::hypot(at.x - (q.z - seed.pIndex.z), at.y + kR * turn));
    }
    // Half a degree of 25 voxels.
    CHECK(worst < 0.051);  // measured 0.034
}

TEST_CASE("logMap: unknown where nothing arrived, and not active in its grid") {
    Band band = tiltedPlane();
    band.transform.dx = 0.5;
    JetOptions options;
    options.maxDistance = 9;
    const Field field = marchJet(band, {}, {nearestSurfacePoint(band, {1.3, -2.2, 0})}, options);
    const LogMap map = logMap(field);
    std::size_t known = 0;
    for (NodeIndex i = 0; i < band.size(); ++i) {
        REQUIRE(std::isnan(map.position[i].x) == !(field.distance[i] < kInfinity));
        known += field.distance[i] < kInfinity;
    }
    REQUIRE(known < band.size());
    const auto transform = openvdb::math::Transform::createLinearTransform(0.5);
    const auto grid = logMapGrid(band, map, *transform, "log");
    CHECK(grid->activeVoxelCount() == known);
    CHECK(grid->getName() == "log");
    CHECK(grid->getVectorType() == openvdb::VEC_INVARIANT);
    for (auto it = grid->cbeginValueOn(); it; ++it) {
        const openvdb::Coord c = it.getCoord();
        const Vec2f at = map.position[band.nodeAt({c.x(), c.y(), c.z()})];
        REQUIRE(*it == openvdb::Vec3s(0.5f * at.x, 0.5f * at.y, 0));
    }
}

TEST_CASE("logMap: the same bits on any number of threads; a field of jet it has to be") {
    const Band band = sphereBand({0.3, -0.2, 0.1}, 12, 2);
    const SurfacePoint seed = nearestSurfacePoint(band, {9, 3, 6});
    const auto with = [&](int threads) {
        const ThreadLimit limit(threads);
        return logMap(marchJet(band, {}, {seed})).position;
    };
    const auto one = with(1);
    for (const int threads : {2, 5}) {
        const auto many = with(threads);
        CHECK(std::memcmp(one.data(), many.data(), one.size() * sizeof(Vec2f)) == 0);
    }
    const Field voxels = marchGodunov(band, {}, {seed});
    expectError(Error::Kind::InvalidArgument, {"jet"}, [&] { logMap(voxels); });
}

}  // namespace igeo::test
