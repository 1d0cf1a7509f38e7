/// Messages of a run on stderr.
#pragma once

#include <igeo/distance.h>

#include <cstddef>
#include <string>
#include <vector>

#include "console.h"
#include "input/seed_input.h"
#include "options/run_options.h"
#include "output/report.h"

/// Whether geodesics are traced: always for a few targets; for many only if a result needs them.
bool showsPaths(const RunOptions& options, std::size_t targets);

/// With -v: prints the band, the points and the metric.
void describe(const igeo::Distance& distance, const Console& console);

/// Adds warnings of all that may be wrong with results: those of igeo/warnings.h, obstacles that
/// block nothing, parts of seed masks that give no seed, and targets and pairs that were skipped,
/// as they are off the surface. Fills RunReport::unresolved.
void warnOfResults(const igeo::GeodesicSolver& solver, const SeedInput& seeds,
                   const igeo::Distance& distance, RunReport& report, igeo::Progress& progress);

/// Prints warnings, and the outcomes of targets, walks and pairs.
/// @return kDone or kUnreached
int tell(const RunReport& report, const igeo::Distance& distance, const RunOptions& options,
         const Console& console);
