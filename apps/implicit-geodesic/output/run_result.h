/// The data of a run when it writes its results.
#pragma once

#include <igeo/base/progress.h>
#include <igeo/distance.h>
#include <igeo/geodesic_solver.h>
#include <igeo/results/isolines.h>

#include <optional>
#include <vector>

#include "input/seed_input.h"
#include "options/run_options.h"
#include "output/report.h"

/// The data that results are made from. Derived data is made once, on first use.
struct RunResult {
    const RunOptions& options;
    const SeedInput& input;
    const igeo::GeodesicSolver& solver;
    const igeo::Distance& distance;
    RunReport& report;
    igeo::Progress& progress;
    bool lastRun = false;  ///< no other run needs the surface

    std::optional<igeo::SurfaceMesh> madeMesh = {};
    std::optional<std::vector<igeo::Isoline>> madeIsolines = {};

    const igeo::Band& band() const { return distance.band(); }
    /// The field as the march left it: to read at points, with its seeds, scheme and metric.
    std::shared_ptr<const igeo::Field> marched() const { return distance.marched(); }
    const igeo::SurfaceMesh& mesh();
    const std::vector<igeo::Isoline>& isolines();
    /// The surface as a level set; its warnings are added to the report.
    const igeo::LevelSet& levelSet();
    /// All paths for pictures, index space: only the vertices.
    std::vector<igeo::Path> drawnLines() const;
};
