#include "output/report.h"

#include <fmt/core.h>
#include <igeo/base/version.h>
#include <igeo/results/survey.h>

#include <nlohmann/json.hpp>

#include "option_words.h"

using namespace igeo;

namespace {

using json = nlohmann::ordered_json;

/// File and grid names may be no UTF-8; JSON is.
std::string dump(const json& j, int indent) {
    return j.dump(indent, ' ', false, json::error_handler_t::replace) + "\n";
}

json meshJson(const MeshFacts& m) {
    return {{"points", m.points},
            {"triangles", m.triangles},
            {"dropped", m.dropped},
            {"repeated", m.repeated},
            {"components", m.components},
            {"boundaryEdges", m.boundaryEdges},
            {"holes", m.holes},
            {"nonManifoldEdges", m.nonManifoldEdges},
            {"nonOrientable", m.nonOrientable},
            {"crossingPairs", m.crossingPairs},
            {"closed", m.closed}};
}

json triple(const Vec3d& v) { return {v.x, v.y, v.z}; }

/// JSON has no infinity: what is not known is null.
json finiteOrNull(double v) { return std::isfinite(v) ? json(v) : json(nullptr); }

json shareOrNull(const std::optional<double>& share) {
    return share ? json(*share) : json(nullptr);
}

json unresolvedJson(const Unresolved& u) {
    return {{"thinShare", shareOrNull(u.thin)},
            {"closedShare", shareOrNull(u.closed)},
            {"cutOffShare", shareOrNull(u.cutOff)},
            {"eulerDifference", u.eulerDifference ? json(*u.eulerDifference) : json(nullptr)}};
}

json pointJson(const SnappedPoint& p) {
    return {
        {"asked", triple(p.asked)}, {"position", triple(p.position)}, {"snapDistance", p.distance}};
}

json seedJson(const SnappedPoint& p, std::size_t index, double start) {
    json j = {{"index", index}};
    j.update(pointJson(p));
    j["start"] = start;
    return j;
}

/// Sources: points one by one, curves and regions as what they are made of.
json seedsJson(const RunReport& r, const Field& field) {
    const Band& band = *field.band;
    json all = json::array();
    for (std::size_t k = 0; k < field.seeds.size(); ++k) {
        const std::size_t source = field.source[k];
        if (source < all.size()) {
            all[source]["segments"] = all[source]["segments"].get<std::size_t>() + 1;
            continue;
        }
        json j;
        if (source < r.sources.size() && !r.sources[source].empty())
            j = {{"index", source},
                 {"of", r.sources[source]},
                 {"start", field.seeds[k].start * band.transform.dx},
                 {"segments", 1}};
        else
            j = seedJson(inWorld(field.seeds[k], band.transform), source,
                         field.seeds[k].start * band.transform.dx);
        if (r.cells) {
            const double dx = band.transform.dx;
            const VoronoiCell& cell = r.cells->cells[source];
            j["cell"] = {{"area", cell.area * dx * dx}, {"boundary", cell.boundary * dx}};
        }
        all.push_back(std::move(j));
    }
    return all;
}

json header(const char* type, int schema = 2) {
    return {{"schema", schema},
            {"type", type},
            {"creator", std::string("implicit-geodesic ") + kVersion},
            {"units", "lengths and distances in world units of the surface's transform"},
            {"space", "world"}};
}

json surfaceJson(const RunReport& r, double dx) {
    return {{"file", r.surface.file}, {"grid", r.surface.name}, {"voxelSize", dx}};
}
json surfaceJson(const RunReport& r, const Band& band) { return surfaceJson(r, band.transform.dx); }

const char* nameOf(SurfaceFacts::Kind kind) {
    switch (kind) {
        case SurfaceFacts::Kind::Mesh:
            return "mesh";
        case SurfaceFacts::Kind::Points:
            return "points";
        case SurfaceFacts::Kind::LevelSet:
            break;
    }
    return "volume";
}

json parametersJson(const RunReport& r, const Field& field) {
    const Band& band = *field.band;
    const double dx = band.transform.dx;
    return {{"scheme", field.scheme}, {"band", band.h * dx},
            {"bandVoxels", band.h},   {"startRadius", field.startRadius * dx},
            {"snap", r.snap},         {"maxDistance", finiteOrNull(r.maxDistance)}};
}

json metricJson(const RunReport& r, const Field& field) {
    const Metric& metric = *field.metric;
    return {{"weights", r.weights},
            {"obstacles", r.obstacles},
            {"least", metric.least()},
            {"largest", metric.largest()},
            {"blocked", metric.insideCount()}};
}

json triples(const std::vector<Vec3d>& vectors) {
    json all = json::array();
    for (const Vec3d& v : vectors) all.push_back(triple(v));
    return all;
}

json verticesJson(const Polyline& line) {
    return {{"position", triples(line.points)},
            {"normal", triples(line.normals)},
            {"arcLength", line.arcLength},
            {"distance", line.distance}};
}

/// Its lengths; null where there is no curve.
json lengthsJson(const Polyline& line) {
    const bool any = !line.points.empty();
    return {{"weightedLength", any ? json(line.weightedLength) : json(nullptr)},
            {"length", any ? json(line.length) : json(nullptr)}};
}

json pathJson(const Polyline& path) {
    const bool reached = path.status == PathStatus::Reached;
    json j = {{"status", toString(path.status)},
              {"target", pointJson(path.start)},
              {"seed", reached ? seedJson(path.end, path.seed, path.endDistance) : json(nullptr)}};
    j.update(lengthsJson(path));
    j["distance"] = finiteOrNull(path.startDistance);
    j["vertices"] = verticesJson(path);
    return j;
}

json pairPathJson(const PairDistance& pair, std::size_t number) {
    json j = {{"pair", number},
              {"status", toString(pair.path.status)},
              {"source", pointJson(pair.source)},
              {"target", pointJson(pair.target)}};
    j.update(lengthsJson(pair.path));
    j["distance"] = finiteOrNull(pair.distance);
    j["vertices"] = verticesJson(pair.path);
    return j;
}

json viaJson(const ViaCurve& via) {
    json j = {{"of", via.name},
              {"status", toString(via.line.status)},
              {"closed", via.closed},
              {"points", triples(via.points)},
              {"corners", via.line.corners}};
    j.update(lengthsJson(via.line));
    j["vertices"] = verticesJson(via.line);
    return j;
}

json walkJson(const Polyline& walk) {
    return {{"status", walk.status == PathStatus::Reached ? "complete" : "cut short"},
            {"start", pointJson(walk.start)},
            {"length", walk.length},
            {"vertices", verticesJson(walk)}};
}

}  // namespace

std::string geodesicsJson(const RunReport& r, const Field& field) {
    const Band& band = *field.band;
    json j = header("geodesics", 3);
    j["surface"] = surfaceJson(r, band);
    j["parameters"] = parametersJson(r, field);
    j["metric"] = metricJson(r, field);
    j["paths"] = json::array();
    for (const Polyline& path : r.paths) j["paths"].push_back(pathJson(path));
    if (!r.walks.empty()) j["walks"] = json::array();
    for (const Polyline& walk : r.walks) j["walks"].push_back(walkJson(walk));
    if (!r.pairs.empty()) j["pairs"] = json::array();
    for (std::size_t k = 0; k < r.pairs.size(); ++k)
        j["pairs"].push_back(pairPathJson(r.pairs[k], k));
    if (!r.vias.empty()) j["via"] = json::array();
    for (const ViaCurve& via : r.vias) j["via"].push_back(viaJson(via));
    return dump(j, -1);
}

std::string pairsJson(const RunReport& r, const Band& band) {
    json j = header("pairs");
    j["surface"] = surfaceJson(r, band);
    j["pairs"] = json::array();
    for (const PairDistance& p : r.pairs)
        j["pairs"].push_back({{"source", pointJson(p.source)},
                              {"target", pointJson(p.target)},
                              {"distance", finiteOrNull(p.distance)}});
    return dump(j, -1);
}

std::string isolinesJson(const RunReport& r, const Field& field,
                         const std::vector<Isoline>& lines) {
    const Band& band = *field.band;
    const double dx = band.transform.dx;
    json j = header("isolines", 3);
    j["surface"] = surfaceJson(r, band);
    j["parameters"] = parametersJson(r, field);
    j["isolines"] = json::array();
    for (const Isoline& line : lines) {
        std::vector<Vec3d> points, normals;
        for (const Vec3d& p : line.points) points.push_back(band.transform.worldFromIndex(p));
        for (const Vec3d& n : line.normals)
            normals.push_back(band.transform.worldFromIndexDirection(n));
        j["isolines"].push_back({{"level", line.level * dx},
                                 {"length", line.length * dx},
                                 {"closed", line.closed},
                                 {"position", triples(points)},
                                 {"normal", triples(normals)}});
    }
    return dump(j, -1);
}

std::string reportJson(const RunReport& r, const Field& field) {
    const Band& band = *field.band;
    const double dx = band.transform.dx;
    json j = header("report");
    j["surface"] = surfaceJson(r, band);
    const SurfaceFacts& s = r.surface;
    j["surface"]["kind"] = nameOf(s.kind);
    j["surface"]["closed"] = s.mesh ? json(s.mesh->closed) : json(nullptr);
    j["surface"]["mesh"] = s.mesh ? meshJson(*s.mesh) : json(nullptr);
    j["surface"]["joints"] = s.joinGaps > 0 ? json(band.joints) : json(nullptr);
    j["surface"]["activeVoxels"] = s.activeVoxels ? json(s.activeVoxels) : json(nullptr);
    j["surface"]["halfWidthVoxels"] = s.halfWidth > 0 ? s.halfWidth : band.h;
    j["surface"]["largestCurvature"] = finiteOrNull(s.largestCurvature / dx);
    j["parameters"] = parametersJson(r, field);
    j["parameters"]["bandBoundsVoxels"] = {r.width.lower, r.width.upper};
    j["parameters"]["threads"] = r.threads;
    j["metric"] = metricJson(r, field);
    j["band"] = {
        {"nodes", band.size()}, {"leaves", band.leaves.size()}, {"bytes", band.memUsage()}};
    j["unresolved"] = unresolvedJson(r.unresolved);
    j["unresolved"]["facingShare"] = shareOrNull(r.unresolved.facing);
    j["distance"] = {{"reached", field.reached},
                     {"unreached", band.size() - field.reached},
                     {"max", field.maxDistance * dx},
                     {"stoppedEarly", field.stoppedEarly}};
    const AccuracyEstimate& a = r.accuracy;
    j["accuracy"] = {{"samples", a.samples},
                     {"meanRelativeError", a.samples ? json(a.meanError) : json(nullptr)},
                     {"largestRelativeError", a.samples ? json(a.largestError) : json(nullptr)},
                     {"fallbackShare", a.fallbackShare}};
    j["seeds"] = seedsJson(r, field);
    if (r.cells)
        j["cells"] = {{"area", r.cells->area * dx * dx},
                      {"unreachedArea", r.cells->unreachedArea * dx * dx}};
    j["targets"] = json::array();
    for (const Polyline& path : r.paths) {
        json t = pathJson(path);
        t.erase("vertices");
        j["targets"].push_back(t);
    }
    j["seconds"] = json::object();
    for (const auto& [stage, seconds] : r.seconds) j["seconds"][stage] = seconds;
    j["peakMemoryBytes"] = r.peakMemory;
    j["outputs"] = json::object();
    for (const auto& [kind, file] : r.outputs) j["outputs"][kind] = file;
    j["warnings"] = r.warnings;
    return dump(j, 2);
}

std::string matrixJson(const RunReport& r, double dx, const DistanceMatrix& m) {
    json j = header("matrix");
    j["surface"] = surfaceJson(r, dx);
    for (const auto& [name, places] : {std::pair("seeds", &m.seeds), {"targets", &m.targets}}) {
        j[name] = json::array();
        for (const MatrixPlace& p : *places)
            j[name].push_back(p.isGroup() ? json{{"group", p.name}, {"points", p.points}}
                                          : pointJson(p.point));
    }
    if (m.rows() < m.seeds.size() || std::isnan(m.asymmetry))
        j["rows"] = {{"first", m.firstRow}, {"count", m.rows()}};
    j["distance"] = json::array();
    for (std::size_t s = m.firstRow; s < m.firstRow + m.rows(); ++s) {
        json row = json::array();
        for (std::size_t t = 0; t < m.targets.size(); ++t) row.push_back(finiteOrNull(m.at(s, t)));
        j["distance"].push_back(std::move(row));
    }
    j["asymmetry"] = finiteOrNull(m.asymmetry);
    return dump(j, -1);
}

namespace {

json gridJson(const GridEntry& g) {
    return {{"name", g.name},
            {"type", g.type},
            {"class", g.gridClass},
            {"activeVoxels", g.activeVoxels ? json(*g.activeVoxels) : json(nullptr)},
            {"surface", g.surface},
            {"weight", g.weight},
            {"obstacle", g.obstacle},
            {"points", holdsPoints(g)}};
}

json boxJson(const Vec3d& low, const Vec3d& high) { return {triple(low), triple(high)}; }

/// What a grid shows, as far as it was examined.
json levelSetJson(const FileSurvey& file) {
    const LevelSet& s = file.levelSet;
    const Similarity& t = s.transform;
    json j = {{"grid", s.name}};
    if (!(t.dx > 0)) return j;
    j["voxelSize"] = t.dx;
    j["axes"] = {triple(t.axis[0]), triple(t.axis[1]), triple(t.axis[2])};
    j["origin"] = triple(t.origin);
    if (s.stats.activeVoxels == 0) return j;
    j["box"] = boxJson(file.low, file.high);
    j["activeVoxels"] = s.stats.activeVoxels;
    j["badVoxels"] = s.stats.badVoxels;
    j["halfWidthVoxels"] = s.stats.halfWidth;
    if (s.stats.nearSurface == 0) return j;
    j["gradient"] = {{"median", s.stats.gradientMedian}, {"goodShare", s.stats.gradientShare}};
    j["cutVoxels"] = s.stats.cutVoxels;
    return j;
}

json componentJson(const SurfaceComponent& p, double dx) {
    return {{"area", p.area * dx * dx},
            {"box", boxJson(p.low, p.high)},
            {"parts", p.parts},
            {"rims", p.rims},
            {"genus", p.genus}};
}

json cloudJson(const CloudDensity& d) {
    return {{"points", d.points},    {"duplicates", d.duplicates}, {"isolated", d.isolated},
            {"spacing", d.spacing},  {"spacing99", d.spacing99},   {"scatter", d.noise},
            {"components", d.pieces}};
}

json surfaceJson(const FileSurvey& file) {
    const SurfaceSurvey& s = *file.surface;
    const LevelSetStats& stats = file.levelSet.stats;
    const double dx = file.levelSet.transform.dx;
    const auto unreliableBy = [&](Unreliable kind) { return s.unreliableBy[std::size_t(kind)]; };
    json j = {{"voxelSize", dx}, {"area", s.area * dx * dx}, {"components", json::array()}};
    for (const SurfaceComponent& p : s.components) j["components"].push_back(componentJson(p, dx));
    j["curvature"] = {{"largest", s.largestCurvature / dx},
                      {"percentile95", stats.largestCurvature / dx}};
    j["reach"] = stats.reach < stats.halfWidth ? json(stats.reach * dx) : json(nullptr);
    j["facingShare"] = s.facingShare;
    j["unresolved"] = unresolvedJson(s.unresolved);
    j["clearance"] = {{"radius95", finiteOrNull(s.medialRadius * dx)},
                      {"facingRadius99", finiteOrNull(s.facingRadius * dx)},
                      {"resolvingVoxelSize", finiteOrNull(s.resolvingSize * dx)}};
    j["band"] = {{"boundsVoxels", {s.bounds.lower, s.bounds.upper}},
                 {"upperBoundFrom", s.bounds.why},
                 {"resolved", s.bounds.resolved},
                 {"jetVoxels", s.bounds.lower},
                 {"godunovVoxels", s.godunovBand},
                 {"nodes", file.band.size()}};
    j["unreliable"] = {{"nodes", s.unreliable},
                       {"share", double(s.unreliable) / double(file.band.size())},
                       {"bend", unreliableBy(Unreliable::Bend)},
                       {"facing", unreliableBy(Unreliable::Facing)},
                       {"gradient", unreliableBy(Unreliable::Rough)},
                       {"cut", unreliableBy(Unreliable::Cut)}};
    j["estimate"] = {{"bytes", s.bytes}, {"secondsOnOneCore", s.seconds}};
    return j;
}

}  // namespace

json voxelsJson(const VolumeFacts& v) {
    return {{"kind", v.kind},
            {"size", v.size},
            {"spacing", triple(v.spacing)},
            {"least", double(v.range.low)},
            {"largest", double(v.range.high)},
            {"mask", v.range.isMask}};
}

std::string surveyJson(const FileSurvey& file) {
    json j = header("info");
    j["file"] = file.file;
    j["grids"] = json::array();
    for (const GridEntry& g : file.grids) j["grids"].push_back(gridJson(g));
    j["voxels"] = file.voxels ? voxelsJson(*file.voxels) : json(nullptr);
    j["mesh"] = file.mesh ? meshJson(*file.mesh) : json(nullptr);
    j["points"] = file.points ? cloudJson(*file.points) : json(nullptr);
    j["levelSet"] = file.ofGrid() ? levelSetJson(file) : json(nullptr);
    j["surface"] = file.surface ? surfaceJson(file) : json(nullptr);
    j["warnings"] = file.warnings;
    j["usable"] = !file.refusal;
    j["withCare"] = file.withCare();
    j["verdict"] = inOptionWords(file.verdict());
    j["refusal"] = file.refusal ? json{{"what", file.refusal->what()},
                                       {"remedy", inOptionWords(file.refusal->remedy())}}
                                : json(nullptr);
    return dump(j, 2);
}

std::string pairsCsv(const std::vector<PairDistance>& pairs) {
    std::string all = "pair,distance,sourceSnap,targetSnap\n";
    for (std::size_t k = 0; k < pairs.size(); ++k)
        all += fmt::format("{},{:.17g},{:.17g},{:.17g}\n", k, pairs[k].distance,
                           pairs[k].source.distance, pairs[k].target.distance);
    return all;
}
