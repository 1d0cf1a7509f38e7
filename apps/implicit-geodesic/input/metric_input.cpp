#include "input/metric_input.h"

#include <igeo/io/vdb_read.h>

#include <memory>

#include "input/guarded_read.h"

namespace {

class MetricReader {
public:
    explicit MetricReader(const MetricOptions& options) : o_(options) {}

    MetricInput read(const igeo::Similarity& transform) {
        if (o_.curvatureScale > 0) in_.definition.curvatureScale = o_.curvatureScale;
        readWeights();
        if (o_.metricCurvature) {
            in_.definition.bending = o_.metricCurvature->value;
            in_.weightNames.push_back("bending " + o_.metricCurvature->text);
        }
        if (o_.metric) {
            in_.definition.tensor =
                guardedRead(o_.metric->file, [&] { return igeo::readTensorGrids(*o_.metric); });
            warn(in_.definition.tensor->warnings);
            in_.weightNames.push_back("tensor " + o_.metric->text());
        }
        readObstacles(transform);
        return std::move(in_);
    }

private:
    void readWeights() {
        for (const igeo::GridSource& source : o_.weights) {
            in_.definition.weights.push_back(
                guardedRead(source.file, [&] { return igeo::readScalarGrid(source); }));
            warn(in_.definition.weights.back().warnings);
            in_.weightNames.push_back(source.text());
        }
        if (!o_.weightCurvature) return;
        in_.definition.curvature = o_.weightCurvature->value;
        in_.weightNames.push_back("curvature " + o_.weightCurvature->text);
    }

    void readObstacles(const igeo::Similarity& transform) {
        if (o_.obstacles.empty() && o_.obstacleSpheres.empty() && o_.obstacleBoxes.empty()) return;
        auto all = std::make_shared<igeo::ObstacleSet>(transform);
        for (const ObstacleSphere& sphere : o_.obstacleSpheres) {
            all->addSphere(sphere.center, sphere.radius);
            in_.obstacleNames.push_back("sphere " + sphere.text);
        }
        for (const ObstacleBox& box : o_.obstacleBoxes) {
            all->addBox(box.low, box.high);
            in_.obstacleNames.push_back("box " + box.text);
        }
        for (const igeo::GridSource& source : o_.obstacles) {
            const igeo::ObstacleGrid grid =
                guardedRead(source.file, [&] { return igeo::readObstacleGrid(source); });
            all->addGrid(grid);
            warn(grid.warnings);
            in_.obstacleNames.push_back(source.text());
        }
        in_.definition.obstacles = all;
    }

    void warn(const std::vector<std::string>& more) {
        in_.warnings.insert(in_.warnings.end(), more.begin(), more.end());
    }

    const MetricOptions& o_;
    MetricInput in_;
};

}  // namespace

MetricInput readMetric(const MetricOptions& options, const igeo::Similarity& transform) {
    return MetricReader(options).read(transform);
}
