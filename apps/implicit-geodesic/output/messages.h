/// What a run says on stderr.
#pragma once

#include <igeo/distance.h>

#include <cstddef>
#include <string>
#include <vector>

#include "console.h"
#include "options/run_options.h"
#include "output/report.h"

/// Whether geodesics are traced: a few always; many only for a result that they are in.
bool showsPaths(const RunOptions& options, std::size_t targets);

/// With -v: the band, the points and the metric.
void describe(const igeo::Distance& distance, const Console& console);

/// Adds a warning for each seed that starts later than another front comes there.
void warnOfOverrunSeeds(const igeo::Distance& distance, RunReport& report);

/// Adds a warning where paths are longer than the distances they belong to, by more than the march
/// errs: then one of the two is wrong.
/// @param dx  voxel size
void warnOfLongPaths(double dx, RunReport& report);

/// Adds a warning for each walk that went over sharp bends as the voxels round them off.
void warnOfRoundedBends(RunReport& report);

/// Adds a warning where the obstacles block nothing of the surface.
/// Adds a warning of targets and pairs that were skipped as they are off the surface: how many, and
/// the first of them.
void warnOfSkippedPoints(const igeo::Distance& distance, RunReport& report);

void warnOfIdleObstacles(const igeo::Distance& distance, RunReport& report);

/// How many components --join-gaps has joined; a warning if none.
void tellJoints(std::size_t joints, double gap, const Console& console,
                std::vector<std::string>& warnings);

/// Warnings, and what became of targets, walks and pairs.
/// @return kDone or kUnreached
int tell(const RunReport& report, const igeo::Distance& distance, const RunOptions& options,
         const Console& console);
