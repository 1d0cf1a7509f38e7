/// What a file holds, whether it is usable as a surface, and what a run on it would cost.
#pragma once

#include "console.h"
#include "options/info_options.h"

/// Prints a survey of a file on stdout, for people or as JSON, and writes the places where
/// results are unreliable if they are asked for.
/// @return kDone; kUnusable where the file cannot be used, which the survey says
/// @throws igeo::Error  for options, and where --unreliable cannot be written
int info(const InfoOptions& options, Console& console, ConsoleProgress& progress);
