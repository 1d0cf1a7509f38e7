/// What a way costs.
#pragma once

#include <igeo/base/types.h>
#include <igeo/io/grid_source.h>
#include <igeo/metric/curvature.h>

#include <optional>
#include <string>
#include <vector>

struct Command;

/// A weight made of curvature.
struct CurvatureWeight {
    igeo::CurvatureKind kind = igeo::CurvatureKind::Valley;
    double epsilon = igeo::kDefaultCurvatureEpsilon, power = igeo::kDefaultCurvaturePower;
    std::string text;  ///< as given

    bool operator==(const CurvatureWeight&) const = default;
};

/// A tensor made of curvature.
struct BendingCost {
    igeo::Bending bending = igeo::Bending::Avoid;
    std::optional<double> length;  ///< world units; none: igeo::kCurvatureUnit voxels
    std::string text;              ///< as given

    bool operator==(const BendingCost&) const = default;
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

/// What decides on the cost of ways: jobs on one surface that agree in it share what is read.
struct MetricOptions {
    std::vector<igeo::GridSource> weights;
    std::optional<CurvatureWeight> weightCurvature;
    double curvatureScale = 0;  ///< voxels; 0: default
    std::vector<igeo::GridSource> obstacles;
    std::vector<ObstacleSphere> obstacleSpheres;
    std::vector<ObstacleBox> obstacleBoxes;
    std::optional<igeo::GridSource> metric;  ///< of a tensor
    std::optional<BendingCost> metricCurvature;

    bool hasTensor() const { return metric || metricCurvature; }
    bool operator==(const MetricOptions&) const = default;
};

void addMetricOptions(Command& command, MetricOptions& options);
