/// The parts of the module `_igeo`, which the Python package calls after checking arguments.
#pragma once

#include <igeo/igeo.h>
#include <pybind11/pybind11.h>

#include <memory>
#include <utility>

void bindSurface(pybind11::module_& module);
void bindMetric(pybind11::module_& module);
void bindSolver(pybind11::module_& module);
void bindDistance(pybind11::module_& module);

/// A metric under construction. Costs per node are for the band of `plain`, a solver without a
/// metric.
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
