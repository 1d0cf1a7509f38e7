/// The paths of a run as files hold them.
#pragma once

#include <igeo/geodesic_solver.h>
#include <igeo/results/curve_files.h>

#include <vector>

#include "options/result_options.h"
#include "output/report.h"

/// The report with paths as --path-step and --path-offset ask for.
/// @throws igeo::Error  as GeodesicSolver::resampled
RunReport withPathsAsAsked(const RunReport& report, const igeo::GeodesicSolver& solver,
                           const ResultOptions& options);

/// All of them, those without vertices as well: target_0, walk_0, pair_0, via_0 and so on, numbered
/// from 0 through all.
std::vector<igeo::NamedCurve> pathCurves(const RunReport& report);
