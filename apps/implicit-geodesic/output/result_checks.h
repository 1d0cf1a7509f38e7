/// What is refused of the results of a run, before anything is read. By the table of results.
#pragma once

#include <igeo/geodesic_solver.h>

#include <string>
#include <vector>

#include "options/run_options.h"

/// Refuses results that the run's other options do not give, and options without effect on any.
/// @throws igeo::Error  InvalidArgument
void checkResults(const RunOptions& options);
void refuseWithoutEffect(const RunOptions& options);

/// Refuses results that groups of seeds do not give, once the seeds are read.
/// @throws igeo::Error  InvalidArgument
void checkSeeds(const RunOptions& options, const igeo::Seeds& seeds);

struct WithoutEffect {
    std::string option, users;  ///< --straighten; what would make it matter
    /// @throws igeo::Error  InvalidArgument
    [[noreturn]] void refuse() const;
};
std::vector<WithoutEffect> optionsWithoutEffect(const RunOptions& options);

/// Refuses files that cannot be read or written, before any is read.
/// @throws igeo::Error  InvalidArgument
void checkFiles(const RunOptions& options);
/// Files that a run writes, as far as the options say; - is standard output.
std::vector<std::string> outputFiles(const RunOptions& options);
