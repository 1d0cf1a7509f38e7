// Straightened paths, the accuracy estimate and the extension, on a sphere.
#include <igeo/march/godunov.h>
#include <igeo/march/jet.h>
#include <igeo/path/accuracy_estimate.h>
#include <igeo/path/straighten.h>
#include <igeo/results/extend.h>
#include <igeo/results/field_grids.h>
#include <igeo/surface/level_set_band.h>
#include <support/catch.h>
#include <support/errors.h>
#include <support/exact.h>
#include <support/openvdb.h>
#include <support/shapes.h>

namespace igeo::test {
namespace {

constexpr double kRadius = 0.4, kDx = 0.02;  // 20 voxels

struct Solved {
    LevelSet levelSet = checkedLevelSet(makeLevelSet(sphere(kCenter, kRadius), kDx, 3));
    Band band = bandFromLevelSet(levelSet, std::sqrt(3.0));
    SurfacePoint seed = pointOn(band, kCenter + kRadius * genericDirection());
    SurfacePoint target = pointOn(band, kCenter + kRadius * genericDirection(3));
};

double lengthError(const Solved& s, const Path& path) {
    const double exact = geodesicOnSphere(kCenter, kRadius, worldOf(s.band, s.seed.pIndex),
                                          worldOf(s.band, s.target.pIndex));
    return path.weightedLength * kDx / exact - 1;
}

}  // namespace

TEST_CASE("straighten removes a detour and the march's error from a path") {
    const Solved s;
    const Field field = marchJet(s.band, {}, {s.seed});
    Path path = tracePath(field, s.target);
    REQUIRE(path.status == PathStatus::Reached);
    // Push the path four voxels aside in the middle: (4 pi / length)^2 / 4 longer, and that is
    // about 1 %.
    const std::size_t n = path.vertices.size();
    for (std::size_t k = 1; k + 1 < n; ++k) {
        const double x = double(k) / double(n - 1);
        Vec3d& p = path.vertices[k].pIndex;
        p += 4 * std::sin(3.14159265 * x) *
             normalized(cross(path.vertices.back().pIndex - path.vertices.front().pIndex,
                              surfaceNormal(s.band, p)));
        REQUIRE(projectToSurface(s.band, p));
    }
    path.weightedLength = 0;
    for (std::size_t k = 1; k < n; ++k)
        path.weightedLength += length(path.vertices[k].pIndex - path.vertices[k - 1].pIndex);
    const double before = lengthError(s, path);
    straighten(field, path);
    INFO("before " << before << ", after " << lengthError(s, path));
    CHECK(before > 3e-3);
    // Chords of half a voxel are 0.25 / (24 R^2) = 2.6e-5 short at R = 20.
    CHECK(std::abs(lengthError(s, path)) < 3.9e-5);  // measured 2.5e-5
    CHECK(path.vertices.back().arcLength == path.weightedLength);
    CHECK(path.vertices.back().distance == 0);
    for (const PathVertex& v : path.vertices)
        REQUIRE(std::abs(samplePsi(s.band, v.pIndex).psi) < 1.5e-06);  // measured 9.7e-07
}

TEST_CASE("straighten: distances are lengths along the path, also where it finds none shorter") {
    const Solved s;
    const Field field = marchJet(s.band, {}, {s.seed});
    Path path = tracePath(field, s.target);
    for (int round = 0; round < 3; ++round) {
        straighten(field, path);
        for (const PathVertex& v : path.vertices)
            CHECK(v.distance + v.arcLength == Approx(path.weightedLength).epsilon(1e-12));
        // By the tracer's length no curve is shorter now.
        path.weightedLength *= 0.999;
        for (PathVertex& v : path.vertices) v.distance = 1;
    }
}

TEST_CASE("estimateAccuracy tells a good field from a poor one") {
    const Solved s;
    const Field jet = marchJet(s.band, {}, {s.seed});
    GodunovOptions first;
    first.order = 1;
    const Field godunov = marchGodunov(s.band, {}, {s.seed}, first);
    const AccuracyEstimate good = estimateAccuracy(jet);
    const AccuracyEstimate poor = estimateAccuracy(godunov);
    REQUIRE(good.samples > 4);
    REQUIRE(poor.samples > 4);
    INFO("jet " << good.meanError << ", godunov " << poor.meanError);
    // The lengths themselves are good to 7e-4 here; godunov at order 1 is off by about 2 %.
    CHECK(good.largestError < 0.0007);  // measured 0.00046
    CHECK(poor.meanError > 5e-3);
    CHECK(good.fallbackShare < 0.00034);  // measured 0.00023
}

TEST_CASE("extendDistance covers the narrow band with the values of the foot points") {
    const Solved s;
    const Field field = marchJet(s.band, {}, {s.seed});
    auto grid = distanceGrid(field, s.levelSet.psi->transform(), "d");
    const auto before = grid->deepCopy();
    CHECK(grid->activeVoxelCount() == s.band.size());
    extendDistance(*grid, s.levelSet, field);
    CHECK(grid->activeVoxelCount() == s.levelSet.psi->activeVoxelCount());
    const auto old = before->getConstAccessor();
    const openvdb::Vec3d seed = worldOf(s.band, s.seed.pIndex);
    double worst = 0;
    for (auto it = grid->cbeginValueOn(); it; ++it) {
        const auto c = it.getCoord();
        if (old.isValueOn(c)) REQUIRE(old.getValue(c) == *it);
        // On a sphere foot points lie on the ray from the center.
        worst = std::max(
            worst, std::abs(*it - geodesicOnSphere(kCenter, kRadius, seed, grid->indexToWorld(c))));
    }
    // At the edge of the layer normals come from one side only: off by half a voxel times the
    // curvature, 1/40, three voxels from the foot point. Twice that, to allow for three axes.
    CHECK(worst < 0.15 * kDx);
}

}  // namespace igeo::test
