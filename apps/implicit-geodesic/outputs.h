/// What a run writes beside its report.
#pragma once

#include <igeo/base/progress.h>
#include <igeo/march/field.h>
#include <igeo/results/color_map.h>
#include <igeo/results/isolines.h>
#include <igeo/results/picture.h>
#include <igeo/results/report.h>
#include <igeo/results/surface_mesh.h>

#include <optional>
#include <vector>

#include "metric_input.h"
#include "options/run_options.h"
#include "surface_input.h"

/// All that outputs are made of.
struct Result {
    const SurfaceInput& surface;
    const igeo::Band& band;
    const igeo::Field& field;
    const std::vector<igeo::SurfacePoint>& targets;
    const MetricInput& metric;
    igeo::RunReport& report;

    const igeo::LevelSet& levelSet(igeo::Progress& progress) const {
        return surface.levelSet(report, progress);
    }
    /// Paths and walks.
    std::vector<igeo::Path> lines() const {
        std::vector<igeo::Path> all = report.paths;
        all.insert(all.end(), report.walks.begin(), report.walks.end());
        return all;
    }
};

/// Writes what is asked for, and enters it into the report; what several results are made of is
/// made once.
class Outputs {
public:
    explicit Outputs(const RunOptions& options);

    /// Areas and boundaries of the cells of the seeds, for the report, if labels are asked for.
    void countCells(const Result& result, igeo::Progress& progress);
    /// The distance, with the grids of --grids.
    void writeVolume(const Result& result, igeo::Progress& progress);
    /// Paths, mesh, isolines, matrix, pairs and picture.
    void writeDocuments(const Result& result, igeo::Progress& progress);

private:
    const igeo::SurfaceMesh& mesh(const Result& result, igeo::Progress& progress);
    const std::vector<igeo::Isoline>& isolines(const Result& result, igeo::Progress& progress);
    igeo::ColorMap colorMap() const;

    const RunOptions& options_;
    igeo::PictureOptions picture_;
    std::optional<igeo::SurfaceMesh> mesh_;
    std::optional<std::vector<igeo::Isoline>> isolines_;
};
