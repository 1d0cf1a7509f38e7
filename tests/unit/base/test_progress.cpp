// What long stages report, and that each of them stops when it is told to.
#include <igeo/base/detail/steps.h>
#include <igeo/base/parallel.h>
#include <igeo/path/trace.h>
#include <igeo/results/farthest_points.h>
#include <igeo/results/isolines.h>
#include <igeo/results/log_map.h>
#include <igeo/surface/level_set_band.h>
#include <support/catch.h>
#include <support/expect_error.h>
#include <support/meshed.h>
#include <support/openvdb.h>

#include <algorithm>
#include <functional>
#include <map>
#include <mutex>
#include <string>
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

TEST_CASE("every long stage says that it begins, goes on, and is done; and stops when told") {
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
             tracePaths(m.band, m.field, m.field.gradient, {target, target}, {}, p);
         }},
        {"logmap", [&](Progress& p) { logMap(m.band, m.field, {}, p); }},
        {"mesh", [&](Progress& p) { surfaceMesh(m.levelSet, m.band, m.field, p); }},
        {"isolines", [&](Progress& p) {
             isolines(m.band, m.field, m.mesh, {5, 10, 20}, p);
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

}  // namespace igeo::test
