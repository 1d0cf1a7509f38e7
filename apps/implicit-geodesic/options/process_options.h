/// How the process runs.
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

/// The words of a command line without those of these options, which change no result.
std::vector<std::string> withoutProcessOptions(const std::vector<std::string>& words);
