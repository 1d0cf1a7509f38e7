/// Errors with their exit codes.
#pragma once

#include <exception>
#include <string>

struct Failure {
    int exitCode;
    std::string what, remedy;
};

constexpr const char* kThreadRefused = "the system refuses a thread";
constexpr const char* kFewerThreads =
    "use fewer --threads, or raise the limits of the process (ulimit -a)";

/// Whether the system refused a thread: by the text, as TBB throws a std::runtime_error then.
bool isThreadRefused(const std::exception& e);

/// The failure for the exception being handled.
Failure currentFailure();
