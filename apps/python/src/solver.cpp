#include <igeo/base/detail/steps.h>
#include <igeo/base/parallel.h>
#include <igeo/results/lost_points.h>

#include <algorithm>
#include <optional>

#include "arrays.h"
#include "background.h"
#include "bindings.h"

namespace {

using igeo::GeodesicSolver;
using igeo::MarchLimits;
using igeo::Seeds;

GeodesicSolver plainSolver(const igeo::Surface& surface, const std::string& scheme, int order,
                           double band, double snap, double memoryLimit,
                           const py::object& progress) {
    igeo::SolverOptions options;
    options.scheme = scheme == "godunov" ? igeo::Scheme::Godunov : igeo::Scheme::Jet;
    options.order = order;
    options.band = band;
    options.rules.maxSnap = snap;
    options.rules.memoryLimit = memoryLimit;
    return inBackground(progress,
                        [&](igeo::Progress& p) { return GeodesicSolver(surface, options, p); });
}

std::vector<igeo::Seed> seedsOf(const Array<double>& points, const Array<double>& starts) {
    std::vector<igeo::Seed> seeds;
    for (const igeo::Vec3d& p : pointsOf(points))
        seeds.emplace_back(p, starts.size() ? starts.data()[seeds.size()] : 0.0);
    return seeds;
}

/// Adds the vertices of a mesh with `inside` true, as a region.
void addRegion(Seeds& seeds, const GeodesicSolver& solver, const Array<bool>& inside) {
    auto region = std::make_shared<igeo::ObstacleSet>(solver.surface().transform());
    region->addVertexRegion(igeo::requireMesh(solver.surface()),
                            std::vector<bool>(inside.data(), inside.data() + inside.size()));
    seeds.regions.push_back(region);
}

MarchLimits limitsOf(double maxDistance, const Array<double>& targets, bool stopAtTargets) {
    return {maxDistance, pointsOf(targets), stopAtTargets};
}

/// A row per element of `all`, at the points or, without any, at the vertices of the mesh; then
/// warnings, and those of lost points.
py::tuple distances(const GeodesicSolver& solver, const std::vector<Seeds>& all,
                    const std::optional<Array<double>>& at, double maxDistance, bool lookForLost,
                    const py::object& progress) {
    const MarchLimits limits{maxDistance};
    const std::vector<igeo::Vec3d> points = at ? pointsOf(*at) : *solver.surface().vertices();
    const std::size_t columns = points.size();
    Array<double> rows({py::ssize_t(all.size()), py::ssize_t(columns)});
    double* const first = rows.mutable_data();
    std::vector<std::vector<igeo::SurfacePoint>> seeds(all.size());
    std::vector<std::string> warnings, lost;
    runInBackground(progress, [&](igeo::Progress& p) {
        igeo::CancelOnly quiet(p);
        std::optional<igeo::VertexReader> vertices;
        if (!at)
            vertices.emplace(igeo::requireMesh(solver.surface()), solver.surface().transform());
        igeo::Steps steps(p, "rows", all.size());
        igeo::parallelFor(all.size(), 1, p, [&](std::size_t begin, std::size_t end) {
            for (std::size_t k = begin; k < end; ++k) {
                const igeo::Distance found = solver.distance(all[k], limits, quiet);
                double* const row = first + k * columns;
                if (vertices) {
                    const auto values = vertices->read(found.field(), quiet).distance;
                    std::copy(values.begin(), values.end(), row);
                } else {
                    const auto values = found.valuesAt(points, quiet);
                    std::transform(values.begin(), values.end(), row,
                                   [](const igeo::PointValue& v) { return v.distance; });
                }
                if (k == 0) warnings = igeo::marchWarnings(found);
                seeds[k] = found.seeds();
                steps.add(1);
            }
        });
        const double* const last = first + all.size() * columns;
        if (lookForLost && maxDistance == igeo::kInfinity &&
            std::find(static_cast<const double*>(first), last, igeo::kInfinity) != last) {
            const auto band = solver.wholeBand(quiet);
            igeo::LostPoints rowsLost(*band, solver.wholeMetric(quiet), points);
            for (std::size_t k = 0; k < all.size(); ++k)
                rowsLost.add(seeds[k], first + k * columns);
            lost = {rowsLost.warning("distances from single seeds")};
        }
    });
    return py::make_tuple(rows, warnings, lost);
}

/// Distances of pairs, their paths if requested, warnings, and those of lost pairs; NaN and no path
/// for a skipped pair with a point off the surface.
py::tuple pairs(const GeodesicSolver& solver, const Array<double>& sources,
                const Array<double>& targets, bool withPaths, bool straighten, bool skip,
                bool lookForLost, const py::object& progress) {
    igeo::QueryRules rules = solver.options().rules;
    rules.skipOffSurface = skip;
    const auto from = pointsOf(sources), to = pointsOf(targets);
    std::vector<std::string> warnings, lost;
    std::vector<igeo::PairDistance> found = inBackground(progress, [&](igeo::Progress& p) {
        const GeodesicSolver skipping = solver.with(rules);
        auto solved =
            withPaths ? skipping.pairPaths(from, to, straighten, p) : skipping.pairs(from, to, p);
        igeo::CancelOnly quiet(p);
        warnings = igeo::pathWarnings(solver.surface(), solved);
        if (lookForLost) lost = igeo::lostWarnings(solver, solved, quiet);
        return solved;
    });
    std::vector<double> distance;
    py::list paths;
    for (igeo::PairDistance& pair : found) {
        distance.push_back(pair.distance);
        if (withPaths)
            paths.append(py::make_tuple(igeo::toString(pair.path.status),
                                        arrayOf(std::move(pair.path.points))));
    }
    return py::make_tuple(arrayOf(std::move(distance)), paths, warnings, lost);
}

/// Warnings of the width of the band and, once its band has been made, of the whole surface.
std::vector<std::string> warningsOf(const GeodesicSolver& solver) {
    const py::gil_scoped_release released;
    std::vector<std::string> warnings = solver.bandWidth().warnings;
    for (const std::string& w : igeo::surfaceWarnings(solver)) warnings.push_back(w);
    return warnings;
}

bool hasWholeBand(const GeodesicSolver& solver) {
    return solver.surface().madeBand(solver.bandWidth()) != nullptr;
}

void bindSeeds(py::module_& module) {
    using namespace py::literals;
    py::class_<Seeds>(module, "Seeds")
        .def(py::init<>())
        .def(
            "add_points",
            [](Seeds& s, const Array<double>& points, const Array<double>& starts) {
                for (const igeo::Seed& seed : seedsOf(points, starts)) s.points.push_back(seed);
            },
            "points"_a, "starts"_a)
        .def(
            "add_group",
            [](Seeds& s, const std::string& name, const Array<double>& points,
               const Array<double>& starts) {
                s.groups.push_back({name, seedsOf(points, starts)});
            },
            "name"_a, "points"_a, "starts"_a)
        .def(
            "add_curve",
            [](Seeds& s, const Array<double>& points, bool closed) {
                s.curves.push_back({pointsOf(points), closed, 0});
            },
            "points"_a, "closed"_a)
        .def("add_region", &addRegion, "solver"_a, "inside"_a)
        .def_readwrite("samples", &Seeds::samples)
        .def_readwrite("signed", &Seeds::isSigned);
}

}  // namespace

void bindSolver(py::module_& module) {
    using namespace py::literals;
    bindSeeds(module);
    module.def("plain_solver", &plainSolver, "surface"_a, "scheme"_a, "order"_a, "band"_a, "snap"_a,
               "memory_limit"_a, "progress"_a);
    py::class_<GeodesicSolver>(module, "Solver")
        .def(
            "distance",
            [](const GeodesicSolver& s, const Seeds& seeds, double maxDistance,
               const Array<double>& targets, bool stopAtTargets, const py::object& progress) {
                const MarchLimits limits = limitsOf(maxDistance, targets, stopAtTargets);
                return inBackground(
                    progress, [&](igeo::Progress& p) { return s.distance(seeds, limits, p); });
            },
            "seeds"_a, "max_distance"_a, "targets"_a, "stop_at_targets"_a, "progress"_a)
        .def("distances", &distances, "seeds"_a, "at"_a, "max_distance"_a, "look_for_lost"_a,
             "progress"_a)
        .def(
            "shoot",
            [](const GeodesicSolver& s, const Array<double>& from, const Array<double>& direction,
               double length, const py::object& progress) {
                const igeo::Vec3d start = pointOf(from), along = pointOf(direction);
                igeo::Polyline line = inBackground(
                    progress, [&](igeo::Progress& p) { return s.shoot(start, along, length, p); });
                const auto warnings = igeo::walkWarnings({line});
                return py::make_tuple(arrayOf(std::move(line.points)), warnings);
            },
            "start"_a, "direction"_a, "length"_a, "progress"_a)
        .def("pairs", &pairs, "sources"_a, "targets"_a, "paths"_a, "straighten"_a, "skip"_a,
             "look_for_lost"_a, "progress"_a)
        .def(
            "via",
            [](const GeodesicSolver& s, const Array<double>& through, bool closed, bool straighten,
               const py::object& progress) {
                const auto points = pointsOf(through);
                igeo::Polyline line = inBackground(progress, [&](igeo::Progress& p) {
                    return s.through(points, closed, straighten, p);
                });
                return arrayOf(std::move(line.points));
            },
            "points"_a, "closed"_a, "straighten"_a, "progress"_a)
        .def_property_readonly("snap", &GeodesicSolver::maxSnap)
        .def_property_readonly("band", [](const GeodesicSolver& s) { return s.bandWidth().h; })
        .def_property_readonly("has_whole_band", &hasWholeBand)
        .def("warnings", &warningsOf);
}
