#include <igeo/metric/metric_definition.h>

#include <igeo/metric/grid_sampling.h>
#include <igeo/metric/vertex_weights.h>

#include <algorithm>

namespace igeo {

MetricPtr metricOn(const MetricDefinition& d, const Band& band, Progress& progress) {
    if (d.euclidean()) return nullptr;
    auto metric = std::make_shared<Metric>();
    const Curvature curved =
        d.curvature || d.bending ? curvature(band, d.curvatureScale, progress) : Curvature{};
    if (d.tensor) metric->tensor = sampleTensor(*d.tensor, band, progress);
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
    if (d.slope) metric->multiply(slopeWeights(band, *d.slope));
    metric->setObstacles(
        band, d.slope ? steepObstacles(band.transform, *d.slope, d.obstacles) : d.obstacles);
    return metric;
}

double leastWeight(const MetricDefinition& d) {
    double least = 1;
    for (const LoadedGrid& grid : d.weights) least *= leastWeight(grid);
    for (const std::vector<double>& weights : d.vertexWeights)
        if (!weights.empty()) least *= *std::min_element(weights.begin(), weights.end());
    return d.curvature ? least * d.curvature->epsilon : least;
}

bool needsWholeSurface(const MetricDefinition& d) { return d.curvature || d.tensor || d.bending; }

}  // namespace igeo
