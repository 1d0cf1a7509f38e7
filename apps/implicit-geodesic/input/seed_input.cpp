#include "input/seed_input.h"

#include <igeo/base/error.h>

#include "input/guarded_read.h"
#include "input/vertex_input.h"

namespace {

std::vector<igeo::Seed> placed(const std::vector<igeo::AskedPoint>& asked,
                               const SeedOptions& options, const igeo::Surface& surface) {
    std::vector<igeo::Seed> points;
    for (const igeo::AskedPoint& p : asked)
        points.emplace_back(positionOf(p, options, surface), p.start);
    return points;
}

/// Adds the points of --seed, then the content of --seeds.
void addPointsAndGroups(const SeedOptions& o, const igeo::Surface& surface, SeedInput& in) {
    std::vector<igeo::AskedPoint> asked = o.seeds;
    igeo::AskedSeeds more;
    if (!o.seedFile.empty())
        more = guardedRead(o.seedFile, [&] { return igeo::readSeeds(o.seedFile); });
    if (more.vertices > 0 && surface.vertices())
        requireVertices(o.seedFile, more.vertices, surface.vertices()->size());
    asked.insert(asked.end(), more.points.begin(), more.points.end());
    in.seeds.points = placed(asked, o, surface);
    in.names.resize(in.seeds.points.size());
    for (const igeo::AskedGroup& group : more.groups) {
        const std::string name = group.name.empty() ? "" : "'" + group.name + "'";
        in.names.push_back("group " +
                           (name.empty() ? std::to_string(in.seeds.groups.size()) : name));
        in.seeds.groups.push_back(
            {group.name, igeo::naming(o.seedFile + ", " + in.names.back(),
                                      [&] { return placed(group.points, o, surface); })});
    }
}

std::vector<igeo::AskedPoint> targetsOf(const SeedOptions& o) {
    std::vector<igeo::AskedPoint> asked = o.targets;
    if (o.targetFile.empty()) return asked;
    const auto more = guardedRead(o.targetFile, [&] { return igeo::readPoints(o.targetFile); });
    asked.insert(asked.end(), more.begin(), more.end());
    return asked;
}

}  // namespace

igeo::Vec3d positionOf(const igeo::AskedPoint& point, const SeedOptions& o,
                       const igeo::Surface& surface) {
    if (point.vertex.empty()) return point.position;
    const igeo::Vec3d world = surface.vertex(point.vertex);
    return o.space == igeo::Space::Index ? surface.transform().indexFromWorld(world) : world;
}

SeedInput readSeeds(const SeedOptions& o, const igeo::Surface& surface) {
    SeedInput in;
    addPointsAndGroups(o, surface, in);
    for (const std::string& file : o.seedCurves)
        for (const igeo::Curve& curve :
             guardedRead(file, [&] { return igeo::readCurves(file, &in.warnings); })) {
            in.seeds.curves.push_back(curve);
            in.names.push_back("curve " + file);
            in.seeds.names.push_back("--seed-curve " + file);
        }
    for (const igeo::GridSource& source : o.seedMasks) {
        auto region = std::make_shared<igeo::ObstacleSet>(surface.transform());
        const auto warnings = addRegion(source, surface, *region);
        in.warnings.insert(in.warnings.end(), warnings.begin(), warnings.end());
        in.seeds.regions.push_back(region);
        in.masks.push_back(region);
        in.names.push_back("mask " + source.text());
        in.seeds.names.push_back("--seed-mask " + source.text());
    }
    in.seeds.samples = std::size_t(o.sample);
    in.seeds.isSigned = o.withSign;
    for (const igeo::Seed& p : placed(targetsOf(o), o, surface))
        in.limits.targets.push_back(p.position);
    in.limits.stopAtTargets = o.stopAtTargets;
    if (o.maxDistance > 0) in.limits.maxDistance = o.maxDistance;
    return in;
}

std::vector<ViaInput> readVias(const SeedOptions& o, const igeo::Surface& surface,
                               std::vector<std::string>& warnings) {
    std::vector<ViaInput> vias;
    for (const Via& via : o.vias) {
        const std::string name = "--via " + via.text;
        for (const igeo::AskedCurve& asked :
             !via.curve.points.empty() ? std::vector{via.curve} : guardedRead(via.text, [&] {
                 return igeo::readAskedCurves(via.text, &warnings);
             })) {
            vias.push_back({{}, asked.closed, name});
            for (const igeo::AskedPoint& p : asked.points)
                vias.back().points.push_back(positionOf(p, o, surface));
        }
    }
    return vias;
}
