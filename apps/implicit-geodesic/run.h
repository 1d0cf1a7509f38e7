/// The main command: from a surface to distances and geodesics.
#pragma once

#include "console.h"
#include "options/run_options.h"

/// Runs a whole job: reads, solves, writes.
/// @return kDone or kUnreached
/// @throws igeo::Error
int run(const RunOptions& options, const Console& console, ConsoleProgress& progress);
