// Ctrl-C, kill, and a reader of stdout that goes away.
#include <support/catch.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <filesystem>

#include "program.h"

namespace igeo::test {

namespace {

/// A torus with enough voxels for a run of seconds, and how long that run takes here.
struct LongRun : TempWorkspace {
    LongRun() {
        make("in.vdb", "torus --voxel-size 0.005");
        const Result whole = run(kLine);
        REQUIRE(whole.exitCode == 0);
        finished = files();
        clearAfter(whole);
    }
    /// Removes what a whole run wrote, and takes its time for that of the next.
    void clearAfter(const Result& whole) {
        for (const char* name : {"out.vdb", "out.obj"}) std::filesystem::remove(*this / name);
        seconds = whole.seconds;
        // What a run that does nothing takes says how busy the machine is: 0.02 s on an idle one.
        startSeconds = run("--version").seconds;
    }
    static constexpr const char* kLine =
        "--sdf in.vdb --seed 1.4,0,0 --target -1.4,0,0 -o out.vdb --paths out.obj -q";
    double seconds = 0, startSeconds = 0;
    std::map<std::string, std::string> finished;  ///< all files after a whole run
};

}  // namespace

TEST_CASE("Ctrl-C and kill end a run at once and leave nothing behind") {
    const int signal = GENERATE(SIGINT, SIGTERM);
    LongRun desk;
    constexpr std::array kParts{0.1, 0.25, 0.4, 0.55, 0.7, 0.85, 0.95};
    std::size_t interrupted = 0;
    // Once, and on a busy machine up to three times more, until enough were in time.
    for (std::size_t k = 0; k < kParts.size() || (k < 4 * kParts.size() && interrupted < 3); ++k) {
        const double part = kParts[k % kParts.size()];
        Command command = desk.command(LongRun::kLine);
        command.signal = signal;
        command.signalDelay = std::max(part * desk.seconds, 5 * desk.startSeconds);
        const Result result = run(command);
        INFO("signal " << signal << " after " << command.signalDelay << " s of " << desk.seconds
                       << ", ended " << result.secondsAfterSignal << " s later\n"
                       << result.err);
        // The run may be done before the signal arrives: near its end, or on a machine whose load
        // fell.
        if (result.exitCode == 0) {
            desk.clearAfter(result);
            continue;
        }
        ++interrupted;
        CHECK(result.signal == 0);
        CHECK(result.exitCode == 128 + signal);
        // 0.2 s, and what starting and scheduling cost on a machine that does other things as well.
        CHECK(result.secondsAfterSignal < 0.2 + std::max(0.2, 5 * desk.startSeconds));
        CHECK(result.out.empty());
        const auto told = lines(result.err);
        REQUIRE(!told.empty());
        const std::size_t written = desk.files().size() - 1;
        CHECK_THAT(told.front(), startsWith(std::string("implicit-geodesic: error: interrupted; ") +
                                            (written == 0   ? "nothing was written"
                                             : written == 1 ? "1 file was written before"
                                                            : "2 files were written before")));
        CHECK(told.size() <= 2);
        // No temporaries; an output that was complete before the signal may stay, but only whole.
        for (const auto& [name, bytes] : desk.files()) {
            INFO("file " << name);
            REQUIRE(desk.finished.count(name) == 1);
            CHECK((bytes == desk.finished.at(name)));
            if (name != "in.vdb") std::filesystem::remove(desk / name);
        }
    }
    CHECK(interrupted >= 3);
}

TEST_CASE("an interrupted run keeps the output of an earlier one") {
    const LongRun desk;
    // On a machine whose load falls a run may be done before the signal arrives: then earlier.
    for (const double part : {0.5, 0.3, 0.15, 0.1}) {
        writeBytes(desk / "out.vdb", "written by an earlier run");
        Command command = desk.command(LongRun::kLine);
        command.signal = SIGINT;
        command.signalDelay = part * desk.seconds;
        const Result result = run(command);
        if (result.exitCode == 0) {
            std::filesystem::remove(desk / "out.obj");
            continue;
        }
        CHECK(result.exitCode == 130);
        const bool kept = readBytes(desk / "out.vdb") == "written by an earlier run";
        CHECK(kept);
        CHECK(desk.files().size() == 2);
        return;
    }
    FAIL("no signal arrived in time");
}

TEST_CASE("a reader of stdout that has gone ends the program quietly") {
    const TempWorkspace desk;
    desk.make("in.vdb", "sphere");
    const std::string output = GENERATE("-o -", "-o out.vdb --report -");
    Command command = desk.command("");
    command.program = "sh";
    command.args = {"-c", "{ \"$@\"; echo $? >code; } | true", "sh", IGEO_PROGRAM};
    for (const auto& word : split("--sdf in.vdb --seed 0,0,1 -q " + output))
        command.args.push_back(word);
    const Result result = run(command);
    INFO(result.err);
    CHECK(readBytes(desk / "code") == "3\n");
    CHECK(result.err.empty());
}

}  // namespace igeo::test
