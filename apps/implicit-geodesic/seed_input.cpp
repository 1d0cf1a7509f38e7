#include "seed_input.h"

#include <igeo/base/error.h>
#include <igeo/io/vdb_read.h>
#include <igeo/march/signed_field.h>

#include "guarded_read.h"
#include "usage_error.h"

using igeo::Error;

std::vector<igeo::AskedPoint> askedPoints(const std::vector<igeo::AskedPoint>& given,
                                          const std::string& file) {
    std::vector<igeo::AskedPoint> points = given;
    if (!file.empty())
        for (const igeo::AskedPoint& p : guardedRead(file, [&] { return igeo::readPoints(file); }))
            points.push_back(p);
    return points;
}

void SeedInput::read(const SeedOptions& options, const igeo::Similarity& transform) {
    points_ = askedPoints(options.seeds, options.seedFile);
    samples_ = options.sample;
    signed_ = options.withSign;
    for (const std::string& file : options.seedCurves)
        for (igeo::Curve curve : guardedRead(file, [&] { return igeo::readCurves(file); })) {
            if (!options.indexSpace())
                for (igeo::Vec3d& p : curve.points) p = transform.indexFromWorld(p);
            curve.start /= transform.dx;
            curves_.push_back({"curve " + file, curve});
        }
    for (const igeo::GridSource& source : options.seedMasks) {
        auto body = std::make_shared<igeo::ObstacleSet>(transform);
        const igeo::ObstacleGrid grid =
            guardedRead(source.file, [&] { return igeo::readObstacleGrid(source); });
        body->addGrid(grid);
        warnings_.insert(warnings_.end(), grid.warnings.begin(), grid.warnings.end());
        regions_.push_back({"mask " + source.text(), body});
    }
}

std::vector<igeo::SurfacePoint> SeedInput::extendedSeeds(const igeo::Band& band,
                                                         double snap) const {
    std::vector<igeo::SurfacePoint> seeds;
    auto add = [&](const std::vector<igeo::SurfacePoint>& more) {
        seeds.insert(seeds.end(), more.begin(), more.end());
    };
    for (const NamedCurve& c : curves_) {
        try {
            add(igeo::seedsAlong(band, c.curve, snap));
        } catch (const Error& e) {
            throw Error(e.kind(), "--seed-" + c.name + ": " + e.what(), e.remedy());
        }
    }
    for (const Region& region : regions_) {
        const auto around = igeo::seedsAround(band, *region.body);
        if (around.empty())
            usageError("--seed-" + region.name + ": its rim does not cross the surface",
                       "give a mask that holds some voxels of the surface, and not all");
        add(around);
    }
    return seeds;
}

std::vector<std::uint8_t> SeedInput::inside(const igeo::Band& band) const {
    std::vector<std::uint8_t> in(band.size());
    for (const Region& region : regions_) {
        const auto more = igeo::nodesInside(band, *region.body);
        for (std::size_t i = 0; i < in.size(); ++i) in[i] |= more[i];
    }
    return in;
}

void SeedInput::finish(const igeo::Band& band, igeo::Field& field) const {
    if (!regions_.empty())
        (signed_ ? igeo::signInside : igeo::clearInside)(inside(band), field);
    else if (signed_)
        field.sign = igeo::signsOfCurves(band, field);
}

std::vector<std::string> SeedInput::names() const {
    std::vector<std::string> names(points_.size());
    for (const NamedCurve& c : curves_) names.push_back(c.name);
    for (const Region& region : regions_) names.push_back(region.name);
    return names;
}
