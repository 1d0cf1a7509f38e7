/// The main command.
#pragma once

#include "options/command.h"
#include "options/run_options.h"

/// For the program.
Command runCommand(RunOptions& options);
/// For jobs of a batch: without options of the process.
Command jobCommand(RunOptions& options);
