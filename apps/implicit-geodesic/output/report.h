/// Results as JSON, and tables of pairs: the program's own formats. World units throughout.
#pragma once

#include <igeo/geodesic_solver.h>
#include <igeo/march/field.h>
#include <igeo/path/accuracy_estimate.h>
#include <igeo/results/distance_matrix.h>
#include <igeo/results/isolines.h>
#include <igeo/results/voronoi_cells.h>

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "json_file.h"

namespace igeo {
struct FileSurvey;
}

/// A curve of --via.
struct ViaCurve {
    std::string name;                 ///< as asked for
    std::vector<igeo::Vec3d> points;  ///< as asked for, world
    bool closed = false;              ///< the last vertex repeats the first
    igeo::Polyline line;
};

/// What a run was asked to do, what it found and what it cost.
struct RunReport {
    /// Words after the program's name, without those of ProcessOptions, which change no result.
    std::vector<std::string> command;
    std::vector<std::pair<std::string, std::string>> inputs;  ///< file, digest (digestOfFile)
    /// Points as they were given, digit by digit; empty in index space.
    std::vector<igeo::Vec3d> askedSeeds, askedTargets;
    igeo::SurfaceFacts surface;
    igeo::BandWidth width;
    double snap = 0;                       ///< how far a point may be from the surface, world units
    double maxDistance = igeo::kInfinity;  ///< limit asked for, world units
    bool skipOffSurface = false;           ///< targets and pairs beyond `snap` were skipped
    std::vector<std::string> weights;      ///< what the metric is made of, a word each
    std::vector<std::string> obstacles;
    int threads = 1;
    std::vector<std::string> sources;   ///< what each is made of; empty: a point
    std::vector<igeo::Polyline> paths;  ///< one per target
    std::vector<igeo::Polyline> walks;  ///< straight on, one per --shoot
    std::vector<igeo::PairDistance> pairs;
    std::vector<ViaCurve> vias;
    std::optional<igeo::VoronoiCells> cells;
    igeo::Unresolved unresolved;
    igeo::AccuracyEstimate accuracy;
    std::vector<std::pair<std::string, double>> seconds;       ///< wall time per stage, in order
    std::uint64_t peakMemory = 0;                              ///< bytes
    std::vector<std::pair<std::string, std::string>> outputs;  ///< kind, file
    std::vector<std::string> warnings;
};

/// What every document of a run and the summary of a batch say of how it was made: `command`,
/// `versions`, `inputs`, `surface`, `parameters`, `metric` and `warnings`.
Json provenanceJson(const RunReport& report, const igeo::Field& field);

/// docs/geodesics.schema.json. A field without seeds has walks only.
std::string geodesicsJson(const RunReport& report, const igeo::Field& field);

/// docs/isolines.schema.json.
std::string isolinesJson(const RunReport& report, const igeo::Field& field,
                         const std::vector<igeo::Isoline>& lines);

/// docs/report.schema.json.
std::string reportJson(const RunReport& report, const igeo::Distance& distance);

/// docs/matrix.schema.json.
/// @param field  any of the band that the matrix is measured on
std::string matrixJson(const RunReport& report, const igeo::Field& field,
                       const igeo::DistanceMatrix& matrix);

/// docs/info.schema.json.
std::string surveyJson(const igeo::FileSurvey& file);

/// docs/pairs.schema.json.
std::string pairsJson(const RunReport& report, const igeo::Field& field);
/// Comma-separated: a first line `pair,distance,sourceSnap,targetSnap`, then a line per pair; `inf`
/// where no path joins them. Reading the numbers gives the same doubles. With
/// RunReport::skipOffSurface a last column `reason` follows; a pair that was skipped has that
/// alone.
std::string pairsCsv(const RunReport& report);
