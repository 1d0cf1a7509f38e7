// What long stages report, and that each of them stops when it is canceled.
#include <igeo/base/detail/steps.h>
#include <igeo/base/parallel.h>
#include <igeo/igeo.h>
#include <igeo/march/signed_field.h>
#include <igeo/path/exponential_map.h>
#include <igeo/path/straighten.h>
#include <igeo/path/trace.h>
#include <igeo/results/farthest_points.h>
#include <igeo/results/isolines.h>
#include <igeo/results/log_map.h>
#include <igeo/surface/level_set_band.h>
#include <igeo/surface/level_set_check.h>
#include <support/catch.h>
#include <support/expect_error.h>
#include <support/mesh_shapes.h>
#include <support/meshed.h>
#include <support/openvdb.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <functional>
#include <map>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

namespace igeo::test {
namespace {

struct Recorder : Progress {
    std::map<std::string, std::vector<double>> seen;
    bool stop = false;

    void update(const char* name, double fraction) override {
        const std::lock_guard<std::mutex> lock(mutex);
        seen[name].push_back(fraction);
    }
    bool cancelled() const override { return stop; }

    std::mutex mutex;
};

/// Asks to stop once it was asked so many times whether to.
struct StopAtLook : Progress {
    explicit StopAtLook(int looks) : left(looks) {}
    bool cancelled() const override { return --left < 0; }
    mutable std::atomic<int> left;
};

/// Asks to stop when a stage of a solver is done.
struct StopAfterStage : Progress {
    explicit StopAfterStage(std::string name) : last(std::move(name)) {}
    void finished(const char* name) override {
        stages.push_back(name);
        stop |= stages.back() == last;
    }
    bool cancelled() const override { return stop; }
    std::string last;
    std::vector<std::string> stages;
    bool stop = false;
};

/// Across the z axis.
Curve circle(const Vec3d& center, double radius) {
    Curve c;
    c.closed = true;
    for (int k = 0; k < 200; ++k) {
        const double a = k * M_PI / 100;
        c.points.push_back(center + radius * Vec3d(std::cos(a), std::sin(a), 0));
    }
    return c;
}

}  // namespace

TEST_CASE("Steps: a part of a stage, from its beginning to its end") {
    Recorder r;
    Steps steps(r, "stage", 4, 0.5, 1);
    for (int k = 0; k < 2; ++k) steps.add(2);
    CHECK(r.seen["stage"] == std::vector<double>{0.5, 0.75, 1});
    CHECK_FALSE(steps.cancelled());
    r.stop = true;
    CHECK(steps.cancelled());
}

TEST_CASE("Steps: shares come in order, also where a thread is slow to report its own") {
    struct SlowHalf : Recorder {
        void update(const char* name, double fraction) override {
            if (fraction == 0.5) {
                begun = true;
                std::this_thread::sleep_for(std::chrono::milliseconds(50));
            }
            Recorder::update(name, fraction);
        }
        std::atomic<bool> begun{false};
    } r;
    Steps steps(r, "stage", 2);
    std::thread slow([&] { steps.add(1); });
    while (!r.begun) std::this_thread::yield();
    steps.add(1);
    slow.join();
    CHECK(r.seen["stage"] == std::vector<double>{0, 0.5, 1});
}

TEST_CASE("every long stage says that it begins, goes on, and is done; and stops when canceled") {
    const ThreadLimit one(1);  // reports in order
    const openvdb::Vec3d center(0.5, 0.5, 0.5);
    const Meshed m = meshed(sphere(center, 0.4), 0.02, {center + openvdb::Vec3d(0.4, 0, 0)});
    const auto grid = m.levelSet.psi->deepCopy();
    LoadedGrid loaded;
    loaded.grid = grid;
    const SurfacePoint target = nearestSurfacePoint(m.band, m.band.footPoint(0));

    const std::map<std::string, std::function<void(Progress&)>> stages{
        {"check", [&](Progress& p) { checkLevelSet(loaded, p); }},
        {"band", [&](Progress& p) { bandFromLevelSet(m.levelSet, m.band.h, {}, p); }},
        {"march", [&](Progress& p) { marchJet(m.band, {}, m.field.seeds, {}, p); }},
        {"points", [&](Progress& p) { farthestPoints(m.band, {}, {}, 20, p); }},
        {"trace",
         [&](Progress& p) {
             tracePaths(m.field, {target, target}, {}, p);
         }},
        {"logmap", [&](Progress& p) { logMap(m.field, {}, p); }},
        {"mesh", [&](Progress& p) { surfaceMesh(m.levelSet, m.field, p); }},
        {"isolines", [&](Progress& p) {
             isolines(m.field, m.mesh, {5, 10, 20}, p);
         }}};
    for (const auto& [name, run] : stages) {
        INFO(name);
        Recorder r;
        run(r);
        REQUIRE(r.seen.size() == 1);
        const std::vector<double>& fractions = r.seen[name];
        REQUIRE(fractions.size() >= 3);
        CHECK(fractions.front() < 0.2);
        CHECK(std::is_sorted(fractions.begin(), fractions.end()));
        CHECK(fractions.back() > 0.75);
        CHECK(fractions.back() <= 1);
        r.stop = true;
        expectError(Error::Kind::Cancelled, {"interrupted"}, [&, &run = run] { run(r); });
    }
}

TEST_CASE("what has no stage of its own stops in its midst when canceled") {
    const ThreadLimit one(1);
    const openvdb::Vec3d center(0.5, 0.5, 0.5);
    const Surface surface(*makeLevelSet(sphere(center, 0.4), 0.01, 3));
    const GeodesicSolver solver(surface);
    const igeo::Distance d = solver.distance({{0.9, 0.5, 0.5}}, {.targets = {{0.1, 0.52, 0.53}}});
    const Band& band = d.band();
    Curve equator = circle({0.5, 0.5, 0.5}, 0.4);
    for (Vec3d& p : equator.points) p = solver.indexOf(p);
    ObstacleSet cap(surface.transform());
    cap.addSphere({0.5, 0.5, 0.9}, 0.2);
    const Field fromCurve = marchJet(band, {}, seedsAlong(band, equator, 1));
    Path path = tracePath(d.field(), d.targets()[0]);
    // Beside a geodesic, so that straightening takes several rounds.
    const Vec3d chord = path.vertices.back().pIndex - path.vertices.front().pIndex;
    for (std::size_t k = 1; k + 1 < path.vertices.size(); ++k) {
        Vec3d& p = path.vertices[k].pIndex;
        p += normalized(cross(surfaceNormal(band, p), chord));
        REQUIRE(projectToSurface(band, p));
    }
    path.length = path.weightedLength *= 2;

    const std::map<std::string, std::function<void(Progress&)>> work{
        {"seedsAlong", [&](Progress& p) { seedsAlong(band, equator, 1, p); }},
        {"seedsAround", [&](Progress& p) { seedsAround(band, cap, p); }},
        {"nodesInside", [&](Progress& p) { nodesInside(band, cap, p); }},
        {"signsOfCurves", [&](Progress& p) { signsOfCurves(fromCurve, p); }},
        {"straighten",
         [&](Progress& p) {
             Path bent = path;
             straighten(d.field(), bent, p);
         }},
        {"shoot", [&](Progress& p) {
             shoot(band, d.seeds()[0], {0, 1, 0.3}, 1000, p);
         }}};
    for (const auto& [name, run] : work) {
        INFO(name);
        StopAtLook never(1 << 30);
        run(never);
        const int looks = (1 << 30) - never.left;
        CHECK(looks >= 2);
        for (const int after : {0, looks / 2, looks - 1}) {
            StopAtLook stop(after);
            expectError(Error::Kind::Cancelled, {"interrupted"}, [&, &run = run] { run(stop); });
        }
    }
}

TEST_CASE("GeodesicSolver: stops while it looks for seeds, their inside, and on a geodesic") {
    using Stages = std::vector<std::string>;
    const Surface surface(sphereMesh({0, 0, 0}, 1, 4), {.size = 0.05});
    const GeodesicSolver solver(surface);
    Seeds curve, region;
    curve.curves = {circle({0, 0, 0}, 1)};
    auto cap = std::make_shared<ObstacleSet>(surface.transform());
    cap->addSphere({0, 0, 1}, 0.5);
    region.regions = {cap};
    curve.isSigned = region.isSigned = true;
    for (const Seeds& seeds : {curve, region}) {
        StopAfterStage none("");
        solver.distance(seeds, {}, none);
        CHECK(none.stages == Stages{"band", "snap", "seeds", "march"});
        StopAfterStage snapped("snap"), marched("march");
        for (StopAfterStage* stop : {&snapped, &marched})
            CHECK_THROWS_WITH(solver.distance(seeds, {}, *stop), "interrupted");
        // The search for seeds has stopped: the march would have, too, but after the stage `seeds`.
        CHECK(snapped.stages == Stages{"band", "snap"});
    }
    // The band is made, so that nothing else is left to stop.
    StopAfterStage stop("");
    stop.stop = true;
    expectError(Error::Kind::Cancelled, {"interrupted"}, [&] {
        solver.shoot({1, 0, 0}, {0, 1, 0.2}, 3, stop);
    });
}

}  // namespace igeo::test
