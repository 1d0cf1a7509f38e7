/// Results as JSON, and tables of pairs: formats of the program. World units throughout.
#pragma once

#include <igeo/geodesic_solver.h>
#include <igeo/march/field.h>
#include <igeo/path/accuracy_estimate.h>
#include <igeo/results/distance_matrix.h>
#include <igeo/results/isolines.h>
#include <igeo/results/voronoi_cells.h>

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "output/provenance.h"

namespace igeo {
struct FileSurvey;
}

/// A curve of --via.
struct ViaCurve {
    std::string name;                 ///< as given
    std::vector<igeo::Vec3d> points;  ///< as given, world
    bool closed = false;              ///< the last vertex repeats the first
    igeo::Polyline line;
};

/// The options, results and cost of a run.
struct RunReport : Provenance {
    /// Points as given, digit by digit; empty in index space.
    std::vector<igeo::Vec3d> askedSeeds, askedTargets;
    igeo::SurfaceFacts surface;
    igeo::BandWidth width;
    double snap = 0;  ///< largest distance of points from the surface, world units
    double maxDistance = igeo::kInfinity;  ///< the given limit, world units
    bool skipOffSurface = false;           ///< targets and pairs beyond `snap` were skipped
    std::vector<std::string> weights;      ///< the parts of the metric, a word each
    std::vector<std::string> obstacles;
    int threads = 1;
    std::vector<std::string> sources;   ///< per source its description; empty: a point
    std::vector<igeo::Polyline> paths;  ///< one per target
    std::vector<igeo::Polyline> walks;  ///< geodesics of --shoot, one each
    std::vector<igeo::PairDistance> pairs;
    std::vector<ViaCurve> vias;
    std::optional<igeo::VoronoiCells> cells;
    igeo::Unresolved unresolved;
    igeo::AccuracyEstimate accuracy;
    std::vector<std::pair<std::string, std::string>> outputs;  ///< kind, file
    std::vector<std::string> warnings;

    /// Adds a sentence, in words of options, unless it is empty or known.
    void warn(const std::string& sentence);
    void warn(const std::vector<std::string>& sentences) {
        for (const std::string& sentence : sentences) warn(sentence);
    }
};

/// What every document of a run and every job in the summary of a batch begins with: originJson,
/// `warnings`, `surface`, `parameters`, `metric` and costJson.
Json provenanceJson(const RunReport& report, const igeo::Field& field);

/// docs/geodesics.schema.json. A field without seeds has walks only.
std::string geodesicsJson(const RunReport& report, const igeo::Field& field);

/// docs/isolines.schema.json.
std::string isolinesJson(const RunReport& report, const igeo::Field& field,
                         const std::vector<igeo::Isoline>& lines);

/// docs/report.schema.json.
/// @param whole  of the band
std::string reportJson(const RunReport& report, const igeo::Field& field,
                       const igeo::Extent& whole);

/// docs/matrix.schema.json.
/// @param field  any field of the band of the matrix
std::string matrixJson(const RunReport& report, const igeo::Field& field,
                       const igeo::DistanceMatrix& matrix);

/// docs/info.schema.json.
std::string surveyJson(const igeo::FileSurvey& file, const Provenance& provenance);

/// docs/pairs.schema.json.
std::string pairsJson(const RunReport& report, const igeo::Field& field);
/// Comma-separated: a first line `pair,distance,sourceSnap,targetSnap`, then a line per pair; `inf`
/// where no path joins the points. Reading the numbers gives the same doubles. With
/// RunReport::skipOffSurface there is a last column `reason`; for a skipped pair it is the only
/// value.
std::string pairsCsv(const RunReport& report);
