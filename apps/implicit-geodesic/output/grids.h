/// The file of distances, with the grids of --grids.
#pragma once

#include <string>

#include "options/run_options.h"

struct RunResult;

/// Refuses grids that the run's other options do not give.
/// @throws igeo::Error  InvalidArgument
void checkGrids(const RunOptions& options);

void writeVolume(RunResult& result, const std::string& file);
