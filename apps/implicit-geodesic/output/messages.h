/// Messages of a run on stderr.
#pragma once

#include <igeo/distance.h>

#include <cstddef>
#include <string>
#include <vector>

#include "console.h"
#include "options/run_options.h"
#include "output/report.h"

/// Whether geodesics are traced: always for a few targets; for many only if a result needs them.
bool showsPaths(const RunOptions& options, std::size_t targets);

/// With -v: prints the band, the points and the metric.
void describe(const igeo::Distance& distance, const Console& console);

/// Adds a warning for each seed that another front reaches before the seed starts.
void warnOfOverrunSeeds(const igeo::Distance& distance, RunReport& report);

/// Adds a warning where the lengths of paths differ from their distances by more than the error of
/// a march: by two voxels, and by 2 %, or 5 % of godunov. Then one of the two is wrong.
void warnOfPathsAgainstDistances(const igeo::Field& field, RunReport& report);
/// Of paths on voxels; on a mesh they have long steps over its triangles.
void warnOfLongSteps(double dx, RunReport& report);

/// Adds a warning for each walk over sharp bends that the voxels round.
void warnOfRoundedBends(RunReport& report);

/// Adds a warning for targets and pairs that were skipped because they are off the surface: their
/// number, and the first few.
void warnOfSkippedPoints(const igeo::Distance& distance, RunReport& report);

/// Adds a warning each for vertices of a mesh, targets and pairs without a distance that triangles
/// join to a seed, or to each other.
void warnOfLostPoints(const igeo::GeodesicSolver& solver, const igeo::Distance& distance,
                      RunReport& report);

/// Adds a warning where the obstacles block nothing of the surface.
void warnOfIdleObstacles(const igeo::Band& band, const igeo::Metric& metric, RunReport& report);

/// Prints the number of components joined by --join-gaps; adds a warning if there are none.
void tellJoints(std::size_t joints, double gap, const Console& console,
                std::vector<std::string>& warnings);

/// Prints warnings, and the outcomes of targets, walks and pairs.
/// @return kDone or kUnreached
int tell(const RunReport& report, const igeo::Distance& distance, const RunOptions& options,
         const Console& console);
