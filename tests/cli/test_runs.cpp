// What options do to the result, and what they must not do to it.
#include <support/catch.h>

#include <algorithm>
#include <filesystem>

#include "program.h"
#include "vdb_files.h"

namespace igeo::test {
using openvdb::FloatGrid;

namespace {

/// Every active value of `part` is that of `whole`, bit by bit.
bool isPartOf(const FloatGrid& part, const FloatGrid& whole) {
    const auto other = whole.getConstAccessor();
    for (auto value = part.cbeginValueOn(); value; ++value) {
        float there = 0;
        if (!other.probeValue(value.getCoord(), there) || there != *value) return false;
    }
    return true;
}

std::size_t countWithin(const FloatGrid& grid, float limit) {
    std::size_t n = 0;
    for (auto value = grid.cbeginValueOn(); value; ++value) n += *value <= limit;
    return n;
}

/// A report without what depends on the machine.
json timeless(const std::string& text) {
    json report = parseJson(text);
    for (const char* name : {"seconds", "peakMemoryBytes", "outputs", "command"})
        report.erase(name);
    report["parameters"].erase("threads");
    return report;
}

}  // namespace

TEST_CASE("option --max-distance gives the part of the full result within it") {
    const std::string limit = GENERATE("0.05", "0.5", "1.7");
    const std::string scheme = GENERATE("jet", "godunov");
    const TempWorkspace desk;
    desk.make("in.vdb", "torus");
    const std::string base = "--sdf in.vdb --seed 1.4,0,0 -q --scheme " + scheme + " ";
    requireDone(desk, base + "-o full.vdb --report full.json");
    requireDone(desk, base + "-o near.vdb --report near.json --max-distance " + limit);
    const auto full = readDistance(desk / "full.vdb"), near = readDistance(desk / "near.vdb");
    CHECK(near->activeVoxelCount() > 0);
    CHECK(near->activeVoxelCount() < full->activeVoxelCount());
    CHECK(near->activeVoxelCount() == countWithin(*full, std::stof(limit)));
    CHECK(isPartOf(*near, *full));
    const json report = readJson(desk / "near.json");
    CHECK(report["distance"]["stoppedEarly"] == true);
    CHECK(report["parameters"]["maxDistance"] == std::stod(limit));
    // What lies on the far side is not even looked at: the torus is 56 voxels wide.
    const json whole = readJson(desk / "full.json");
    if (limit == "0.05") CHECK(report["band"]["nodes"] < whole["band"]["nodes"]);
}

TEST_CASE("option --stop-at-targets changes neither distances nor paths") {
    const std::string scheme = GENERATE("jet", "godunov");
    const TempWorkspace desk;
    desk.make("in.vdb", "torus");
    const std::string base =
        "--sdf in.vdb --seed 1.4,0,0 --target 1,0.1,0.4 --target 0,1.4,0 -q --scheme " + scheme +
        " ";
    requireDone(desk, base + "-o full.vdb --paths full.obj");
    requireDone(desk, base + "-o part.vdb --paths part.obj --stop-at-targets");
    const auto full = readDistance(desk / "full.vdb"), part = readDistance(desk / "part.vdb");
    CHECK(part->activeVoxelCount() < full->activeVoxelCount());
    CHECK(isPartOf(*part, *full));
    CHECK((readBytes(desk / "part.obj") == readBytes(desk / "full.obj")));
}

TEST_CASE("several seeds give the least of their distances, start values added") {
    const TempWorkspace desk;
    desk.make("in.vdb", "sphere");
    writeBytes(desk / "seeds.csv", "\xEF\xBB\xBFx,y,z,start\r\n0,0,1,0\r\n0,0,-1,0.75 # late\r\n");
    writeBytes(desk / "seeds.json",
               "[[0, 0, 1], {\"position\": [0, 0, -1], \"start\": 0.75, \"label\": \"late\"}]");
    const std::string rest = " --target 0,0,-1 -q --report report.json -o ";
    requireDone(desk, "--sdf in.vdb --seeds seeds.csv" + rest + "csv.vdb");
    const json report = readJson(desk / "report.json");
    CHECK(report["seeds"].size() == 2);
    CHECK(report["seeds"][1]["start"] == Approx(0.75));
    CHECK(report["targets"][0]["seed"]["index"] == 1);
    CHECK(report["targets"][0]["distance"].get<double>() == Approx(0.75).margin(1e-6));
    requireDone(desk, "--sdf in.vdb --seeds seeds.json" + rest + "json.vdb");
    CHECK((readBytes(desk / "csv.vdb") == readBytes(desk / "json.vdb")));
    // Both fronts meet where d = (pi + 0.75) / 2; a front's error is below a voxel of 0.05.
    CHECK(readDistance(desk / "csv.vdb")->background() == Approx((M_PI + 0.75) / 2).margin(0.1));
}

TEST_CASE("points in index space mean the same as their world positions") {
    const TempWorkspace desk;
    desk.make("in.vdb", "sphere");  // index 20 is 1 in the world
    requireDone(desk, "--sdf in.vdb --seed 0,0,1 --target 1,0,0 -q -o world.vdb --paths w.obj");
    requireDone(desk,
                "--sdf in.vdb --seed 0,0,20 --target 20,0,0 --space index -q -o index.vdb "
                "--paths i.obj");
    CHECK((readBytes(desk / "world.vdb") == readBytes(desk / "index.vdb")));
    CHECK((readBytes(desk / "w.obj") == readBytes(desk / "i.obj")));
}

TEST_CASE("the same run gives the same bytes, on one thread and on two") {
    const std::string scheme = GENERATE("jet", "godunov --order 1", "godunov --order 2");
    const TempWorkspace desk;
    desk.make("in.vdb", "trefoil --voxel-size 0.03 --rotate 1,2,3,30");
    const std::string base =
        "--sdf in.vdb --seed 0,-0.42,0 --target 0.05,0.9,0.1 --target -0.6,0.3,-0.2 --snap 1 "
        "--grids surface,gradient -q --scheme " +
        scheme;
    // Documents have the command line, so each run writes the same names.
    const auto runAs = [&](const std::string& name, const std::string& threads) {
        Command command = desk.command(
            base + " -o out.vdb --paths out.json --report out_report.json --threads " + threads);
        command.environment["SOURCE_DATE_EPOCH"] = "0";
        REQUIRE(run(command).exitCode == 0);
        for (const char* end : {".vdb", ".json", "_report.json"})
            std::filesystem::rename(desk / (std::string("out") + end), desk / (name + end));
    };
    runAs("one", "1");
    runAs("two", "2");
    runAs("again", "2");
    for (const std::string other : {"two", "again"}) {
        CHECK((readBytes(desk / "one.vdb") == readBytes(desk / (other + ".vdb"))));
        CHECK((readBytes(desk / "one.json") == readBytes(desk / (other + ".json"))));
        CHECK(timeless(readBytes(desk / "one_report.json")) ==
              timeless(readBytes(desk / (other + "_report.json"))));
    }
    CHECK(readJson(desk / "one_report.json")["parameters"]["threads"] == 1);
    CHECK(readJson(desk / "two_report.json")["parameters"]["threads"] == 2);
}

}  // namespace igeo::test
