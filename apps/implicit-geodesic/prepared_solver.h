/// The steps of the main command: solvers that jobs share, and a job on one of them.
#pragma once

#include <igeo/geodesic_solver.h>

#include <map>
#include <string>
#include <vector>

#include "console.h"
#include "input/metric_input.h"
#include "json_file.h"
#include "options/run_options.h"
#include "stages.h"

/// A surface with a metric, set up once for all jobs that agree in both.
struct PreparedSolver {
    igeo::GeodesicSolver solver;
    MetricInput metric;    ///< its names and warnings
    bool lastRun = false;  ///< no other run needs the surface
};

using FileDigests = std::map<std::string, std::string>;  ///< by name

/// Scheme and band, without the metric.
igeo::SolverOptions solverOptions(const RunOptions& options);

/// Reads the metric, and sets up the solver.
PreparedSolver prepareSolver(const igeo::Surface& surface, const RunOptions& options,
                             igeo::Progress& progress);

struct RunOutcome {
    int exitCode = 0;  ///< kDone or kUnreached
    std::vector<std::string> warnings;
    Json provenance;  ///< provenanceJson
};

/// `run` from the seeds on, with a solver for the job's surface, band and metric. Jobs may share
/// the solver and run side by side; each writes what `run` would.
/// @param digests  known digests of input files
RunOutcome runOn(const PreparedSolver& prepared, const RunOptions& options, const Console& console,
                 Stages& stages, const FileDigests& digests = {});
