#include "input/seed_input.h"

#include <igeo/metric/obstacles.h>

#include <memory>

#include "input/guarded_read.h"
#include "input/vertex_input.h"

namespace {

/// Points of an option and of a file, in that order, where they are.
std::vector<igeo::Seed> pointsOf(const std::vector<igeo::AskedPoint>& given,
                                 const std::string& file, const SeedOptions& options,
                                 const igeo::Surface& surface) {
    std::vector<igeo::AskedPoint> asked = given;
    if (!file.empty()) {
        const auto more = guardedRead(file, [&] { return igeo::readPoints(file); });
        asked.insert(asked.end(), more.begin(), more.end());
    }
    std::vector<igeo::Seed> points;
    for (const igeo::AskedPoint& p : asked)
        points.emplace_back(positionOf(p, options, surface), p.start);
    return points;
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
    in.seeds.points = pointsOf(o.seeds, o.seedFile, o, surface);
    in.names.resize(in.seeds.points.size());
    for (const std::string& file : o.seedCurves)
        for (const igeo::Curve& curve : guardedRead(file, [&] { return igeo::readCurves(file); })) {
            in.seeds.curves.push_back(curve);
            in.names.push_back("curve " + file);
            in.seeds.names.push_back("--seed-curve " + file);
        }
    for (const igeo::GridSource& source : o.seedMasks) {
        auto region = std::make_shared<igeo::ObstacleSet>(surface.transform());
        const auto warnings = addObstacle(source, surface, *region);
        in.warnings.insert(in.warnings.end(), warnings.begin(), warnings.end());
        in.seeds.regions.push_back(region);
        in.names.push_back("mask " + source.text());
        in.seeds.names.push_back("--seed-mask " + source.text());
    }
    in.seeds.samples = std::size_t(o.sample);
    in.seeds.isSigned = o.withSign;
    for (const igeo::Seed& p : pointsOf(o.targets, o.targetFile, o, surface))
        in.limits.targets.push_back(p.position);
    in.limits.stopAtTargets = o.stopAtTargets;
    if (o.maxDistance > 0) in.limits.maxDistance = o.maxDistance;
    return in;
}
