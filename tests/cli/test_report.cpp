#include <support/analytic_band.h>
#include <support/catch.h>
#include <support/pinned.h>
#include <support/two_isolines.h>

#include <algorithm>

#include "output/path_curves.h"
#include "output/report.h"
#include "program.h"

namespace igeo::test {
namespace {

/// A run with a path of each status; everything that can be infinite is.
struct Run : Pinned {
    Band band = planeBand({0, 0, 1}, 0, {-4, -4, -3}, {4, 4, 3}, 2);
    Field field;
    RunReport report;

    Run() {
        band.transform.dx = 0.5;
        band.transform.origin = {10, 20, 30};
        field.band = &band;
        field.distance.assign(band.size(), 3.0);
        field.distance[0] = kInfinity;
        field.scheme = "test";
        field.startRadius = 2;
        SurfacePoint seed;
        seed.askedIndex = {1, 0, 0.5}, seed.pIndex = {1, 0, 0};
        seed.snapDistance = 0.5, seed.start = 4;
        field.seeds = {seed};
        field.summarize();

        Polyline reached;
        reached.status = PathStatus::Reached;
        reached.start = {{11.5, 20, 30}, {11.5, 20, 30}};
        reached.points = {{11.5, 20, 30}, {10.5, 20, 30}};
        reached.normals = {{0, 0, 1}, {0, 0, 1}};
        reached.arcLength = {0, 1}, reached.distance = {3, 2};
        reached.weightedLength = 1, reached.startDistance = 3;
        reached.end = {{10.5, 20, 30.25}, {10.5, 20, 30}, 0.25};
        reached.endDistance = 2;
        Polyline stalled;
        stalled.status = PathStatus::Stalled;
        stalled.points = {{10.05, 20, 30}};
        stalled.arcLength = {0}, stalled.distance = {1.5};
        stalled.startDistance = 1.5;
        report.paths = {reached, stalled, Polyline{}};
        report.surface.file = "a.vdb", report.surface.name = "psi";
        report.seconds = {{"read", 0.25}};
        report.outputs = {{"geodesics", "g.json"}};
        report.warnings = {"mind the gap"};
    }

    std::string account() const {
        return reportJson(report, field, {band.size(), field.reached, field.maxDistance});
    }
};

/// Numbers are finite by JSON's own grammar; the parser refuses NaN and Infinity.
json parse(const std::string& text) {
    CHECK(text.back() == '\n');
    return parseJson(text);
}

}  // namespace

TEST_CASE("geodesicsJson: world units, null for what is not known") {
    const Run run;
    const json j = parse(geodesicsJson(run.report, run.field));
    CHECK(j["schema"] == 3);
    CHECK(j["type"] == "geodesics");
    CHECK(j["surface"]["file"] == "a.vdb");
    CHECK(j["surface"]["voxelSize"] == 0.5);
    CHECK(j["parameters"]["band"] == 1);
    CHECK(j["parameters"]["bandVoxels"] == 2);
    CHECK(j["parameters"]["startRadius"] == 1);
    CHECK(j["parameters"]["maxDistance"].is_null());
    REQUIRE(j["paths"].size() == 3);

    const json& reached = j["paths"][0];
    CHECK(reached["status"] == "reached");
    CHECK(reached["weightedLength"] == 1);
    CHECK(reached["distance"] == 3);
    CHECK(reached["seed"]["index"] == 0);
    CHECK(reached["seed"]["start"] == 2);
    CHECK(reached["seed"]["snapDistance"] == 0.25);
    CHECK(reached["seed"]["asked"] == json({10.5, 20, 30.25}));
    CHECK(reached["vertices"]["position"] == json({{11.5, 20, 30}, {10.5, 20, 30}}));
    CHECK(reached["vertices"]["normal"] == json({{0, 0, 1}, {0, 0, 1}}));
    CHECK(reached["vertices"]["arcLength"] == json({0, 1}));
    CHECK(reached["vertices"]["distance"] == json({3, 2}));

    CHECK(j["paths"][1]["status"] == "stalled");
    CHECK(j["paths"][1]["seed"].is_null());
    CHECK(j["paths"][1]["length"] == 0);
    const json& unreached = j["paths"][2];
    CHECK(unreached["status"] == "unreachable");
    CHECK(unreached["distance"].is_null());
    CHECK(unreached["length"].is_null());
    CHECK(unreached["vertices"]["position"].empty());
}

TEST_CASE("reportJson: the account of a run") {
    const Run run;
    const json j = parse(run.account());
    CHECK(j["type"] == "report");
    CHECK(j["band"]["nodes"] == run.band.size());
    CHECK(j["distance"]["reached"] == run.band.size() - 1);
    CHECK(j["distance"]["unreached"] == 1);
    CHECK(j["distance"]["max"] == 1.5);
    CHECK(j["distance"]["stoppedEarly"] == false);
    CHECK(j["seeds"].size() == 1);
    REQUIRE(j["targets"].size() == 3);
    CHECK(!j["targets"][0].contains("vertices"));
    CHECK(j["seconds"]["read"] == 0.25);
    CHECK(j["outputs"]["geodesics"] == "g.json");
    CHECK(j["warnings"] == json({"mind the gap"}));
}

TEST_CASE("reports: doubles survive the text") {
    Run run;
    run.report.paths[0].points[0] = {1.0 / 3, std::sqrt(2.0), 1e-17};
    const json j = parse(geodesicsJson(run.report, run.field));
    const json& p = j["paths"][0]["vertices"]["position"][0];
    CHECK(p[0].get<double>() == 1.0 / 3);
    CHECK(p[1].get<double>() == std::sqrt(2.0));
    CHECK(p[2].get<double>() == 1e-17);
}

TEST_CASE("reports: names that are no UTF-8 still make valid JSON") {
    Run run;
    run.report.surface.file = "caf\xE9.vdb";
    run.report.surface.name = "\xFF";
    const json geodesics = parse(geodesicsJson(run.report, run.field));
    CHECK(geodesics["surface"]["file"].get<std::string>().substr(0, 3) == "caf");
    CHECK_NOTHROW(parse(run.account()));
}

TEST_CASE("pathCurves: a number and a name for each, through all kinds") {
    Run run;
    run.report.walks = {run.report.paths[0]};
    run.report.pairs.resize(2);
    run.report.pairs[1].path = run.report.paths[0];
    run.report.vias.push_back({"--via p.csv", {}, true, run.report.paths[0]});
    std::string names;
    for (const NamedCurve& c : pathCurves(run.report)) {
        names += c.name + " ";
        CHECK(c.closed == (c.name == "via_0"));
        CHECK(c.number + 1 == std::size_t(std::count(names.begin(), names.end(), ' ')));
    }
    CHECK(names == "target_0 target_1 target_2 walk_0 pair_0 pair_1 via_0 ");
    const json j = parse(geodesicsJson(run.report, run.field));
    CHECK(j["pairs"][0]["status"] == "unreachable");
    CHECK(j["pairs"][1]["pair"] == 1);
    CHECK(j["via"][0]["of"] == "--via p.csv");
    CHECK(j["walks"].size() == 1);
}

TEST_CASE("matrixJson: world units, null where there is no path") {
    const Run run;
    DistanceMatrix m;
    m.seeds = {{"", inWorld(run.field.seeds[0], run.band.transform)}};
    m.targets.resize(3);
    m.targets[2].point.position = {11.5, 20, 30};
    m.distance = {0, kInfinity, 1.0 / 3};
    m.asymmetry = 0.25;
    const json j = parse(matrixJson(run.report, run.field, m));
    CHECK(j["type"] == "matrix");
    CHECK(j["surface"]["grid"] == "psi");
    REQUIRE(j["seeds"].size() == 1);
    REQUIRE(j["targets"].size() == 3);
    CHECK(j["seeds"][0]["position"] == json({10.5, 20, 30}));
    CHECK(j["seeds"][0]["snapDistance"] == 0.25);
    CHECK(j["targets"][2]["position"] == json({11.5, 20, 30}));
    CHECK(j["distance"] == json({{0.0, nullptr, 1.0 / 3}}));
    CHECK(j["asymmetry"] == 0.25);
    CHECK(!j.contains("rows"));

    m.firstRow = 4;
    m.asymmetry = std::nan("");
    const json part = parse(matrixJson(run.report, run.field, m));
    CHECK(part["rows"] == json({{"first", 4}, {"count", 1}}));
    CHECK(part["distance"] == j["distance"]);
    CHECK(part["asymmetry"].is_null());
}

TEST_CASE("isolinesJson: world units") {
    Band band;
    band.transform.dx = 0.5;
    band.transform.origin = {10, 20, 30};
    Field field;
    field.band = &band;
    field.scheme = "test";
    RunReport report;
    report.surface.file = "a.vdb";
    const auto j = parseJson(isolinesJson(report, field, twoLines()));
    CHECK(j["type"] == "isolines");
    CHECK(j["surface"]["file"] == "a.vdb");
    CHECK(j["parameters"]["scheme"] == "test");
    REQUIRE(j["isolines"].size() == 2);
    CHECK(j["isolines"][0]["level"] == 2);
    CHECK(j["isolines"][0]["length"] == 1.5);
    CHECK(j["isolines"][0]["closed"] == true);
    CHECK(j["isolines"][1]["closed"] == false);
    CHECK(j["isolines"][1]["position"] == json({{10, 20, 30.5}, {10, 20, 31}}));
}

TEST_CASE("report: a warning is said once, in words of options") {
    RunReport report;
    report.warn({"", "joinGaps 1 joins nothing", "a", "joinGaps 1 joins nothing"});
    report.warn("a");
    CHECK(report.warnings == std::vector<std::string>{"--join-gaps 1 joins nothing", "a"});
}

}  // namespace igeo::test
