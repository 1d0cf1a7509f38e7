/// The metric as asked for: files read once, laid onto any band, for any number of jobs.
#pragma once

#include <igeo/base/progress.h>
#include <igeo/io/vdb_read.h>
#include <igeo/metric/curvature.h>
#include <igeo/metric/grid_sampling.h>
#include <igeo/metric/metric.h>
#include <igeo/metric/obstacles.h>
#include <igeo/results/report.h>

#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "options/metric_options.h"

class MetricInput {
public:
    explicit MetricInput(const MetricOptions& options) : options_(options) {}

    /// Reads and checks all that the options name, the first time; to be called before all else.
    /// @param transform of the surface: obstacles are kept in its index space
    void read(const igeo::Similarity& transform);

    /// The metric on a band; null: Euclidean.
    igeo::MetricPtr on(const igeo::Band& band, igeo::Progress& progress) const;
    /// The same on the band of the whole surface, made once.
    igeo::MetricPtr onWhole(const igeo::Band& band, igeo::Progress& progress) const;

    /// A bound: no unit of length costs less, on any band; 0 where none is known.
    double leastWeight() const { return leastWeight_; }
    /// Whether values depend on the whole surface, so that a part of the band will not do.
    bool needsWholeSurface() const {
        return options_.weightCurvature || options_.hasTensor() || !(leastWeight_ > 0);
    }

    /// Curvature at the scale asked for.
    igeo::Curvature curvatureOf(const igeo::Band& band, igeo::Progress& progress) const {
        return igeo::curvature(band, curvatureScale_, progress);
    }

    const std::vector<std::string>& weightNames() const { return weightNames_; }
    const std::vector<std::string>& obstacleNames() const { return obstacleNames_; }
    /// Of the files read.
    const std::vector<std::string>& warnings() const { return warnings_; }

private:
    void readAll(const igeo::Similarity& transform);
    void readObstacles(const igeo::Similarity& transform);
    void warn(const std::vector<std::string>& more) {
        warnings_.insert(warnings_.end(), more.begin(), more.end());
    }

    const MetricOptions options_;
    mutable std::mutex mutex_;  ///< of what is made when first asked for
    bool isRead_ = false;
    mutable std::optional<igeo::MetricPtr> onWhole_;
    std::vector<igeo::LoadedGrid> weights_;
    std::optional<igeo::TensorGrids> tensor_;
    double bendingLength_ = 0;  ///< voxels
    double curvatureScale_ = igeo::kDefaultCurvatureScale;
    std::shared_ptr<igeo::ObstacleSet> obstacles_;  ///< null: none
    double leastWeight_ = 1;
    std::vector<std::string> weightNames_, obstacleNames_, warnings_;
};
