// Runs a program as a shell does, without one.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace igeo::test {

struct Command {
    std::string program;  ///< path, or a name to look up in PATH
    std::vector<std::string> args;
    std::string stdinBytes;        ///< written to the program's standard input through a pipe
    std::string stdinFile;         ///< if set, the standard input instead of `stdinBytes`
    std::string stdoutFile;        ///< if set, receives stdout (/dev/full: every write fails)
    std::string workingDirectory;  ///< empty: the caller's
    std::map<std::string, std::string> environment;  ///< set on top of the caller's
    /// Writing a file beyond this size fails with EFBIG, as on a full disk (SIGXFSZ is ignored).
    std::optional<std::uint64_t> fileSizeLimit;
    int signal = 0;  ///< sent once `signalDelay` seconds after the start
    double signalDelay = 0;
    double timeout = 120;  ///< seconds until the program is killed
};

struct Result {
    int exitCode = -1;      ///< -1 if a signal ended the program, 127 if it could not be started
    int signal = 0;         ///< the signal that ended the program, 0 if none
    bool timedOut = false;  ///< killed after Command::timeout
    std::string out;        ///< everything written to stdout
    std::string err;        ///< everything written to stderr
    double seconds = 0;     ///< from start to end, wall clock
    double secondsAfterSignal = 0;  ///< from sending Command::signal to the end
};

/// Runs the command to its end.
/// @throws std::system_error if a pipe or the process cannot be made
Result run(const Command& command);

}  // namespace igeo::test
