/// Checks of the results that a run is to write, before anything is read. By the table of results.
#pragma once

#include <string>
#include <vector>

#include "options/run_options.h"

namespace igeo {
struct Seeds;
}

/// Refuses results that the run's other options cannot give, and options without effect on any
/// result.
/// @throws igeo::Error  InvalidArgument
void checkResults(const RunOptions& options);
void refuseWithoutEffect(const RunOptions& options);

/// Refuses results that are not available for groups of seeds, once the seeds are read.
/// @throws igeo::Error  InvalidArgument
void checkSeeds(const RunOptions& options, const igeo::Seeds& seeds);

struct WithoutEffect {
    std::string option, users;  ///< --straighten; the options with which it has an effect
    /// @throws igeo::Error  InvalidArgument
    [[noreturn]] void refuse() const;
};
std::vector<WithoutEffect> optionsWithoutEffect(const RunOptions& options);

/// Refuses files that cannot be read or written, before any is read.
/// @throws igeo::Error  InvalidArgument
void checkFiles(const RunOptions& options);
/// Refuses the file that a grid from standard input gives its name, once the grid is read.
/// @throws igeo::Error  InvalidArgument
void checkFileOfGrid(const RunOptions& options, const std::string& grid);
/// Files that a run writes, as far as the options determine them; - is standard output.
std::vector<std::string> outputFiles(const RunOptions& options);
