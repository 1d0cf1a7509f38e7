#include "input/metric_input.h"

#include <igeo/io/vdb_read.h>
#include <igeo/io/vertex_data_file.h>

#include <memory>

#include "input/guarded_read.h"
#include "input/vertex_input.h"

namespace {

class MetricReader {
public:
    MetricReader(const MetricOptions& options, const igeo::Surface& surface)
        : o_(options), surface_(surface) {}

    MetricInput read() {
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
        readObstacles();
        return std::move(in_);
    }

private:
    void readWeights() {
        for (const igeo::GridSource& source : o_.weights) {
            in_.weightNames.push_back(source.text());
            if (igeo::isVertexDataFile(source.text())) {
                in_.definition.vertexWeights.push_back(vertexWeights(source.text(), surface_));
                continue;
            }
            if (igeo::isVertexDataFile(source.file))
                throw igeo::Error(igeo::Error::Kind::InvalidArgument,
                                  "--weight " + source.text() + ": '" + source.file +
                                      "' holds a value per vertex, and no grid '" + source.grid +
                                      "'",
                                  "write --weight " + source.file);
            in_.definition.weights.push_back(
                guardedRead(source.file, [&] { return igeo::readScalarGrid(source); }));
            warn(in_.definition.weights.back().warnings);
        }
        if (o_.weightCurvature) {
            in_.definition.curvature = o_.weightCurvature->value;
            in_.weightNames.push_back("curvature " + o_.weightCurvature->text);
        }
        if (o_.weightSlope) {
            in_.definition.slope = o_.weightSlope->value;
            in_.weightNames.push_back("slope " + o_.weightSlope->text);
        }
    }

    void readObstacles() {
        if (o_.obstacles.empty() && o_.obstacleSpheres.empty() && o_.obstacleBoxes.empty()) return;
        auto all = std::make_shared<igeo::ObstacleSet>(surface_.transform());
        for (const ObstacleSphere& sphere : o_.obstacleSpheres) {
            all->addSphere(sphere.center, sphere.radius);
            in_.obstacleNames.push_back("sphere " + sphere.text);
        }
        for (const ObstacleBox& box : o_.obstacleBoxes) {
            all->addBox(box.low, box.high);
            in_.obstacleNames.push_back("box " + box.text);
        }
        for (const igeo::GridSource& source : o_.obstacles) {
            warn(addObstacle(source, surface_, *all));
            in_.obstacleNames.push_back(source.text());
        }
        in_.definition.obstacles = all;
    }

    void warn(const std::vector<std::string>& more) {
        in_.warnings.insert(in_.warnings.end(), more.begin(), more.end());
    }

    const MetricOptions& o_;
    const igeo::Surface& surface_;
    MetricInput in_;
};

}  // namespace

MetricInput readMetric(const MetricOptions& options, const igeo::Surface& surface) {
    return MetricReader(options, surface).read();
}
