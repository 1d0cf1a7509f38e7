// Where results and messages go when all is well.
#include <support/catch.h>

#include <cstdlib>
#include <filesystem>

#include "program.h"
#include "vdb_files.h"

namespace igeo::test {
namespace fs = std::filesystem;

TEST_CASE("without -o the result is named after the input, in the current folder") {
    const TempWorkspace desk;
    fs::create_directory(desk / "models");
    desk.make("models/two.vdb", "bad two-level-sets");
    const Result result = requireDone(desk, "--sdf models/two.vdb:psi_b --seed 1,0,0");
    CHECK(lines(result.err).size() == 2);
    CHECK_THAT(result.err, contains("wrote distance to two_geodesic.vdb"));
    CHECK(desk.files().size() == 3);
    CHECK(readVdb(desk / "two_geodesic.vdb").grids.at(0)->getName() == "psi_b_geodesic");
}

TEST_CASE("stdin can be the surface, as a file or as a pipe") {
    const Sphere desk;
    requireDone(desk, "--sdf in.vdb --seed 0,0,1 -o expected.vdb");
    const std::string expected = readBytes(desk / "expected.vdb");
    Command command = desk.command("--sdf - --seed 0,0,1 -q");
    const bool asPipe = GENERATE(false, true);
    if (asPipe)
        command.stdinBytes = readBytes(desk / "in.vdb");
    else
        command.stdinFile = desk / "in.vdb";
    const Result result = run(command);
    INFO(result.err);
    REQUIRE(result.exitCode == 0);
    // Named after the grid: stdin has no name.
    CHECK((readBytes(desk / "psi_geodesic.vdb") == expected));
}

TEST_CASE("the name of a grid from stdin is a name and no path") {
    const TempWorkspace desk;
    fs::create_directory(desk / "here");
    const auto runNamed = [&](const std::string& grid, const std::string& line) {
        desk.make("in.vdb", "sphere --voxel-size 0.1 --name " + grid);
        Command command = desk.command("--sdf - --seed 0,0,1 -q " + line);
        command.workingDirectory = desk / "here";
        command.stdinFile = desk / "in.vdb";
        return run(command);
    };
    writeBytes(desk / "escaped_geodesic.vdb", "from before");
    const std::vector<std::string> paths{"../escaped", "a/b/escaped", "..\\escaped",
                                         desk / "escaped"};
    for (const std::string& grid : paths) {
        INFO(grid);
        CHECK(runNamed(grid, "").exitCode == 0);
        CHECK(readBytes(desk / "escaped_geodesic.vdb") == "from before");
        CHECK(fs::remove(desk / "here/escaped_geodesic.vdb"));
        CHECK(fs::is_empty(desk / "here"));
    }
    // The checks of other outputs: it is an input.
    desk.make("here/w_geodesic.vdb", "sphere --voxel-size 0.1");
    const Result refused = runNamed("../w", "--weight w_geodesic.vdb");
    CHECK(refused.exitCode == kUsage);
    CHECK_THAT(refused.err, contains("would overwrite the input"));
}

TEST_CASE("stdout can be the VDB, the report or the paths, and then holds nothing else") {
    const Sphere desk;
    const std::string base = "--sdf in.vdb --seed 0,0,1 --target 1,0,0 -v ";
    SECTION("VDB") {
        const Result result = desk.run(base + "-o -");
        REQUIRE(result.exitCode == 0);
        CHECK(desk.files().size() == 1);
        const auto piped = readVdbBytes(result.out).get<openvdb::FloatGrid>("psi_geodesic");
        requireDone(desk, base + "-o out.vdb");
        const auto filed = readDistance(desk / "out.vdb");
        CHECK(piped->activeVoxelCount() == filed->activeVoxelCount());
        CHECK(piped->tree().hasSameTopology(filed->tree()));
        CHECK(largestDifference(*piped, *filed) == 0);
        CHECK(readVdbBytes(result.out).metadata["creator"]->str() ==
              readVdb(desk / "out.vdb").metadata["creator"]->str());
    }
    SECTION("report") {
        const Result result = desk.run(base + "-o out.vdb --report -");
        REQUIRE(result.exitCode == 0);
        CHECK(result.out.front() == '{');
        CHECK(result.out.substr(result.out.size() - 2) == "}\n");
    }
    SECTION("paths") {
        requireDone(desk, base + "-o out.vdb --paths out.json");
        const Result result = desk.run(base + "-o out.vdb --paths -");
        REQUIRE(result.exitCode == 0);
        CHECK((contentOf(parseJson(result.out)) == contentOf(readJson(desk / "out.json"))));
    }
}

TEST_CASE("messages: none with -q, one line per result without, the stages with -v") {
    const Sphere desk;
    const std::string base = "--sdf in.vdb --seed 0,0,1 --target 1,0,0 -o out.vdb ";
    CHECK(requireDone(desk, base + "-q").err.empty());

    const auto normal = lines(requireDone(desk, base).err);
    REQUIRE(normal.size() == 3);
    CHECK_THAT(normal[0], startsWith("implicit-geodesic: target 0: distance "));
    CHECK_THAT(normal[1], startsWith("implicit-geodesic: distances up to ") &&
                              contains("on the whole surface"));
    CHECK(normal[2] == "implicit-geodesic: wrote distance to out.vdb");

    const std::string verbose = requireDone(desk, base + "-v").err;
    for (const std::string stage : {"read", "check", "band", "snap", "march", "trace", "write"})
        CHECK_THAT(verbose, contains("\nimplicit-geodesic: " + stage + ": ") ||
                                startsWith("implicit-geodesic: " + stage + ": "));
    for (const std::string& line : lines(verbose))
        CHECK_THAT(line, startsWith("implicit-geodesic: "));
    CHECK_THAT(verbose, contains("half-width 3 voxels") && contains("nodes"));
}

TEST_CASE("stderr that is no terminal gets neither colors nor progress") {
    const TempWorkspace desk;
    desk.make("in.vdb", "torus --voxel-size 0.02");
    const Result result = requireDone(desk, "--sdf in.vdb --seed 1.4,0,0 -o out.vdb");
    CHECK(result.err.find('\033') == std::string::npos);
    CHECK(result.err.find('\r') == std::string::npos);
    CHECK(lines(result.err).size() == 2);
}

TEST_CASE("a target on another piece is reported with exit code 4, all else is written") {
    const TempWorkspace desk;
    desk.make("in.vdb", "two-spheres");
    const Result result = desk.run(
        "--sdf in.vdb --seed 1.2,0,0 --target -1.2,0,0 --target 0.7,0,0.5 -o out.vdb "
        "--paths out.json --report report.json");
    INFO(result.err);
    CHECK(result.exitCode == 4);
    const auto told = lines(result.err);
    REQUIRE(told.size() == 6);
    CHECK_THAT(told[0], startsWith("implicit-geodesic: warning: target 0") &&
                            contains("no path on the surface"));
    CHECK_THAT(told[1], startsWith("implicit-geodesic: target 1: distance "));
    CHECK_THAT(told[2], contains("50 % of the surface is not reached, as no seed is on its "
                                 "components"));
    CHECK(told[3] == "implicit-geodesic: wrote distance to out.vdb");
    CHECK(told[5] == "implicit-geodesic: wrote report to report.json");
    CHECK(desk.files().size() == 4);
    // A quarter of a circle of radius 0.5, within a voxel of 0.05.
    const auto at = told[1].find("distance ");
    CHECK(std::stod(told[1].substr(at + 9)) == Approx(0.25 * M_PI).margin(0.05));
}

TEST_CASE("a target that a limit left out is reported as such") {
    const Sphere desk;
    const Result result = desk.run(
        "--sdf in.vdb --seed 0,0,1 --target 0,0,-1 --max-distance 1 -o out.vdb --paths out.json");
    CHECK(result.exitCode == 4);
    CHECK_THAT(result.err, contains("target 0") && contains("beyond the distance"));
    CHECK(desk.files().size() == 3);
}

TEST_CASE("what lies beyond --max-distance is not said to be cut off") {
    const Sphere desk;  // the pole opposite is pi away
    for (const std::string limit : {"2", "2.9", "3.1"}) {
        INFO(limit);
        const Result near =
            desk.run("--sdf in.vdb --seed 0,0,1 -o out.vdb --max-distance " + limit);
        CHECK_THAT(near.err,
                   contains("around the seeds; --max-distance " + limit + " leaves out the rest"));
        CHECK_THAT(near.err, !contains("not reached"));
    }
    const Result two =
        desk.run("--sdf in.vdb --seed 0,0,1 --seed 1,0,0 -o out.vdb --max-distance 2");
    CHECK_THAT(two.err, contains("--max-distance 2 leaves out the rest"));
    const Result all = desk.run("--sdf in.vdb --seed 0,0,1 -o out.vdb --max-distance 4");
    CHECK_THAT(all.err, contains("on the whole surface"));
}

TEST_CASE("a limit beyond a whole piece is not said to cut off another") {
    const TempWorkspace desk;
    desk.make("in.vdb", "two-spheres");
    const Result result = desk.run("--sdf in.vdb --seed 1.2,0,0 -o out.vdb --max-distance 9");
    CHECK_THAT(result.err, contains("as no seed is on its components"));
}

TEST_CASE("stdin and pipes without an ending are refused where the ending tells the format") {
    const TempWorkspace desk;
    const TempDir elsewhere;
    const std::string pipe = elsewhere / "pipe";
    REQUIRE(std::system(("mkfifo " + pipe).c_str()) == 0);
    for (const std::string option : {"--mesh ", "--points ", "--volume "}) {
        const std::string rest = option == "--volume " ? " --iso 1 --seed 0,0,1" : " --seed 0,0,1";
        requireRefused(desk, option + "-" + rest, kUsage,
                       {option + "-: standard input has no ending", "into a file", "--sdf"});
        requireRefused(desk, option + pipe + rest, kUsage,
                       {"pipe: this pipe has no ending", "into a file"});
    }
    requireRefused(desk, "--sdf " + pipe + " --seed 0,0,1", kUsage,
                   {"this is a pipe", "--sdf - and give"});
}

}  // namespace igeo::test
