/// Options for seeds, targets and paths.
#pragma once

#include <igeo/base/space.h>
#include <igeo/base/types.h>
#include <igeo/io/grid_source.h>
#include <igeo/io/point_list.h>

#include <optional>
#include <string>
#include <vector>

struct Command;

/// A geodesic to shoot.
struct Shot {
    igeo::Vec3d from, direction;  ///< in the space of the seeds
    double length = 0;
    std::string text;  ///< as given
};

/// A curve through points.
struct Via {
    igeo::AskedCurve curve;  ///< as given; without points: read them from a file
    std::string text;        ///< as given
};

struct SeedOptions {
    std::vector<igeo::AskedPoint> seeds, targets;
    std::string seedFile, targetFile;
    std::vector<std::string> seedCurves;  ///< files of polylines
    std::vector<igeo::GridSource> seedMasks;
    bool withSign = false;
    igeo::Space space = igeo::Space::World;
    std::optional<double> snap;  ///< world units; none: SurfaceFacts::snap
    int sample = 0;  ///< number of further seeds, each as far as possible from all others
    bool stopAtTargets = false;
    bool skipOffSurface = false;  ///< skip targets and pairs off the surface
    double maxDistance = 0;       ///< world units times weight; 0: none
    std::string pairs;            ///< file of pairs
    std::vector<Shot> shots;      ///< of --shoot
    std::vector<Via> vias;

    /// Whether there are seeds other than points.
    bool hasExtendedSeeds() const { return !seedCurves.empty() || !seedMasks.empty(); }
    bool hasSeeds() const {
        return !seeds.empty() || !seedFile.empty() || hasExtendedSeeds() || sample > 0;
    }
    bool hasTargets() const { return !targets.empty() || !targetFile.empty(); }
};

void addSeedOptions(Command& command, SeedOptions& options);
