/// The job: from a level set to distances and geodesics.
#pragma once

#include "console.h"
#include "options.h"

enum ExitCode { kDone = 0, kFailed = 1, kUsage = 2, kUnusable = 3, kUnreached = 4 };

/// Walks the street: read, check, band, seeds, march, trace, write.
/// @return kDone or kUnreached
/// @throws igeo::Error
int run(const Options& options, Console& console, ConsoleProgress& progress);
