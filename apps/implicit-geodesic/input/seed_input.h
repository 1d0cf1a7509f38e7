/// Seeds and targets of a job, from its options and files.
#pragma once

#include <igeo/geodesic_solver.h>
#include <igeo/metric/obstacles.h>

#include <memory>
#include <string>
#include <vector>

#include "options/seed_options.h"

struct SeedInput {
    igeo::Seeds seeds;
    igeo::MarchLimits limits;           ///< with the targets
    std::vector<std::string> names;     ///< per source its description; empty for a point
    std::vector<std::string> warnings;  ///< about the files read
    /// The regions of `seeds`.
    std::vector<std::shared_ptr<const igeo::ObstacleSet>> masks;
};

/// @throws igeo::Error  as the readers, ObstacleSet and Surface::vertex
SeedInput readSeeds(const SeedOptions& options, const igeo::Surface& surface);

/// A curve through points, in the space of the options.
struct ViaInput {
    std::vector<igeo::Vec3d> points;
    bool closed = false;
    std::string name;  ///< for messages
};
/// @param warnings  gets those about the files
/// @throws igeo::Error  as the readers and Surface::vertex
std::vector<ViaInput> readVias(const SeedOptions& options, const igeo::Surface& surface,
                               std::vector<std::string>& warnings);

/// The position of a point, in the space of the options.
igeo::Vec3d positionOf(const igeo::AskedPoint& point, const SeedOptions& options,
                       const igeo::Surface& surface);
