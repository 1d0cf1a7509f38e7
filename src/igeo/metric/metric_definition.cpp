#include <igeo/metric/metric_definition.h>

#include <fmt/core.h>
#include <igeo/base/error.h>
#include <igeo/metric/grid_sampling.h>
#include <igeo/metric/vertex_weights.h>

#include <algorithm>

namespace igeo {

namespace {

/// Refuses costs per node that were made for another band.
void requireNodes(std::size_t given, const Band& band) {
    if (given == band.size()) return;
    throw Error(Error::Kind::InvalidArgument,
                fmt::format("{} costs for a band of {} nodes", given, band.size()),
                "compute them at the foot points of the solver that they are for");
}

}  // namespace

MetricPtr metricOn(const MetricDefinition& d, const Band& band, Progress& progress) {
    if (d.euclidean()) return nullptr;
    auto metric = std::make_shared<Metric>();
    const Curvature curved =
        d.curvature || d.bending ? curvature(band, d.curvatureScale, progress) : Curvature{};
    if (d.tensor) metric->tensor = sampleTensor(*d.tensor, band, progress);
    if (!d.nodeTensors.empty()) {
        requireNodes(d.nodeTensors.size(), band);
        metric->tensor = d.nodeTensors;
    }
    if (d.bending)
        metric->tensor = curvatureTensor(
            band, curved, d.bending->bending,
            d.bending->length > 0 ? d.bending->length / band.transform.dx : kCurvatureUnit);
    for (const LoadedGrid& grid : d.weights) metric->multiply(sampleWeight(grid, band, progress));
    if (d.curvature)
        metric->multiply(
            curvatureWeights(curved, d.curvature->kind, d.curvature->epsilon, d.curvature->power));
    for (const std::vector<double>& weights : d.vertexWeights)
        metric->multiply(sampleVertexWeights(weights, band, progress));
    SlopeCosts slopes;
    if (d.slope) slopes = slopeCosts(band, *d.slope), metric->multiply(slopes.weights);
    for (const std::vector<float>& weights : d.nodeWeights) {
        requireNodes(weights.size(), band);
        metric->multiply(weights);
    }
    if (!d.nodeWeights.empty() || !d.nodeTensors.empty()) metric->check(band);
    metric->setObstacles(band, either(slopes.steep, d.obstacles));
    return metric;
}

double leastWeight(const MetricDefinition& d) {
    double least = 1;
    for (const LoadedGrid& grid : d.weights) least *= leastWeight(grid);
    for (const std::vector<double>& weights : d.vertexWeights)
        if (!weights.empty()) least *= *std::min_element(weights.begin(), weights.end());
    return d.curvature ? least * d.curvature->epsilon : least;
}

bool needsWholeSurface(const MetricDefinition& d) {
    return d.curvature || d.tensor || d.bending || !d.nodeWeights.empty() || !d.nodeTensors.empty();
}

}  // namespace igeo
