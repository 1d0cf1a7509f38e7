/// The command line, as asked for.
#pragma once

#include <algorithm>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

/// What decides on a surface and its bands: jobs that agree in it may share both.
struct SurfaceOptions {
    std::string sdf, mesh, points;  ///< one of them; sdf: FILE[:GRID]
    double voxelSize = 0;           ///< of a mesh or points; 0: by resolution
    int resolution = 0;             ///< voxels along the longest side; 0: default
    bool rebuild = false;           ///< redistance the volume
    std::optional<double> iso;      ///< the value that becomes the surface; none: by class

    double band = 0;        ///< world units; 0: default
    double bandVoxels = 0;  ///< voxels; 0: default

    std::string scheme = "jet";
    int order = 2;

    /// What was named as the surface.
    const std::string& surface() const {
        return !sdf.empty() ? sdf : !mesh.empty() ? mesh : points;
    }
    bool operator==(const SurfaceOptions& o) const {
        auto all = [](const SurfaceOptions& s) {
            return std::tie(s.sdf, s.mesh, s.points, s.voxelSize, s.resolution, s.rebuild, s.iso,
                            s.band, s.bandVoxels, s.scheme, s.order);
        };
        return all(*this) == all(o);
    }
};

/// What decides on the cost of ways: jobs on one surface that agree in it share what is read.
struct MetricOptions {
    std::vector<std::string> weights;  ///< FILE[:GRID]
    std::string weightCurvature;       ///< KIND[,eps=E][,p=P]; empty: none
    double curvatureScale = 0;         ///< voxels; 0: default
    std::vector<std::string> obstacles, obstacleSpheres, obstacleBoxes;
    std::string metric;           ///< FILE[:PREFIX] of a tensor; empty: none
    std::string metricCurvature;  ///< avoid|prefer[,length=L]; empty: none

    bool operator==(const MetricOptions& o) const {
        auto all = [](const MetricOptions& m) {
            return std::tie(m.weights, m.weightCurvature, m.curvatureScale, m.obstacles,
                            m.obstacleSpheres, m.obstacleBoxes, m.metric, m.metricCurvature);
        };
        return all(*this) == all(o);
    }
};

/// The subcommands `batch` and `batch merge`.
struct BatchOptions {
    bool asked = false;
    std::string manifest;  ///< file of the jobs
    std::string shard;     ///< "k/n"; empty: all jobs
    std::string summary;   ///< file; empty: named after the manifest
    bool dryRun = false;

    bool merge = false;
    bool matrix = false;             ///< of parts of a matrix, not of summaries
    std::vector<std::string> parts;  ///< files
    std::string output = "-";
};

struct Options : SurfaceOptions, MetricOptions {
    bool info = false;      ///< the subcommand: nothing below counts but the next two, and the last
    bool infoJson = false;  ///< its report as JSON
    std::string problems;   ///< its volume of unreliable places; empty: none

    std::vector<std::string> seeds, targets;  ///< "x,y,z"
    std::string seedFile, targetFile;
    bool indexSpace = false;
    double snap = -1;  ///< world units; < 0: the narrow band
    bool stopAtTargets = false;
    double maxDistance = 0;               ///< world units times weight; 0: none
    std::vector<std::string> seedCurves;  ///< files of polylines
    std::vector<std::string> seedMasks;   ///< FILE[:GRID]
    bool withSign = false;
    int sample = 0;                   ///< further seeds, as far from all others as can be
    std::string pairs;                ///< file of pairs
    std::vector<std::string> shoots;  ///< "x,y,z,dx,dy,dz,length"

    std::string output;  ///< empty: <input>_geodesic.vdb in the current folder
    std::vector<std::string> with;
    std::string name;  ///< of the distance grid; empty: <psi>_geodesic
    bool extend = false;
    std::string paths, json;
    std::string meshOut, isolines, matrix, pairsOut, image;
    std::string matrixRows;  ///< "k/n"; empty: all
    int levels = 0;          ///< of isolines; 0: by spacing
    double spacing = 0;      ///< of isolines, world units times weight; 0: chosen
    std::string imageSize, camera, colorMap;
    bool upZ = false;
    bool straighten = false;

    BatchOptions batch;  ///< where asked for, only `threads` and what follows it count

    int threads = 0;         ///< 0: all cores
    double memoryLimit = 0;  ///< GiB; 0: what the machine has
    std::string progress = "auto";
    bool quiet = false, verbose = false;

    bool hasSeeds() const {
        return !seeds.empty() || !seedFile.empty() || !seedCurves.empty() || !seedMasks.empty() ||
               sample > 0;
    }
    /// Whether results are asked for that a run without seeds does not have.
    bool needsSeeds() const {
        return !output.empty() || !with.empty() || extend || !meshOut.empty() ||
               !isolines.empty() || !matrix.empty() || !targets.empty() || !targetFile.empty();
    }
    /// By --grids.
    bool asked(const char* grid) const { return std::count(with.begin(), with.end(), grid) > 0; }
    /// What else than paths reads the gradient of the distance.
    bool needsGradient() const {
        return !meshOut.empty() || !isolines.empty() || !image.empty() || asked("gradient") ||
               asked("label") || asked("engraved");
    }
};

enum class ParseResult {
    Run,   ///< options are set
    Done,  ///< help or version was asked for and printed
    Usage  ///< the command line is wrong, and stderr says how
};

ParseResult parseOptions(int argc, char** argv, Options& options);

/// The options of a run from its arguments, as jobs of a batch have them: without those on how the
/// process runs (--threads, --progress, -q, -v).
/// @throws igeo::Error  InvalidArgument with what parseOptions would print
Options parseJob(const std::vector<std::string>& arguments);
