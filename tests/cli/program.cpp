#include "program.h"

#include <fstream>
#include <iterator>
#include <regex>
#include <sstream>

namespace igeo::test {

namespace fs = std::filesystem;

std::vector<std::string> split(const std::string& text) {
    std::istringstream in(text);
    return {std::istream_iterator<std::string>(in), {}};
}

std::vector<std::string> lines(const std::string& text) {
    std::istringstream in(text);
    std::vector<std::string> out;
    for (std::string line; std::getline(in, line);) out.push_back(line);
    return out;
}

std::string readBytes(const std::string& path) {
    std::ifstream in(path, std::ios::binary);
    if (!in) throw std::runtime_error("cannot read " + path);
    return {std::istreambuf_iterator<char>(in), {}};
}

void writeBytes(const std::string& path, const std::string& bytes) {
    std::ofstream out(path, std::ios::binary);
    out << bytes;
    if (!out.flush()) throw std::runtime_error("cannot write " + path);
}

json parseJson(const std::string& text) { return json::parse(text); }

json readJson(const std::string& path) { return parseJson(readBytes(path)); }

void TempWorkspace::make(const std::string& file, const std::string& shape) const {
    Command command;
    command.program = IGEO_MAKE_SHAPE;
    command.args = split(shape + " -o " + file);
    command.workingDirectory = folder_.path().string();
    const Result made = test::run(command);
    INFO(shape << "\n" << made.err);
    REQUIRE(made.exitCode == 0);
}

Command TempWorkspace::command(const std::string& line) const {
    Command command;
    command.program = IGEO_PROGRAM;
    command.args = split(line);
    command.workingDirectory = folder_.path().string();
    return command;
}

std::map<std::string, std::string> TempWorkspace::files() const {
    std::map<std::string, std::string> all;
    for (const auto& entry : fs::recursive_directory_iterator(folder_.path())) {
        const std::string name = entry.path().lexically_relative(folder_.path()).string();
        if (entry.is_symlink())
            all[name] = "-> " + fs::read_symlink(entry.path()).string();
        else
            all[name] = entry.is_regular_file() ? readBytes(entry.path().string()) : "(no file)";
    }
    return all;
}

json reportOf(const TempWorkspace& desk) { return readJson(desk / "r.json"); }

void allowLeaks(Command& command) { command.environment["ASAN_OPTIONS"] = "detect_leaks=0"; }

Result requireDone(const TempWorkspace& desk, const std::string& line) {
    Result result = desk.run(line);
    INFO(line << "\n" << result.err);
    CHECK(result.out.empty());
    REQUIRE(result.exitCode == 0);
    return result;
}

namespace {

void requireUnchanged(const TempWorkspace& desk, const std::map<std::string, std::string>& before) {
    const auto after = desk.files();
    for (const auto& [name, bytes] : after) {
        INFO("file " << name);
        REQUIRE(before.count(name) == 1);
        REQUIRE((before.at(name) == bytes));  // in brackets: no megabytes in the message
    }
    REQUIRE(after.size() == before.size());
}

void requireRefusedOnce(const TempWorkspace& desk, const Command& command, int exitCode,
                        const std::vector<std::string>& says) {
    const auto before = desk.files();
    const Result result = run(command);
    std::string line;
    for (const std::string& arg : command.args) line += " " + arg;
    INFO("arguments:" << line << "\nstderr:\n" << result.err.substr(0, 2000));
    REQUIRE(result.err.size() < 2000);  // garbage read from a file must not end up here
    CHECK_FALSE(result.timedOut);
    CHECK(result.signal == 0);
    REQUIRE(result.exitCode == exitCode);
    CHECK(result.out.empty());

    const auto told = lines(result.err);
    REQUIRE(told.size() == 2);
    CHECK(told[0].rfind("implicit-geodesic: error: ", 0) == 0);
    CHECK(told[1].rfind("  ", 0) == 0);
    CHECK(told[1].size() > 10);
    static const std::regex className(
        "[A-Z][A-Za-z]*Error|[Ee]xception|std::|openvdb::|basic_|terminate|json\\.");
    CHECK_FALSE(std::regex_search(result.err, className));
    for (const std::string& part : says) CHECK_THAT(result.err, contains(part));
    requireUnchanged(desk, before);
}

}  // namespace

void requireRefused(const TempWorkspace& desk, const Command& command, int exitCode,
                    const std::vector<std::string>& says) {
    requireRefusedOnce(desk, command, exitCode, says);
    std::vector<std::string> placed;
    for (const std::string& name : {desk / "out.vdb", desk / "out.json"}) {
        if (fs::exists(fs::symlink_status(name))) continue;
        writeBytes(name, "written by an earlier run");
        placed.push_back(name);
    }
    requireRefusedOnce(desk, command, exitCode, says);
    for (const std::string& name : placed) fs::remove(name);
}

void requireRefused(const TempWorkspace& desk, const std::string& line, int exitCode,
                    const std::vector<std::string>& says) {
    requireRefused(desk, desk.command(line), exitCode, says);
}

json contentOf(json document) {
    for (const char* member : {"command", "inputs", "seconds", "peakMemoryBytes"})
        CHECK(document.erase(member) == 1);
    return document;
}

bool validBySchema(const TempWorkspace& desk, const std::string& schema,
                   const std::string& document) {
    Command command;
    command.program = "/usr/bin/python3";
    command.args = {IGEO_SOURCE_DIR "/tests/cli/validate_json.py",
                    IGEO_SOURCE_DIR "/docs/" + schema, desk / document};
    const Result result = run(command);
    INFO(result.out << result.err);
    if (result.exitCode != 77 && result.exitCode != 127) return result.exitCode == 0;
    markSkipped("a document was not compared with its schema, as python3-jsonschema is missing");
    return true;
}

}  // namespace igeo::test

std::string Catch::StringMaker<nlohmann::json>::convert(const nlohmann::json& document) {
    return document.dump();
}
