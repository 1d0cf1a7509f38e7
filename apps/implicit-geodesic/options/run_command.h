/// The main job as a command.
#pragma once

#include "options/command.h"
#include "options/run_options.h"

/// As the program takes it.
Command runCommand(RunOptions& options);
/// As a batch takes it: without options on how the process runs.
Command jobCommand(RunOptions& options);
