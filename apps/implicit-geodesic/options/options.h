/// What the program is asked to do. Every command has a struct of its own, and a file that declares
/// its options.
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

/// @return nothing where help or version was asked for and is printed
/// @throws igeo::Error  InvalidArgument for whatever can be refused before any file is read
std::optional<Options> parseOptions(int argc, char** argv);

/// The options of a run from its arguments, as jobs of a batch have them: without those on how the
/// process runs (--threads, --progress, -q, -v).
/// @throws igeo::Error  as parseOptions
RunOptions parseJob(const std::vector<std::string>& arguments);
