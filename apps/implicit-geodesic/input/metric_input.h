/// The metric of a job, from its files.
#pragma once

#include <igeo/metric/metric_definition.h>
#include <igeo/surface.h>

#include <string>
#include <vector>

#include "options/metric_options.h"

struct MetricInput {
    igeo::MetricDefinition definition;
    std::vector<std::string> weightNames, obstacleNames;  ///< as given
    std::vector<std::string> warnings;                    ///< about the files read
};

/// @throws igeo::Error  as the readers and ObstacleSet
MetricInput readMetric(const MetricOptions& options, const igeo::Surface& surface);
