/// Seeds and targets of a job, from its options and files.
#pragma once

#include <igeo/base/types.h>
#include <igeo/geodesic_solver.h>

#include <string>
#include <vector>

#include "options/seed_options.h"

struct SeedInput {
    igeo::Seeds seeds;
    igeo::MarchLimits limits;           ///< with the targets
    std::vector<std::string> names;     ///< per source, what it is: empty for a point
    std::vector<std::string> warnings;  ///< of the files read
};

/// @param transform of the surface
/// @throws igeo::Error  as the readers and ObstacleSet
SeedInput readSeeds(const SeedOptions& options, const igeo::Similarity& transform);
