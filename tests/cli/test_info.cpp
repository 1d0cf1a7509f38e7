// The subcommand info: what it finds out of good files and of bad ones.
#include <support/catch.h>

#include <nlohmann/json.hpp>

#include "program.h"
#include "vdb_files.h"

using namespace igeo::test;
using nlohmann::json;

namespace {

/// The JSON, valid by its schema; the words for people end with its verdict.
json surveyed(const Desk& desk, const std::string& source, int exitCode) {
    const Result asJson = desk.run("info " + source + " --json");
    const Result words = desk.run("info " + source);
    INFO(source << "\n" << words.out << asJson.err << words.err);
    REQUIRE(asJson.exitCode == exitCode);
    CHECK(words.exitCode == exitCode);
    CHECK(asJson.err.empty());
    CHECK(words.err.empty());
    writeBytes(desk / "survey.json", asJson.out);
    CHECK(validBySchema(desk, "info.schema.json", "survey.json"));
    const json j = json::parse(asJson.out);
    CHECK(lines(words.out).back() == j["verdict"].get<std::string>());
    return j;
}

}  // namespace

TEST_CASE("info: shapes are what they are") {
    const Desk desk;
    struct Case {
        std::string shape;
        std::vector<int> genus, rims;
        std::string verdict;
    };
    const auto& [shape, genus, rims, verdict] =
        GENERATE(Case{"sphere", {0}, {0}, "usable: closed surface, 1 piece, genus 0, resolved"},
                 Case{"torus --rotate 1,2,3,40 --translate 1,2,3",
                      {1},
                      {0},
                      "usable: closed surface, 1 piece, genus 1, resolved"},
                 Case{"two-spheres --double",
                      {0, 0},
                      {0, 0},
                      "usable: closed surface, 2 pieces, genus 0 together, resolved"},
                 Case{"plane-patch", {0}, {1}, "usable with care: surface with a rim, 1 piece"},
                 Case{"thin-sheet --param thickness=0.1",
                      {0},
                      {0},
                      "usable with care: closed surface, 1 piece, genus 0; in places"});
    desk.make("in.vdb", shape);
    const json j = surveyed(desk, "in.vdb", 0);
    CHECK(j["usable"] == true);
    CHECK(j["refusal"].is_null());
    CHECK_THAT(j["verdict"].get<std::string>(), Catch::StartsWith(verdict));
    CHECK(j["levelSet"]["grid"] == "psi");
    CHECK(j["levelSet"]["voxelSize"].get<double>() == Approx(0.05));
    std::vector<int> foundGenus, foundRims;
    for (const json& piece : j["surface"]["pieces"]) {
        foundGenus.push_back(piece["genus"]);
        foundRims.push_back(piece["rims"]);
    }
    CHECK(foundGenus == genus);
    CHECK(foundRims == rims);
}

TEST_CASE("info: what it says of the surface is what a run says") {
    const Desk desk;
    desk.make("in.vdb", "torus");
    const json survey = surveyed(desk, "in.vdb", 0), &s = survey["surface"];
    requireDone(desk, "--sdf in.vdb --seed 1.4,0,0 -q -o out.vdb --json r.json --with label");
    const json report = json::parse(readBytes(desk / "r.json"));
    CHECK(s["band"]["nodes"] == report["band"]["nodes"]);
    CHECK(s["band"]["jetVoxels"] == report["parameters"]["bandVoxels"]);
    CHECK(s["band"]["boundsVoxels"] == report["parameters"]["bandBoundsVoxels"]);
    CHECK(s["curvature"]["percentile95"] == report["surface"]["largestCurvature"]);
    CHECK(s["area"].get<double>() == Approx(report["cells"]["area"].get<double>()).epsilon(1e-9));
    CHECK(survey["levelSet"]["activeVoxels"] == report["surface"]["activeVoxels"]);
    CHECK(survey["grids"][0]["activeVoxels"] == report["surface"]["activeVoxels"]);
    requireDone(desk, "--sdf in.vdb --seed 1.4,0,0 -q -o out.vdb --json g.json --scheme godunov");
    const json godunov = json::parse(readBytes(desk / "g.json"));
    CHECK(s["band"]["godunovVoxels"] == godunov["parameters"]["bandVoxels"]);

    Command piped = desk.command("info - --json");
    piped.stdinFile = desk / "in.vdb";
    json fromStream = json::parse(run(piped).out);
    CHECK(fromStream["file"] == "standard input");
    fromStream["file"] = "in.vdb";
    CHECK(fromStream == survey);
    for (const char* threads : {"1", "2"})
        CHECK(desk.run(std::string("info in.vdb --json --threads ") + threads).out ==
              readBytes(desk / "survey.json"));
}

TEST_CASE("info: bad files are told apart, and what can be known of them is said") {
    const Desk desk;
    const auto refused = [&](const std::string& kind, const std::string& says) {
        desk.make("in.vdb", "bad " + kind);
        const json j = surveyed(desk, "in.vdb", 3);
        INFO(kind << "\n" << j.dump(2));
        CHECK_THAT(j["verdict"].get<std::string>(), Catch::StartsWith("not usable: "));
        CHECK_THAT(j["verdict"].get<std::string>(), Catch::Contains(says));
        CHECK(j["usable"] == false);
        CHECK(j["surface"].is_null());
        // The words of the main job.
        const Result run = desk.run("--sdf in.vdb --seed 1,0,0 -q -o out.vdb");
        CHECK(run.err == "implicit-geodesic: error: " + j["refusal"]["what"].get<std::string>() +
                             "\n  " + j["refusal"]["remedy"].get<std::string>() + "\n");
        return j;
    };
    const json fog = refused("fog", "fog volume");
    CHECK(fog["levelSet"].is_null());
    REQUIRE(fog["grids"].size() == 1);
    CHECK(fog["grids"][0]["name"] == "density");
    CHECK(fog["grids"][0]["class"] == "fog volume");
    CHECK(fog["grids"][0]["surface"] == false);
    CHECK(fog["grids"][0]["weight"] == true);
    CHECK(fog["grids"][0]["obstacle"] == true);

    const json whole = refused("int", "int32");
    CHECK(whole["grids"][0]["surface"] == false);
    CHECK(whole["grids"][0]["weight"] == false);
    CHECK(refused("vector", "holds no level set")["grids"][0]["type"] == "vec3s");
    CHECK(refused("no-grids", "holds no grids")["grids"].empty());
    CHECK(refused("two-level-sets", "name one")["grids"].size() == 2);

    const json nan = refused("nan", "NaN");
    CHECK(nan["levelSet"]["badVoxels"] > 0);
    CHECK(nan["levelSet"].count("gradient") == 0);
    const json sheared = refused("sheared", "shears");
    CHECK(sheared["levelSet"].size() == 1);  // its name
    const json hollow = refused("hollow", "hollow");
    CHECK(hollow["levelSet"]["gradient"]["median"] > 0.9);
    // psi in voxels of 0.01: 100, of which the histogram takes up to 4.
    CHECK(refused("scaled-values", "not a distance")["levelSet"]["gradient"]["median"] > 3.9);
    CHECK(refused("empty", "no active voxels")["levelSet"].count("activeVoxels") == 0);

    CHECK(surveyed(desk, "missing.vdb", 3)["grids"].empty());
    writeBytes(desk / "text.vdb", "v 0 0 0\n");
    CHECK_THAT(surveyed(desk, "text.vdb", 3)["verdict"].get<std::string>(),
               Catch::Contains("not a VDB file"));
}

TEST_CASE("info: a grid that is named is chosen, as by --sdf") {
    const Desk desk;
    desk.make("in.vdb", "bad two-level-sets");
    const json j = surveyed(desk, "in.vdb:psi_b", 0);
    CHECK(j["levelSet"]["grid"] == "psi_b");
    CHECK(j["grids"].size() == 2);
    CHECK(surveyed(desk, "in.vdb:psi_c", 3)["grids"].size() == 2);
    const std::string words = desk.run("info in.vdb:psi_b").out;
    CHECK_THAT(words, Catch::Contains("psi_b: float, level set"));
    CHECK_THAT(words, Catch::Contains("(chosen)"));
}

TEST_CASE("info: doubtful places as a volume") {
    const Desk desk;
    desk.make("in.vdb", "box --name shell");
    const Result result = desk.run("info in.vdb --json --problems out.vdb");
    INFO(result.err);
    REQUIRE(result.exitCode == 0);
    CHECK_THAT(result.err, Catch::Contains("in out.vdb"));
    CHECK(desk.run("info in.vdb --problems out.vdb -q").err.empty());
    const json doubtful = json::parse(result.out)["surface"]["doubtful"];
    const auto grid = readVdb(desk / "out.vdb").get<openvdb::FloatGrid>("shell_doubt");
    const auto psi = readVdb(desk / "in.vdb").get<openvdb::FloatGrid>("shell");
    CHECK(grid->activeVoxelCount() == doubtful["nodes"].get<std::uint64_t>());
    CHECK(grid->activeVoxelCount() > 0);
    CHECK(grid->transform() == psi->transform());
    // Not in the middle of a face, on edges only: two coordinates near the half sides.
    for (auto it = grid->cbeginValueOn(); it; ++it) {
        const auto p = grid->indexToWorld(it.getCoord());
        const int near = (std::abs(std::abs(p.x()) - 0.9) < 0.2) +
                         (std::abs(std::abs(p.y()) - 0.7) < 0.2) +
                         (std::abs(std::abs(p.z()) - 0.5) < 0.2);
        if (near < 2 || *it < 1) FAIL("a doubt of " << *it << " at " << p.str());
    }
    // A refused file leaves what is there.
    desk.make("bad.vdb", "bad nan");
    const std::string before = readBytes(desk / "out.vdb");
    CHECK(desk.run("info bad.vdb --problems out.vdb").exitCode == 3);
    CHECK((readBytes(desk / "out.vdb") == before));
}

TEST_CASE("info: wrong usage") {
    const Desk desk;
    desk.make("in.vdb", "sphere --voxel-size 0.1");
    requireRefused(desk, "info", 2, {"required"});
    requireRefused(desk, "info in.vdb --seed 0,0,1", 2, {"--seed"});
    requireRefused(desk, "--seed 0,0,1 info in.vdb", 2, {"info goes before", "--seed"});
    requireRefused(desk, "--sdf in.vdb info in.vdb", 2, {"info goes before", "--sdf"});
    requireRefused(desk, "info in.vdb --problems -", 2, {"--problems", "stdout"});
    requireRefused(desk, "info in.vdb --problems in.vdb", 2, {"overwrite"});
    requireRefused(desk, "info in.vdb --problems none/out.vdb", 2, {"no folder 'none'"});
    // A name is no subcommand.
    CHECK(desk.run("--sdf in.vdb --seed 0,0,1 --name info -o out.vdb -q").exitCode == 0);
    CHECK(desk.run("info -help").out == desk.run("info --help").out);
    CHECK_THAT(desk.run("info --help").out, Catch::Contains("--problems"));
}
