/// Options for the cost of paths.
#pragma once

#include <igeo/base/types.h>
#include <igeo/io/grid_source.h>
#include <igeo/metric/curvature_cost.h>
#include <igeo/metric/slope.h>

#include <optional>
#include <string>
#include <vector>

struct Command;

/// A value with the word that it was read from.
template <typename Value>
struct Given {
    Value value;
    std::string text;

    bool operator==(const Given&) const = default;
};

struct ObstacleSphere {
    igeo::Vec3d center;
    double radius = 0;
    std::string text;  ///< as given

    bool operator==(const ObstacleSphere&) const = default;
};

struct ObstacleBox {
    igeo::Vec3d low, high;
    std::string text;  ///< as given

    bool operator==(const ObstacleBox&) const = default;
};

/// The options that determine the cost of paths: jobs on one surface that agree in them share it.
struct MetricOptions {
    std::vector<igeo::GridSource> weights;  ///< also FILE of values per vertex
    std::optional<Given<igeo::CurvatureWeight>> weightCurvature;
    std::optional<Given<igeo::SlopeWeight>> weightSlope;
    double curvatureScale = 0;                ///< voxels; 0: default
    std::vector<igeo::GridSource> obstacles;  ///< also FILE[:VALUE] of values per vertex
    std::vector<ObstacleSphere> obstacleSpheres;
    std::vector<ObstacleBox> obstacleBoxes;
    std::optional<igeo::GridSource> metric;  ///< of a tensor
    std::optional<Given<igeo::BendingCost>> metricCurvature;

    bool hasTensor() const { return metric || metricCurvature; }
    bool operator==(const MetricOptions&) const = default;
};

void addMetricOptions(Command& command, MetricOptions& options);
