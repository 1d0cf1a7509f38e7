// The program at work in a folder of its own, as a user at a shell sees it.
#pragma once

#include <support/catch.h>
#include <support/run_program.h>
#include <support/temp_dir.h>

#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace igeo::test {

using nlohmann::json;

/// Exit codes (docs/formats.md).
inline constexpr int kUsage = 2, kUnusable = 3, kUnreached = 4;

/// Words between blanks.
std::vector<std::string> split(const std::string& text);

std::vector<std::string> lines(const std::string& text);

std::string readBytes(const std::string& path);
void writeBytes(const std::string& path, const std::string& bytes);

/// JSON as its grammar has it, without NaN and Infinity; throws at anything else.
json parseJson(const std::string& text);
json readJson(const std::string& path);

/// A temporary folder that a program works in.
class TempWorkspace {
public:
    /// Path of a file in the folder.
    std::string operator/(const std::string& name) const { return folder_ / name; }

    /// Writes a level set; `shape` is a command line of make_shape without -o.
    void make(const std::string& file, const std::string& shape) const;

    /// implicit-geodesic with these words as its arguments.
    Command command(const std::string& line) const;
    Result run(const std::string& line) const { return test::run(command(line)); }

    /// Every file by its name, with its bytes ("-> target" for a link): what no failure may change.
    std::map<std::string, std::string> files() const;

private:
    TempDir folder_;
};

/// With the unit sphere at voxels of 0.1 in in.vdb.
struct Sphere : TempWorkspace {
    Sphere() { make("in.vdb", "sphere --voxel-size 0.1"); }
};

/// The report r.json of a run.
json reportOf(const TempWorkspace& desk);

/// For AddressSanitizer: OpenVDB leaks the tree it was reading when a stream ends early.
void allowLeaks(Command& command);

/// Runs a command that must succeed: exit code 0, and nothing on stdout.
Result requireDone(const TempWorkspace& desk, const std::string& line);

/// A JSON document without its origin and cost: command, inputs, times and memory.
json contentOf(json document);

/// Whether a JSON document holds to one of docs/*.schema.json; true where python3-jsonschema is
/// missing.
bool validBySchema(const TempWorkspace& desk, const std::string& schema,
                   const std::string& document);

/// Runs a command that must be refused, once in the folder as it is and once with outputs out.vdb
/// and out.json in place from before.
///
/// Checks the exit code; that stderr is one line "implicit-geodesic: error: ..." and one with the
/// remedy, that both together hold all of `says` and no name of an exception class; that stdout is
/// empty and no file was made, changed or removed.
void requireRefused(const TempWorkspace& desk, const Command& command, int exitCode,
                    const std::vector<std::string>& says);
void requireRefused(const TempWorkspace& desk, const std::string& line, int exitCode,
                    const std::vector<std::string>& says);

}  // namespace igeo::test

/// How a failed check shows JSON: compiled once.
template <>
struct Catch::StringMaker<nlohmann::json> {
    static std::string convert(const nlohmann::json& document);
};
