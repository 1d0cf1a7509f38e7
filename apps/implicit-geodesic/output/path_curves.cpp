#include "output/path_curves.h"

#include <igeo/base/error.h>

#include <string>
#include <utility>

namespace {

/// Calls visit(line, name, number, closed) for every path.
template <typename Report, typename Visit>
void forPaths(Report& r, const Visit& visit) {
    for (std::size_t k = 0; k < r.paths.size(); ++k) visit(r.paths[k], "target_", k, false);
    for (std::size_t k = 0; k < r.walks.size(); ++k) visit(r.walks[k], "walk_", k, false);
    for (std::size_t k = 0; k < r.pairs.size(); ++k) visit(r.pairs[k].path, "pair_", k, false);
    for (std::size_t k = 0; k < r.vias.size(); ++k)
        visit(r.vias[k].line, "via_", k, r.vias[k].closed && !r.vias[k].line.points.empty());
}

}  // namespace

RunReport withPathsAsAsked(const RunReport& report, const igeo::GeodesicSolver& solver,
                           const ResultOptions& o) {
    RunReport asked = report;
    forPaths(asked, [&](igeo::Polyline& line, const char*, std::size_t, bool) {
        if (o.pathStep > 0)
            line = igeo::naming("--path-step", [&] { return solver.resampled(line, o.pathStep); });
        if (o.pathOffset) igeo::moveAlongNormals(line, *o.pathOffset);
    });
    return asked;
}

std::vector<igeo::NamedCurve> pathCurves(const RunReport& report) {
    std::vector<igeo::NamedCurve> curves;
    forPaths(report, [&](const igeo::Polyline& line, const char* kind, std::size_t k, bool closed) {
        curves.push_back({kind + std::to_string(k), curves.size(), closed, line.points,
                          line.normals, line.arcLength, line.distance});
    });
    return curves;
}
