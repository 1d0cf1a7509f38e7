#include <igeo/base/parallel.h>
#include <igeo/surface/unresolved.h>

#include <algorithm>
#include <atomic>
#include <optional>

#include "arrays.h"
#include "background.h"
#include "bindings.h"
#include "lost_rows.h"

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
    region->addVertices(igeo::requireMesh(solver.surface()),
                        std::vector<bool>(inside.data(), inside.data() + inside.size()));
    seeds.regions.push_back(region);
}

MarchLimits limitsOf(double maxDistance, const Array<double>& targets, bool stopAtTargets) {
    return {maxDistance, pointsOf(targets), stopAtTargets};
}

/// A row per element of `all`, at the points or, without any, at the vertices of the mesh; then
/// whether a march was of the whole surface, warnings of the costs, and one of lost points.
py::tuple distances(const GeodesicSolver& solver, const std::vector<Seeds>& all,
                    const std::optional<Array<double>>& at, double maxDistance, bool lookForLost,
                    const py::object& progress) {
    const MarchLimits limits{maxDistance};
    const std::vector<igeo::Vec3d> points = at ? pointsOf(*at) : *solver.surface().vertices();
    const std::size_t columns = points.size();
    Array<double> rows({py::ssize_t(all.size()), py::ssize_t(columns)});
    double* const first = rows.mutable_data();
    std::vector<std::vector<igeo::SurfacePoint>> seeds(all.size());
    std::atomic<bool> whole{false};
    std::vector<std::string> costs;
    std::string lost;
    runInBackground(progress, [&](igeo::Progress& p) {
        igeo::CancelOnly quiet(p);
        std::optional<igeo::VertexReader> vertices;
        if (!at)
            vertices.emplace(igeo::requireMesh(solver.surface()), solver.surface().transform());
        std::atomic<std::size_t> done{0};
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
                if (found.ofWholeSurface()) whole = true;
                if (k == 0) costs = found.costWarnings();
                seeds[k] = found.seeds();
                p.update("rows", double(++done) / double(all.size()));
            }
        });
        const double* const last = first + all.size() * columns;
        if (lookForLost && maxDistance == igeo::kInfinity &&
            std::find(static_cast<const double*>(first), last, igeo::kInfinity) != last)
            lost = lostOfRows(*solver.wholeBand(quiet), solver.wholeMetric(quiet), points,
                              all.size(), first, "distances from single seeds",
                              [&](std::size_t k) { return seeds[k]; });
    });
    return py::make_tuple(rows, bool(whole), costs, lost);
}

/// A sentence on pairs without a distance that triangles join; empty where there are none.
std::string lostPairs(const GeodesicSolver& solver, const std::vector<igeo::PairDistance>& pairs,
                      igeo::Progress& progress) {
    const auto found = [](const igeo::PairDistance& p) {
        return p.isSkipped() || p.distance < igeo::kInfinity;
    };
    if (std::all_of(pairs.begin(), pairs.end(), found)) return "";
    const auto band = solver.wholeBand(progress);
    igeo::LostPoints lost(*band, solver.wholeMetric(progress));
    for (const igeo::PairDistance& p : pairs) {
        if (p.isSkipped()) continue;
        igeo::SurfacePoint source;
        source.pIndex = band->transform.indexFromWorld(p.source.position);
        lost.add({source}, {p.target.position}, {p.distance});
    }
    return lost.warning("pairs");
}

/// Distances of pairs, their paths if requested, and a warning of lost ones; NaN and no path for a
/// skipped pair with a point off the surface.
py::tuple pairs(const GeodesicSolver& solver, const Array<double>& sources,
                const Array<double>& targets, bool withPaths, bool straighten, bool skip,
                bool lookForLost, const py::object& progress) {
    igeo::QueryRules rules = solver.options().rules;
    rules.skipOffSurface = skip;
    const auto from = pointsOf(sources), to = pointsOf(targets);
    std::string lost;
    std::vector<igeo::PairDistance> found = inBackground(progress, [&](igeo::Progress& p) {
        const GeodesicSolver skipping = solver.with(rules);
        auto solved =
            withPaths ? skipping.pairPaths(from, to, straighten, p) : skipping.pairs(from, to, p);
        igeo::CancelOnly quiet(p);
        if (lookForLost) lost = lostPairs(solver, solved, quiet);
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
    return py::make_tuple(arrayOf(std::move(distance)), paths, lost);
}

/// The band of the whole surface if it has been made, else null.
std::shared_ptr<const igeo::Band> madeBand(const GeodesicSolver& solver) {
    return solver.surface().madeBand(solver.bandWidth());
}

/// Warnings about the width of the band, and about the whole surface if its band has been made.
std::vector<std::string> warningsOf(const GeodesicSolver& solver, bool ofWholeSurface) {
    std::vector<std::string> warnings = solver.bandWidth().warnings;
    const py::gil_scoped_release released;
    if (const auto band = ofWholeSurface ? madeBand(solver) : nullptr)
        for (const std::string& w : igeo::unresolvedWarnings(solver.surface().unresolved(*band)))
            warnings.push_back(w);
    return warnings;
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
                return arrayOf(std::move(line.points));
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
        .def_property_readonly("has_whole_band",
                               [](const GeodesicSolver& s) { return madeBand(s) != nullptr; })
        .def("warnings", &warningsOf, "of_whole_surface"_a);
}
