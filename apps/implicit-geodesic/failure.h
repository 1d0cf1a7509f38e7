/// Errors with their exit codes.
#pragma once

#include <exception>
#include <string>

struct Failure {
    int exitCode;
    std::string what, remedy;
};

/// Whether the system refused a thread: by the text, as TBB throws a std::runtime_error then.
bool isThreadRefused(const std::exception& e);

/// The failure for the exception being handled.
Failure currentFailure();
