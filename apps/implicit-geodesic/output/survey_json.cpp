#include <igeo/results/survey.h>

#include "option_words.h"
#include "output/json_parts.h"
#include "output/report.h"

using namespace igeo;
using json = Json;

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

/// The facts about a grid, as far as it was examined.
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
    j["conversionUndone"] = s.stats.conversionUndone;
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
    j["unresolved"]["bentShare"] = s.bounds.unresolvedShare;
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

json voxelsJson(const VolumeFacts& v) {
    return {{"kind", v.kind},
            {"size", v.size},
            {"spacing", triple(v.spacing)},
            {"least", double(v.range.low)},
            {"largest", double(v.range.high)},
            {"mask", v.range.isMask}};
}

}  // namespace

std::string surveyJson(const FileSurvey& file, const Provenance& provenance) {
    json j = header("info");
    j.update(originJson(provenance));
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
    j.update(costJson(provenance));
    return dump(j, 2);
}
