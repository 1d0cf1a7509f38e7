/// Errors with their exit codes.
#pragma once

#include <exception>
#include <string>

struct Failure {
    int exitCode;
    std::string what, remedy;
};

/// Whether the system grants no further thread: TBB has no type of its own for that.
bool isThreadRefused(const std::exception& e);

/// The failure for the exception being handled.
Failure currentFailure();
