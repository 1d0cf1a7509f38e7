/// What went wrong, as it is reported.
#pragma once

#include <string>

struct Failure {
    int exitCode;
    std::string what, remedy;
};

/// Of the exception that is being handled.
Failure currentFailure();
