// Files of OpenVDB versions newer than the one in use.
#include <support/catch.h>

#include "program.h"
#include "vdb_files.h"

namespace igeo::test {

namespace {

/// What OpenVDB 13 writes into the header of the same data.
std::string asFormat225(std::string bytes) {
    constexpr std::size_t kFormat = 8, kLibrary = 12;
    bytes[kFormat] = char(225);
    bytes[kLibrary] = 13;
    return bytes;
}

std::string replaceLast(std::string text, const std::string& from, const std::string& to) {
    REQUIRE(from.size() == to.size());
    const auto at = text.rfind(from);
    REQUIRE(at != std::string::npos);
    return text.replace(at, from.size(), to);
}

constexpr const char* kNewer = "written by a newer OpenVDB, 13.";

/// A JSON document but for its input and the warning of it; anything else as it is.
std::string withoutInput(const std::string& bytes) {
    if (!bytes.starts_with('{')) return bytes;
    json document = contentOf(parseJson(bytes));
    document.erase("warnings");
    return document.dump();
}

}  // namespace

TEST_CASE("stdout holds the result alone, also for a file of a newer OpenVDB") {
    const TempWorkspace desk;
    desk.make("in.vdb", "sphere --voxel-size 0.1");
    const std::string given = readBytes(desk / "in.vdb");
    const std::string run = "--sdf in.vdb --seed 0,0,1 --target 1,0,0 -o ";
    const std::string result =
        GENERATE("-", "out.vdb --paths -", "out.vdb --matrix -", "out.vdb --isolines - --levels 3",
                 "out.vdb --mesh-out -", "out.vdb --image - --image-size 64x48");
    INFO(result);
    const Result before = desk.run(run + result);
    REQUIRE(before.exitCode == 0);
    REQUIRE(!before.out.empty());
    CHECK(before.err.find("newer OpenVDB") == std::string::npos);
    writeBytes(desk / "in.vdb", asFormat225(given));
    const Result after = desk.run(run + result);
    CHECK(after.exitCode == 0);
    CHECK((withoutInput(after.out) == withoutInput(before.out)));
    CHECK_THAT(after.err, contains(kNewer));
    CHECK(after.err.find("WARN") == std::string::npos);
}

TEST_CASE("reports say that a file is of a newer OpenVDB") {
    const TempWorkspace desk;
    desk.make("in.vdb", "sphere --voxel-size 0.1");
    writeBytes(desk / "in.vdb", asFormat225(readBytes(desk / "in.vdb")));
    SECTION("of a surface, a weight and an obstacle") {
        for (const std::string file : {"in.vdb", "weight.vdb", "wall.vdb"})
            writeBytes(desk / file, readBytes(desk / "in.vdb"));
        desk.make("sound.vdb", "sphere --voxel-size 0.1");
        const Result run = desk.run(
            "--sdf sound.vdb --seed 0,0,1 -o out.vdb --obstacle wall.vdb --report - --snap 9");
        CHECK_THAT(run.err, contains("'wall.vdb' was " + std::string(kNewer)));
    }
    SECTION("of a run") {
        const Result run = desk.run("--sdf in.vdb --seed 0,0,1 -o out.vdb --report -");
        CHECK(run.exitCode == 0);
        const json warnings = parseJson(run.out)["warnings"];
        REQUIRE(warnings.size() == 1);
        CHECK_THAT(warnings[0].get<std::string>(), contains(kNewer));
    }
    SECTION("of info") {
        const json report = parseJson(desk.run("info in.vdb --json").out);
        CHECK_THAT(report["warnings"].dump(), contains(kNewer));
        const Result text = desk.run("info in.vdb");
        CHECK_THAT(text.out, contains(kNewer));
        CHECK_THAT(text.out, startsWith("file"));
    }
}

TEST_CASE("a grid of an unknown type is listed, and the others are read") {
    const TempWorkspace desk;
    desk.make("two.vdb", "bad two-level-sets");
    desk.make("one.vdb", "sphere --voxel-size 0.1");
    const std::string run = " --seed 1,0,0 -o out.vdb";
    requireDone(desk, "--sdf two.vdb:psi_a" + run);
    const auto expected = readDistance(desk / "out.vdb", "psi_a_geodesic");
    const std::string known = "Tree_float_5_4_3", unknown = "Tree_fluid_5_4_3";
    for (const std::string file : {"one.vdb", "two.vdb"})
        writeBytes(desk / file, replaceLast(readBytes(desk / file), known, unknown));

    // The other is the only level set that is left.
    for (const std::string source : {"two.vdb:psi_a", "two.vdb"}) {
        requireDone(desk, "--sdf " + source + run);
        CHECK(largestDifference(*readDistance(desk / "out.vdb", "psi_a_geodesic"), *expected) == 0);
    }
    CHECK_THAT(desk.run("info two.vdb:psi_a").out,
               contains("psi_b: unknown type " + unknown + ", unknown; not usable here"));
    for (const std::string source : {"two.vdb:psi_b", "one.vdb"}) {
        const Result refused = desk.run("--sdf " + source + run);
        CHECK(refused.exitCode == 3);
        CHECK_THAT(refused.err, contains(unknown));
        CHECK_THAT(refused.err, contains("float"));
    }
    // A stream has no directory to skip a grid by.
    Command piped = desk.command("--sdf - --seed 1,0,0");
    piped.stdinFile = desk / "two.vdb";
    const Result refused = igeo::test::run(piped);
    CHECK(refused.exitCode == 3);
    CHECK_THAT(refused.err, contains(unknown));
}

}  // namespace igeo::test
