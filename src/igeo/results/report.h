/// Results as text: geodesics and the account of a run. World units throughout.
#pragma once

#include <igeo/march/field.h>
#include <igeo/path/accuracy_estimate.h>
#include <igeo/path/trace.h>
#include <igeo/results/distance_matrix.h>
#include <igeo/results/isolines.h>
#include <igeo/results/pair_distances.h>
#include <igeo/results/voronoi_cells.h>

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace igeo {

struct FileSurvey;

/// What a run was asked to do, what it found and what it cost.
struct RunReport {
    std::string file, grid;               ///< the surface
    std::string kind = "volume";          ///< "volume", "mesh" or "points"
    std::optional<bool> closed;           ///< of a mesh: every edge has two triangles
    std::uint64_t activeVoxels = 0;       ///< of a level set; 0: it is none
    double halfWidth = 0;                 ///< of the level set as read, voxels
    double largestCurvature = kInfinity;  ///< per voxel, see LevelSetStats; +inf: not known
    double bandLower = 0, bandUpper = 0;  ///< bounds of M&S (14), voxels
    double snap = 0;                      ///< how far a point may be from the surface, world units
    double maxDistance = kInfinity;       ///< limit asked for, world units
    std::vector<std::string> weights;     ///< what the metric is made of, a word each
    std::vector<std::string> obstacles;
    int threads = 1;
    std::vector<std::string> sources;  ///< what each is made of; empty: a point
    std::vector<Path> paths;           ///< one per target
    std::vector<Path> walks;           ///< straight on, one per --shoot
    std::vector<PairDistance> pairs;
    std::optional<VoronoiCells> cells;
    AccuracyEstimate accuracy;
    std::vector<std::pair<std::string, double>> seconds;       ///< wall time per stage, in order
    std::uint64_t peakMemory = 0;                              ///< bytes
    std::vector<std::pair<std::string, std::string>> outputs;  ///< kind, file
    std::vector<std::string> warnings;
};

/// docs/geodesics.schema.json. A field without seeds has walks only.
std::string geodesicsJson(const RunReport& report, const Band& band, const Field& field);

/// docs/isolines.schema.json.
std::string isolinesJson(const RunReport& report, const Band& band, const Field& field,
                         const std::vector<Isoline>& lines);

/// docs/report.schema.json.
std::string reportJson(const RunReport& report, const Band& band, const Field& field);

/// docs/matrix.schema.json. Of the report, it takes the names of the surface.
std::string matrixJson(const RunReport& report, const Band& band, const DistanceMatrix& matrix);

/// docs/info.schema.json.
std::string surveyJson(const FileSurvey& file);

/// docs/pairs.schema.json.
std::string pairsJson(const RunReport& report, const Band& band);

/// Paths as Wavefront OBJ polylines, one object per path.
std::string geodesicsObj(const std::vector<Path>& paths, const Band& band);

}  // namespace igeo
