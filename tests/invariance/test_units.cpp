// Small and large units: the same distances in other numbers, or a refusal that names the unit.
#include <igeo/geodesic_solver.h>
#include <support/catch.h>
#include <support/clouds.h>
#include <support/expect_error.h>
#include <support/march_cases.h>
#include <support/mesh_shapes.h>
#include <support/openvdb.h>

namespace igeo::test {
namespace {

using Kind = Error::Kind;

constexpr double kMajor = 1, kMinor = 0.35;

Vec3d onTorus(double u, double v) {
    const double r = kMajor + kMinor * std::cos(v);
    return {r * std::cos(u), r * std::sin(u), kMinor * std::sin(v)};
}

TriangleMesh meshIn(double unit) {
    TriangleMesh torus =
        sheet(60, 24, [](double u, double v) { return onTorus(2 * M_PI * u, 2 * M_PI * v); });
    weld(torus);
    return moved(torus, [&](const Vec3d& p) { return unit * p; });
}

PointCloud cloudIn(double unit) {
    return movedCloud(torusCloud(4000, kMajor, kMinor, {}),
                      [&](const Vec3d& p) { return unit * p; });
}

Seeds from(const Vec3d& p, double start = 0) {
    Seeds seeds;
    seeds.points.emplace_back(p, start);
    return seeds;
}

/// From one point to three others.
std::vector<double> distances(const Surface& surface, double unit) {
    const GeodesicSolver solver{surface};
    MarchLimits limits;
    for (const double u : {0.4, 1.7, 2.9}) limits.targets.push_back(unit * onTorus(u, 2 * u));
    const Vec3d seed = unit * onTorus(0, 1);
    const Distance distance = solver.distance(from(seed), limits);
    std::vector<double> found;
    for (const Polyline& path : distance.paths()) found.push_back(path.startDistance);
    return found;
}

/// Largest |b / scale - a|, voxels.
double worst(const std::vector<double>& a, const std::vector<double>& b, double scale, double dx) {
    REQUIRE(a.size() == b.size());
    double most = 0;
    for (std::size_t k = 0; k < a.size(); ++k)
        most = std::max(most, std::abs(b[k] / scale - a[k]) / dx);
    return most;
}

const VoxelOptions kVoxels{0, 40, Scheme::Jet};
constexpr double kDx = 2 * (kMajor + kMinor) / 40;
const std::vector<double> kPowers{0x1p-10, 0x1p30}, kUnits{3e-4, 7.3e-3, 1e3, 1e9, 1e15},
    kNoUnits{1e-4, 1e-9, 1e-40, 1e-200, 1e18, 1e40, 1e200};

}  // namespace

TEST_CASE("units: level sets of voxels from 1.5e-5 to 1e15 give the same distances") {
    const auto grid = torusGrid();
    const Band band = bandOf(grid, 2.5);
    for (const int order : {kJet, 1, 2}) {
        const Field field = march(band, torusPoints(), order);
        for (const double dx : {1.6e-5, 7.3e-3, 1e9, 9e14}) {
            INFO("order " << order << ", voxels of " << dx);
            const Band other = bandOf(inUnits(*grid, dx), 2.5);
            CHECK(worstDifference(field, march(other, torusPoints(), order)) <=
                  roundingTolerance(field, order, 1e-5));
        }
    }
    expectError(Kind::BadInput, {"1e+18 units", "1e+15", "larger unit"},
                [&] { bandOf(inUnits(*grid, 1e18), 2.5); });
}

TEST_CASE("units: meshes give the same distances, or are refused") {
    // jet decides by thresholds, which a rounding may tip.
    constexpr double kRounding = 0.0026;  // measured 0.0017 voxels
    const std::vector<double> home = distances(Surface(meshIn(1), kVoxels), 1);
    CHECK(home[2] > 2.8);
    for (const double unit : kPowers)
        CHECK(worst(home, distances(Surface(meshIn(unit), kVoxels), unit), unit, kDx) == 0);
    for (const double unit : kUnits) {
        INFO("in units of " << unit);
        CHECK(worst(home, distances(Surface(meshIn(unit), kVoxels), unit), unit, kDx) < kRounding);
    }
    for (const double unit : kNoUnits) {
        INFO("in units of " << unit);
        expectError(Kind::BadInput, {"units of its coordinates", "1.5e-05", "1e+15", "unit,"},
                    [&] { Surface(meshIn(unit), kVoxels); });
    }
}

TEST_CASE("units: points give the same distances, or are refused") {
    constexpr double kRounding = 1e-9;
    const std::vector<double> home = distances(Surface(cloudIn(1), kVoxels), 1);
    CHECK(home[2] > 2.8);
    for (const double unit : kPowers)
        CHECK(worst(home, distances(Surface(cloudIn(unit), kVoxels), unit), unit, kDx) == 0);
    for (const double unit : kUnits) {
        INFO("in units of " << unit);
        CHECK(worst(home, distances(Surface(cloudIn(unit), kVoxels), unit), unit, kDx) < kRounding);
    }
    for (const double unit : kNoUnits) {
        INFO("in units of " << unit);
        expectError(Kind::BadInput, {"units of its coordinates", "1.5e-05", "1e+15", "unit,"},
                    [&] { Surface(cloudIn(unit), kVoxels); });
    }
}

TEST_CASE("units: what leaves the range of numbers is refused with the range") {
    const GeodesicSolver solver{Surface(meshIn(1), kVoxels)};
    const Vec3d at = onTorus(0, 1);
    for (const double start : {1e20, 1e39, 1e300})
        expectError(Kind::InvalidArgument, {"starts at", "6.75e+10", "1e12 voxels"},
                    [&] { solver.distance(from(at, start)); });
    for (const double length : {1e7, 1e39, 1e300})
        expectError(Kind::InvalidArgument, {"allowed are 0 to 675000", "1e7 voxels"}, [&] {
            solver.shoot(at, {0, 1, 0}, length);
        });
    const Polyline path = solver.shoot(at, {0.1, 1, 0.2}, 0.5);
    for (const double factor : {1e-300, 1e-20, 1e20, 1e300}) {
        INFO("a direction of length " << factor);
        const Polyline other = solver.shoot(at, factor * Vec3d{0.1, 1, 0.2}, 0.5);
        CHECK(length(other.points.back() - path.points.back()) < 1e-6);
    }
    Metric metric;
    const Band& band = *solver.wholeBand();
    for (const float weight : {1e-30F, 1e-16F, 1e16F, 1e30F}) {
        metric.weight.assign(band.size(), weight);
        expectError(Kind::InvalidArgument, {"weight", "1e-15 to 1e+15", "factor"},
                    [&] { metric.check(band); });
    }
    metric.weight.clear();
    for (const float g : {1e-30F, 1e-16F, 1e16F, 1e30F}) {
        metric.tensor.assign(band.size(), Tensor{g, g, g, 0, 0, 0});
        expectError(Kind::InvalidArgument, {"tensor", "1e-15 to 1e+15", "factor"},
                    [&] { metric.check(band); });
    }
}

}  // namespace igeo::test
