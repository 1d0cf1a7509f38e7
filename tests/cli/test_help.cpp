// Help and version, and that the examples in the help do what they say.
#include <support/catch.h>

#include <filesystem>

#include "program.h"

namespace igeo::test {
namespace fs = std::filesystem;

namespace {

/// Command lines under "Examples:".
std::vector<std::string> examples(const std::string& help) {
    std::vector<std::string> found;
    for (const std::string& line : lines(help.substr(help.find("\nExamples:"))))
        if (line.rfind("  implicit-geodesic ", 0) == 0) found.push_back(line.substr(20));
    return found;
}

/// Options begin a line, indented by two.
std::size_t optionCount(const std::string& help) {
    const std::vector<std::string> all = lines(help);
    return std::size_t(std::count_if(
        all.begin(), all.end(), [](const std::string& line) { return line.starts_with("  -"); }));
}

}  // namespace

TEST_CASE("help and version go to stdout, in the spelling of any tool") {
    const TempWorkspace desk;
    const Result help = desk.run("--help"), version = desk.run("--version");
    CHECK(help.exitCode == 0);
    CHECK(help.err.empty());
    CHECK(version.exitCode == 0);
    CHECK(version.err.empty());
    const std::vector<std::string> versions = lines(version.out);
    REQUIRE(versions.size() == 6);
    CHECK_THAT(versions[0], matches("implicit-geodesic [0-9]+\\.[0-9]+\\.[0-9]+"));
    CHECK_THAT(versions[1], matches("commit .+"));
    CHECK_THAT(versions[2], matches("OpenVDB [0-9.]+, file format [0-9]+"));
    CHECK_THAT(versions[3], matches("TBB [0-9.]+"));
    CHECK_THAT(versions[4], matches("compiler .+ [0-9.]+, .+"));
    CHECK_THAT(versions[5], matches("(no )?three\\.js.*"));
    CHECK(desk.run("-V").out == version.out);
    const std::vector<std::string> brief = lines(desk.run("-h").out);
    CHECK(brief.size() <= 32);  // a screen
    CHECK(brief.back() ==
          "All " + std::to_string(optionCount(help.out)) + " options: implicit-geodesic --help");
    for (const std::string& line : brief) CHECK(line.size() <= 80);
    CHECK(desk.run("-help").out == help.out);
    CHECK(desk.run("-version").out == version.out);
    CHECK(desk.run("--sdf missing.vdb --help").out == help.out);
    CHECK(desk.files().empty());
}

TEST_CASE("every option that takes a length says its unit, and the help ends with examples") {
    const TempWorkspace desk;
    const std::string help = desk.run("--help").out;
    for (const std::string option : {"--band ", "--snap ", "--max-distance "}) {
        const auto at = help.find("  " + option);
        REQUIRE(at != std::string::npos);
        std::string text;
        for (const std::string& word : split(help.substr(at, help.find("\n  --", at + 1) - at)))
            text += word + " ";
        CHECK_THAT(text, contains("world units"));
    }
    CHECK(examples(help).size() >= 2);
    const auto all = lines(help);
    CHECK(all.back().rfind("      ", 0) == 0);  // what the last example does
}

TEST_CASE("the examples of the help run as they are") {
    const TempWorkspace desk;
    fs::copy(IGEO_SOURCE_DIR "/data", desk / "data", fs::copy_options::recursive);
    const auto inputs = desk.files().size();
    const auto commands = examples(desk.run("--help").out);
    REQUIRE(commands.size() == 3);
    for (const std::string& line : commands) {
        const Result result = desk.run(line);
        INFO(line << "\n" << result.err);
        CHECK(result.exitCode == 0);
        CHECK_FALSE(result.err.empty());
    }
    CHECK(desk.files().size() == inputs + 3);
    for (const char* name : {"trefoil_geodesic.vdb", "path.json", "near.vdb"})
        CHECK(fs::exists(desk / name));
}

}  // namespace igeo::test
