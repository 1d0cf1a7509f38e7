/// The subcommand `batch merge`.
#pragma once

#include <string>
#include <vector>

struct Command;

struct MergeOptions {
    std::vector<std::string> parts;  ///< files
    std::string output = "-";
    bool matrix = false;  ///< of parts of a matrix, not of summaries
};

Command mergeCommand(MergeOptions& options);
