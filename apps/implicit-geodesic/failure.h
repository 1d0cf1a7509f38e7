/// Errors with their exit codes.
#pragma once

#include <string>

struct Failure {
    int exitCode;
    std::string what, remedy;
};

/// The failure for the exception being handled.
Failure currentFailure();
