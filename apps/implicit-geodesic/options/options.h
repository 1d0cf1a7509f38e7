/// The options of the program. Every command has its own struct, and a file that declares its
/// options.
#pragma once

#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "options/batch_options.h"
#include "options/info_options.h"
#include "options/merge_options.h"
#include "options/run_options.h"

using Options = std::variant<RunOptions, InfoOptions, BatchOptions, MergeOptions>;

/// @return empty after printing help or version
/// @throws igeo::Error  InvalidArgument for whatever can be refused before any file is read
std::optional<Options> parseOptions(int argc, char** argv);

/// The options of a run from its arguments, as in jobs of a batch: without those of the process
/// (--threads, --progress, -q, -v).
/// @throws igeo::Error  as parseOptions
RunOptions parseJob(const std::vector<std::string>& arguments);
