#include "output/report.h"

#include <fmt/core.h>

#include <algorithm>

#include "option_words.h"
#include "output/json_parts.h"

using namespace igeo;
using json = Json;

namespace {

json pointJson(const SnappedPoint& p) {
    json j = {{"asked", triple(p.asked)},
              {"position", p.offSurface ? json(nullptr) : triple(p.position)},
              {"snapDistance", finiteOrNull(p.distance)}};
    if (p.offSurface) j["reason"] = skippedReason(p);
    return j;
}

/// The point with its position as given, if it is among the first `given`.
SnappedPoint asGiven(SnappedPoint p, const std::vector<Vec3d>& given, std::size_t k) {
    if (k < given.size()) p.asked = given[k];
    return p;
}

/// @param given  the first points, as given
json placesJson(const std::vector<MatrixPlace>& places, const std::vector<Vec3d>& given) {
    json all = json::array();
    for (const MatrixPlace& p : places)
        all.push_back(p.isGroup() ? json{{"group", p.name}, {"points", p.points}}
                                  : pointJson(asGiven(p.point, given, all.size())));
    return all;
}

json seedJson(const RunReport& r, const SnappedPoint& p, std::size_t index, double start) {
    json j = {{"index", index}};
    j.update(pointJson(asGiven(p, r.askedSeeds, index)));
    j["start"] = start;
    return j;
}

/// Sources: points one by one, curves and regions by their description.
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
            j = seedJson(r, inWorld(field.seeds[k], band.transform), source,
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

json surfaceJson(const RunReport& r, double dx) {
    return {{"file", r.surface.file}, {"grid", r.surface.name}, {"voxelSize", dx}};
}

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
    return {{"scheme", field.scheme},
            {"band", band.h * dx},
            {"bandVoxels", band.h},
            {"startRadius", field.startRadius * dx},
            {"snap", r.snap},
            {"skipOffSurface", r.skipOffSurface},
            {"maxDistance", finiteOrNull(r.maxDistance)}};
}

json metricJson(const RunReport& r, const Field& field) {
    const Metric& metric = *field.metric;
    // Without seeds there is no metric of the whole surface.
    const bool known = field.band->size() > 0 || (r.weights.empty() && r.obstacles.empty());
    return {{"weights", r.weights},
            {"obstacles", r.obstacles},
            {"least", known ? json(metric.least()) : json(nullptr)},
            {"largest", known ? json(metric.largest()) : json(nullptr)},
            {"blocked", known ? json(metric.insideCount()) : json(nullptr)}};
}

/// The common beginning of all documents of a run.
json document(const char* type, const RunReport& r, const Field& field, int schema = 2) {
    json j = header(type, schema);
    j.update(provenanceJson(r, field));
    return j;
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

/// The lengths of a curve; null where there is no curve.
json lengthsJson(const Polyline& line) {
    const bool any = !line.points.empty();
    return {{"weightedLength", any ? json(line.weightedLength) : json(nullptr)},
            {"length", any ? json(line.length) : json(nullptr)}};
}

json pathJson(const RunReport& r, const Polyline& path, std::size_t k) {
    const bool reached = path.status == PathStatus::Reached;
    json j = {
        {"status", toString(path.status)},
        {"target", pointJson(asGiven(path.start, r.askedTargets, k))},
        {"seed", reached ? seedJson(r, path.end, path.seed, path.endDistance) : json(nullptr)}};
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

void RunReport::warn(const std::string& sentence) {
    const std::string said = inOptionWords(sentence);
    const bool isNew = std::find(warnings.begin(), warnings.end(), said) == warnings.end();
    if (!said.empty() && isNew) warnings.push_back(said);
}

json provenanceJson(const RunReport& r, const Field& field) {
    json j = originJson(r);
    j["warnings"] = r.warnings;
    j["surface"] = surfaceJson(r, field.band->transform.dx);
    j["parameters"] = parametersJson(r, field);
    j["metric"] = metricJson(r, field);
    j.update(costJson(r));
    return j;
}

std::string geodesicsJson(const RunReport& r, const Field& field) {
    json j = document("geodesics", r, field, 3);
    j["paths"] = json::array();
    for (std::size_t k = 0; k < r.paths.size(); ++k)
        j["paths"].push_back(pathJson(r, r.paths[k], k));
    if (!r.walks.empty()) j["walks"] = json::array();
    for (const Polyline& walk : r.walks) j["walks"].push_back(walkJson(walk));
    if (!r.pairs.empty()) j["pairs"] = json::array();
    for (std::size_t k = 0; k < r.pairs.size(); ++k)
        j["pairs"].push_back(pairPathJson(r.pairs[k], k));
    if (!r.vias.empty()) j["via"] = json::array();
    for (const ViaCurve& via : r.vias) j["via"].push_back(viaJson(via));
    return dump(j, -1);
}

std::string pairsJson(const RunReport& r, const Field& field) {
    json j = document("pairs", r, field);
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
    json j = document("isolines", r, field, 3);
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

std::string reportJson(const RunReport& r, const Field& field, const Extent& whole) {
    const Band& band = *field.band;
    const double dx = band.transform.dx;
    json j = document("report", r, field);
    const SurfaceFacts& s = r.surface;
    j["surface"]["kind"] = nameOf(s.kind);
    j["surface"]["closed"] = s.mesh ? json(s.mesh->closed) : json(nullptr);
    j["surface"]["mesh"] = s.mesh ? meshJson(*s.mesh) : json(nullptr);
    j["surface"]["joints"] = s.joinGaps > 0 ? json(band.joints) : json(nullptr);
    j["surface"]["activeVoxels"] = s.activeVoxels ? json(s.activeVoxels) : json(nullptr);
    j["surface"]["halfWidthVoxels"] = s.halfWidth > 0 ? s.halfWidth : band.h;
    j["surface"]["largestCurvature"] = finiteOrNull(s.largestCurvature / dx);
    j["parameters"]["bandBoundsVoxels"] = {r.width.lower, r.width.upper};
    j["parameters"]["threads"] = r.threads;
    j["band"] = {
        {"nodes", band.size()}, {"leaves", band.leaves.size()}, {"bytes", band.memUsage()}};
    j["unresolved"] = unresolvedJson(r.unresolved);
    j["unresolved"]["facingShare"] = shareOrNull(r.unresolved.facing);
    j["unresolved"]["bentShare"] = shareOrNull(r.width.unresolvedShare);
    j["distance"] = {{"reached", whole.reached},
                     {"unreached", whole.nodes - whole.reached},
                     {"max", whole.maxDistance * dx},
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
    for (std::size_t k = 0; k < r.paths.size(); ++k) {
        json t = pathJson(r, r.paths[k], k);
        t.erase("vertices");
        j["targets"].push_back(t);
    }
    j["outputs"] = json::object();
    for (const auto& [kind, file] : r.outputs) j["outputs"][kind] = file;
    return dump(j, 2);
}

std::string matrixJson(const RunReport& r, const Field& field, const DistanceMatrix& m) {
    json j = document("matrix", r, field);
    j["seeds"] = placesJson(m.seeds, r.askedSeeds);
    j["targets"] = placesJson(m.targets, r.askedTargets.empty() ? r.askedSeeds : r.askedTargets);
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

std::string pairsCsv(const RunReport& r) {
    const char* const noReason = r.skipOffSurface ? "," : "";
    std::string all = "pair,distance,sourceSnap,targetSnap";
    all += r.skipOffSurface ? ",reason\n" : "\n";
    for (std::size_t k = 0; k < r.pairs.size(); ++k) {
        const PairDistance& p = r.pairs[k];
        if (p.isSkipped())
            all += fmt::format("{},,,,{}\n", k, p.reason());
        else
            all += fmt::format("{},{:.17g},{:.17g},{:.17g}{}\n", k, p.distance, p.source.distance,
                               p.target.distance, noReason);
    }
    return all;
}
