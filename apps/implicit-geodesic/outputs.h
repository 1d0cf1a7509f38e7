/// What a run writes beside distances, paths and report.
#pragma once

#include <igeo/field.h>
#include <igeo/level_set.h>
#include <igeo/progress.h>
#include <igeo/report.h>

#include <string>
#include <vector>

#include "metric_input.h"
#include "options.h"

/// All that outputs are made of.
struct Result {
    const igeo::LevelSet& levelSet;
    const igeo::Band& band;
    const igeo::Field& field;
    const std::vector<igeo::SurfacePoint>& targets;
    const MetricInput& metric;
    const igeo::RunReport& report;
};

/// Refuses endings, names and numbers that can only fail later.
void checkOutputOptions(const Options& options);

/// The grids of --with behind the distance.
/// @param base name of the distance grid
openvdb::GridCPtrVec extraGrids(const Options& options, const Result& result,
                                const std::string& base, igeo::Progress& progress);

/// A file that is text or bytes.
struct Document {
    const char* kind;  ///< in the report
    std::string file, content;
};

/// Mesh, isolines and matrix, as far as asked for.
std::vector<Document> documents(const Options& options, const Result& result,
                                igeo::Progress& progress);

/// The picture of --image.
void writeImage(const Options& options, const Result& result, igeo::Progress& progress);
