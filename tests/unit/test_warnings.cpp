// Sentences on what may be wrong with results.
#include <igeo/metric/obstacles.h>
#include <igeo/warnings.h>
#include <support/catch.h>
#include <support/openvdb.h>
#include <support/shapes.h>

#include <cmath>
#include <utility>

namespace igeo::test {
namespace {

const double kDx = 0.05;

Surface ball(double radius = 0.4) {
    return Surface(*makeLevelSet(sphere({0, 0, 0}, radius), kDx, 4));
}

/// Two squares of side 1, `gap` apart.
TriangleMesh squares(double gap) {
    TriangleMesh mesh;
    for (const double left : {0.0, 1 + gap}) {
        const auto a = std::uint32_t(mesh.points.size());
        for (const auto& [x, y] : {std::pair(0, 0), {1, 0}, {1, 1}, {0, 1}})
            mesh.points.push_back({left + x, double(y), 0});
        mesh.triangles.push_back({a, a + 1, a + 2});
        mesh.triangles.push_back({a, a + 2, a + 3});
    }
    return mesh;
}

Polyline pathOf(double distance, double length) {
    Polyline p;
    p.status = PathStatus::Reached;
    p.startDistance = distance, p.weightedLength = length;
    return p;
}

TEST_CASE("warnings of paths: lengths that disagree with distances") {
    const Surface surface = ball();
    auto warned = [&](bool byJet, double distance, double length) {
        return pathWarnings(surface, byJet, {pathOf(distance * kDx, length * kDx)});
    };
    CHECK(warned(false, 60, 62).empty());  // two voxels, but few percent
    CHECK(warned(false, 6, 7.8).empty());  // many percent, but below two voxels
    CHECK(warned(false, 60, 58).empty());
    CHECK(warned(true, 120, 122).empty());
    const auto longer = warned(false, 20, 24), shorter = warned(false, 40, 30),
               jet = warned(true, 60, 62);
    REQUIRE(longer.size() == 1);
    CHECK_THAT(longer[0], startsWith("1 of 1 paths are longer or shorter than their distances by "
                                     "more than 5 % (target 0 by 20 %)"));
    REQUIRE(shorter.size() == 1);
    CHECK_THAT(shorter[0], contains("(target 0 by 25 %)"));
    REQUIRE(jet.size() == 1);
    CHECK_THAT(jet[0], contains("by more than 2 %"));

    PairDistance pair;
    pair.path = pathOf(60 * kDx, 62 * kDx);
    const auto ofPairs = pathWarnings(surface, {PairDistance{}, pair});
    REQUIRE(ofPairs.size() == 1);
    CHECK_THAT(ofPairs[0], startsWith("1 of 1 paths") && contains("(pair 1 by 3 %)"));
}

TEST_CASE("warnings of paths: long steps, on voxels") {
    std::vector<Polyline> paths(3);
    for (std::size_t k = 0; k < 3; ++k)
        for (int i = 0; i < 4; ++i)
            paths[k].points.emplace_back(kDx * i, 0, k == 1 && i == 3 ? 3 * kDx : 0);
    const auto found = pathWarnings(ball(), true, paths);
    REQUIRE(found.size() == 1);
    CHECK_THAT(found[0],
               startsWith("1 of 3 paths have a step of more than 2.5 voxels (target 1: 3.2)"));
    CHECK(pathWarnings(Surface(squares(1), {.size = kDx}), true, paths).empty());
}

TEST_CASE("warnings of the surface: once its band is made") {
    const GeodesicSolver solver(Surface(squares(1), {.size = kDx, .joinGaps = 0.5}));
    CHECK(surfaceWarnings(solver).empty());
    const Distance distance = solver.distance({{0.5, 0.5, 0}});
    const auto found = surfaceWarnings(solver);
    REQUIRE(found.size() == 1);
    CHECK_THAT(found[0], startsWith("joinGaps 0.5 joins nothing"));
    CHECK(marchWarnings(distance).empty());
    CHECK(lostWarnings(distance).empty());  // no triangle joins the other square

    const GeodesicSolver joined(Surface(squares(0.2), {.size = kDx, .joinGaps = 0.5}));
    joined.distance({{0.5, 0.5, 0}});
    CHECK(surfaceWarnings(joined).empty());
}

TEST_CASE("warnings of a march: costs of a part, seeds that start too late") {
    const Surface surface = ball();
    const std::shared_ptr<const Band> band = surface.band(bandWidth(surface, {}));
    std::vector<float> steep;  // 60 % per voxel
    for (NodeIndex i = 0; i < band->size(); ++i)
        steep.push_back(float(std::exp(0.6 * band->footPoint(i).x)));
    SolverOptions options;
    options.metric.nodeWeights = {steep};
    const GeodesicSolver solver(surface, options);
    const Seeds late{{{0, 0, 0.4}, {{0, 0, -0.4}, 1e3}}};
    const auto found = marchWarnings(solver.distance(late), {"first", "second"});
    REQUIRE(found.size() == 2);
    CHECK_THAT(found[0], contains("second"));
    CHECK_THAT(found[1], contains("weight"));
    CHECK(surfaceWarnings(solver) == std::vector<std::string>{found[1]});
}

TEST_CASE("An estimate that takes scatter for facets says how much of it is in doubt") {
    AccuracyEstimate estimate;
    estimate.samples = 16, estimate.meanError = 0.004, estimate.withoutFacets = 0.001;
    const auto found = estimateWarnings(estimate);
    REQUIRE(found.size() == 1);
    CHECK(found[0].rfind("75 % of the estimated error, 0.4 %, is in doubt", 0) == 0);
    estimate.withoutFacets = 0.002;  // either way within a factor of three
    CHECK(estimateWarnings(estimate).empty());
}

}  // namespace
}  // namespace igeo::test
