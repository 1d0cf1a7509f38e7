#include "metric_input.h"

#include "guarded_read.h"

void MetricInput::readObstacles(const igeo::Similarity& transform) {
    if (options_.obstacles.empty() && options_.obstacleSpheres.empty() &&
        options_.obstacleBoxes.empty())
        return;
    obstacles_ = std::make_shared<igeo::ObstacleSet>(transform);
    for (const ObstacleSphere& sphere : options_.obstacleSpheres) {
        obstacles_->addSphere(sphere.center, sphere.radius);
        obstacleNames_.push_back("sphere " + sphere.text);
    }
    for (const ObstacleBox& box : options_.obstacleBoxes) {
        obstacles_->addBox(box.low, box.high);
        obstacleNames_.push_back("box " + box.text);
    }
    for (const igeo::GridSource& source : options_.obstacles) {
        const igeo::ObstacleGrid grid =
            guardedRead(source.file, [&] { return igeo::readObstacleGrid(source); });
        obstacles_->addGrid(grid);
        warn(grid.warnings);
        obstacleNames_.push_back(source.text());
    }
}

void MetricInput::read(const igeo::Similarity& transform) {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (isRead_) return;
    readAll(transform);
    isRead_ = true;
}

void MetricInput::readAll(const igeo::Similarity& transform) {
    if (options_.curvatureScale > 0) curvatureScale_ = options_.curvatureScale;
    for (const igeo::GridSource& source : options_.weights) {
        weights_.push_back(guardedRead(source.file, [&] { return igeo::readScalarGrid(source); }));
        leastWeight_ *= igeo::leastWeight(weights_.back());
        warn(weights_.back().warnings);
        weightNames_.push_back(source.text());
    }
    if (const auto& curvature = options_.weightCurvature) {
        leastWeight_ *= curvature->epsilon;
        weightNames_.push_back("curvature " + curvature->text);
    }
    if (const auto& bending = options_.metricCurvature) {
        bendingLength_ =
            bending->length.value_or(igeo::kCurvatureUnit * transform.dx) / transform.dx;
        weightNames_.push_back("bending " + bending->text);
    }
    if (const auto& source = options_.metric) {
        tensor_ = guardedRead(source->file, [&] { return igeo::readTensorGrids(*source); });
        warn(tensor_->warnings);
        weightNames_.push_back("tensor " + source->text());
    }
    readObstacles(transform);
}

igeo::MetricPtr MetricInput::on(const igeo::Band& band, igeo::Progress& progress) const {
    const auto& curvature = options_.weightCurvature;
    const auto& bending = options_.metricCurvature;
    if (weights_.empty() && !curvature && !tensor_ && !bending && !obstacles_) return nullptr;
    auto metric = std::make_shared<igeo::Metric>();
    if (tensor_) metric->tensor = igeo::sampleTensor(*tensor_, band, progress);
    if (bending)
        metric->tensor = igeo::curvatureTensor(band, curvatureOf(band, progress), bending->bending,
                                               bendingLength_);
    for (const igeo::LoadedGrid& grid : weights_)
        metric->multiply(igeo::sampleWeight(grid, band, progress));
    if (curvature)
        metric->multiply(igeo::curvatureWeights(curvatureOf(band, progress), curvature->kind,
                                                curvature->epsilon, curvature->power));
    metric->setObstacles(band, obstacles_);
    return metric;
}

igeo::MetricPtr MetricInput::onWhole(const igeo::Band& band, igeo::Progress& progress) const {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (!onWhole_) onWhole_ = on(band, progress);
    return *onWhole_;
}
