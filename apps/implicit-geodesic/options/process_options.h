/// Options of the process, without effect on results.
#pragma once

#include <string>
#include <vector>

struct Command;

enum class ProgressWhen { Auto, Always, Never };

struct ProcessOptions {
    int threads = 0;  ///< 0: all cores
    ProgressWhen progress = ProgressWhen::Auto;
    bool quiet = false, verbose = false;
};

void addProcessOptions(Command& command, ProcessOptions& options);

/// A command line without these options.
std::vector<std::string> withoutProcessOptions(const std::vector<std::string>& words);
