/// What a run has when it writes.
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

/// All that results are made of. What several are made of is made once, by the first that asks.
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
    /// As the march left it: to be read at points, and for what it was made with.
    std::shared_ptr<const igeo::Field> marched() const { return distance.marched(); }
    const igeo::SurfaceMesh& mesh();
    const std::vector<igeo::Isoline>& isolines();
    /// The surface as a level set, with warnings for the report.
    const igeo::LevelSet& levelSet();
    /// All paths for what is drawn, index space: the vertices alone.
    std::vector<igeo::Path> drawnLines() const;
};
