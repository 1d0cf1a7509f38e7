/// The paths of a run, as written to files.
#pragma once

#include <igeo/geodesic_solver.h>
#include <igeo/results/curve_files.h>

#include <vector>

#include "options/result_options.h"
#include "output/report.h"

/// The report with its paths changed by --path-step and --path-offset.
/// @throws igeo::Error  as GeodesicSolver::resampled
RunReport withPathsAsAsked(const RunReport& report, const igeo::GeodesicSolver& solver,
                           const ResultOptions& options);

/// All paths, including those without vertices: target_0, walk_0, pair_0, via_0 and so on, numbered
/// consecutively from 0.
std::vector<igeo::NamedCurve> pathCurves(const RunReport& report);
