/// The table of results: for each its option, the endings of its file, what it needs, and how it is
/// written.
#pragma once

#include <igeo/base/progress.h>
#include <igeo/distance.h>
#include <igeo/geodesic_solver.h>
#include <igeo/results/isolines.h>

#include <optional>
#include <string>
#include <vector>

#include "options/run_options.h"
#include "output/report.h"

/// All that results are made of. What several are made of is made once, by the first that asks.
struct RunResult {
    const RunOptions& options;
    const igeo::GeodesicSolver& solver;
    const igeo::Distance& distance;
    RunReport& report;
    igeo::Progress& progress;

    std::optional<igeo::SurfaceMesh> madeMesh = {};
    std::optional<std::vector<igeo::Isoline>> madeIsolines = {};

    const igeo::Band& band() const { return distance.band(); }
    const igeo::Field& field() const { return distance.field(); }
    const igeo::SurfaceMesh& mesh();
    const std::vector<igeo::Isoline>& isolines();
    /// The surface as a level set, with warnings for the report.
    const igeo::LevelSet& levelSet();
    /// Paths and walks.
    std::vector<igeo::Path> lines() const;
};

struct ResultKind {
    const char* option;                      ///< --isolines
    const char* name;                        ///< in the report's list of outputs
    const char* endings;                     ///< of its file, ".json .obj .ply"; empty: any
    std::string (*file)(const RunOptions&);  ///< empty: not asked for
    /// What a run has to have for it.
    struct Needs {
        bool seeds = false;   ///< that distances begin from
        bool jet = false;     ///< the scheme
        bool points = false;  ///< no seeds but points
    } needs;
    void (*write)(RunResult& result, const std::string& file);
};

/// In the order in which they are written.
const std::vector<ResultKind>& resultKinds();

/// Writes all results that are asked for, but the report, and enters them into it.
void writeResults(RunResult& result);
