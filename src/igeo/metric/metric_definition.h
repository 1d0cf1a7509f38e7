/// A metric before it is put on a band: the costs of steps along the surface.
#pragma once

#include <igeo/band/band.h>
#include <igeo/base/progress.h>
#include <igeo/io/vdb_read.h>
#include <igeo/metric/curvature_cost.h>
#include <igeo/metric/metric.h>
#include <igeo/metric/obstacles.h>
#include <igeo/metric/slope.h>

#include <memory>
#include <optional>
#include <vector>

namespace igeo {

/// All parts of a cost; several weights multiply. Euclidean by default.
struct MetricDefinition {
    std::vector<LoadedGrid> weights;  ///< cost per unit length
    /// Further weights: per point of the mesh that forms the surface (valuesAtPoints).
    std::vector<std::vector<double>> vertexWeights;
    /// Further weights, and a tensor in index axes instead of `tensor`: per node of the band of the
    /// whole surface, for costs that the caller computes at its foot points.
    std::vector<std::vector<float>> nodeWeights;
    std::vector<Tensor> nodeTensors;
    std::optional<CurvatureWeight> curvature;  ///< another weight
    std::optional<SlopeWeight> slope;          ///< another weight, and obstacles
    std::optional<TensorGrids> tensor;         ///< instead of a bending cost
    std::optional<BendingCost> bending;
    double curvatureScale = kDefaultCurvatureScale;  ///< radius of averages, voxels
    std::shared_ptr<const ObstacleSet> obstacles;    ///< null: none

    bool euclidean() const {
        return weights.empty() && vertexWeights.empty() && nodeWeights.empty() &&
               nodeTensors.empty() && !curvature && !slope && !tensor && !bending && !obstacles;
    }
};

/// The metric on a band; null where it is Euclidean.
/// @throws Error  as sampleWeight, sampleVertexWeights, sampleTensor, curvature, curvatureWeights,
///         curvatureTensor, slopeCosts; InvalidArgument for costs per node of another band, and
///         for such a cost out of its range (Metric::check)
/// Time O(n), in parallel.
MetricPtr metricOn(const MetricDefinition& definition, const Band& band,
                   Progress& progress = Progress::none());

/// A lower bound of the cost per unit length, on any band; 0 where none is known. O(active voxels
/// of the weights).
double leastWeight(const MetricDefinition& definition);

/// Whether values depend on the whole surface, so that a band of a part would change them.
bool needsWholeSurface(const MetricDefinition& definition);

}  // namespace igeo
