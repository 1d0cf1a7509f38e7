/// How the process runs.
#pragma once

struct Command;

enum class ProgressWhen { Auto, Always, Never };

struct ProcessOptions {
    int threads = 0;  ///< 0: all cores
    ProgressWhen progress = ProgressWhen::Auto;
    bool quiet = false, verbose = false;
};

void addProcessOptions(Command& command, ProcessOptions& options);
