/// The subcommand `batch`.
#pragma once

#include <string>

#include "batch/part.h"
#include "options/process_options.h"

struct Command;

struct BatchOptions : ProcessOptions {
    std::string manifest;  ///< file of the jobs
    Part shard;
    std::string summary;  ///< file; empty: named after the manifest
    std::string log;      ///< file; empty: none
    bool dryRun = false;
};

Command batchCommand(BatchOptions& options);
