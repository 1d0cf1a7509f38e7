/// The parts of the module `_igeo`: what the package in Python calls, which checks arguments first.
#pragma once

#include <igeo/igeo.h>
#include <pybind11/pybind11.h>

#include <memory>
#include <utility>

void bindSurface(pybind11::module_& module);
void bindMetric(pybind11::module_& module);
void bindSolver(pybind11::module_& module);
void bindDistance(pybind11::module_& module);

/// A metric in the making. Costs per node belong to the band of `plain`, a solver without a metric.
class MetricBuilder {
public:
    explicit MetricBuilder(igeo::GeodesicSolver plain) : plain_(std::move(plain)) {}

    const igeo::GeodesicSolver& plain() const { return plain_; }
    igeo::MetricDefinition& definition() { return definition_; }
    igeo::ObstacleSet& obstacles() {
        if (!obstacles_)
            obstacles_ = std::make_shared<igeo::ObstacleSet>(plain_.surface().transform());
        return *obstacles_;
    }
    /// The solver with the metric.
    igeo::GeodesicSolver solver(igeo::Progress& progress) const {
        igeo::SolverOptions options = plain_.options();
        options.metric = definition_;
        options.metric.obstacles = obstacles_;
        return igeo::GeodesicSolver(plain_.surface(), options, progress);
    }

private:
    igeo::GeodesicSolver plain_;
    igeo::MetricDefinition definition_;
    std::shared_ptr<igeo::ObstacleSet> obstacles_;
};
