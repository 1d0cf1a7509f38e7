/// The file of distances, with the grids of --grids.
#pragma once

#include <string>

#include "options/run_options.h"

struct RunResult;

/// Refuses a --name that gives two grids of the output the same name.
/// @param surface  name of the surface's grid
/// @throws igeo::Error  InvalidArgument
void checkGridNames(const RunOptions& options, const std::string& surface);

void writeVolume(RunResult& result, const std::string& file);
