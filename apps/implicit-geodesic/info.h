/// The survey of a file: its content, whether it is usable as a surface, and the cost of a run on
/// it.
#pragma once

#include "console.h"
#include "options/info_options.h"

/// Prints a survey of a file on stdout, as text or as JSON, and writes the places where results are
/// unreliable if requested.
/// @return kDone; kUnusable where the file cannot be used, with the reason in the survey
/// @throws igeo::Error  for options, and where --unreliable cannot be written
int info(const InfoOptions& options, Console& console, ConsoleProgress& progress);
