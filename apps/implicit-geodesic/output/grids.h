/// The file of distances, with the grids of --grids.
#pragma once

#include <string>

struct RunResult;

void writeVolume(RunResult& result, const std::string& file);
