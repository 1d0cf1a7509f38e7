#include <igeo/march/jet.h>
#include <igeo/surface/level_set_band.h>
#include <igeo/surface/level_set_check.h>
#include <support/errors.h>
#include <support/openvdb.h>
#include <support/shapes.h>

#include <cmath>
#include <random>
#include <sstream>
#include <stdexcept>

#include "commands.h"
#include "domains.h"

namespace igeo::test {
namespace {

LevelSet surfaceOf(const Arguments& args) {
    if (args.has("sdf")) {
        LevelSet levelSet = checkLevelSet(readLevelSetGrid({args.text("sdf"), ""}));
        widen(levelSet, std::sqrt(3.0));
        return levelSet;
    }
    const openvdb::Vec3d center(0.5, 0.5, 0.5);
    const std::string name = args.text("shape", "sphere");
    const Shape shape = name == "sphere"    ? sphere(center, 0.4)
                        : name == "torus"   ? torus(center, 0.3, 0.12)
                        : name == "trefoil" ? trefoilTube(center, 0.12, 0.05)
                                            : throw std::runtime_error("no shape '" + name + "'");
    return checkedLevelSet(makeLevelSet(shape, 1 / args.number("n", 200), 3));
}

/// Foot points of nodes of the core by chance, the same every time.
std::vector<SurfacePoint> seedsOn(const Band& band, std::size_t count) {
    std::mt19937 random(1);
    std::vector<SurfacePoint> seeds;
    while (seeds.size() < count) {
        const auto i = NodeIndex(random() % band.size());
        if (band.inCore(i)) seeds.push_back(nearestSurfacePoint(band, band.footPoint(i)));
    }
    return seeds;
}

/// What the march itself says of its buckets.
struct Buckets : Progress {
    std::vector<double> accepted;  ///< share of the core, after each bucket
    void update(const char* stage, double share) override {
        if (std::string(stage) == "march") accepted.push_back(share);
    }
};

/// The most nodes that the march has not accepted at the end of the superstep of their value.
std::size_t lateIn(const Buckets& buckets, const Schedule& schedule) {
    std::vector<std::size_t> count(schedule.steps);
    for (const std::uint32_t step : schedule.step)
        if (step != Schedule::kNever) ++count[step];
    std::size_t late = 0, sum = 0;
    for (std::size_t s = 0; s < std::min(count.size(), buckets.accepted.size()); ++s) {
        sum += count[s];
        const double accepted = buckets.accepted[s] * double(schedule.step.size());
        late = std::max(late, sum - std::min(sum, std::size_t(std::lround(accepted))));
    }
    return late;
}

std::vector<std::size_t> numbers(const std::string& list) {
    std::vector<std::size_t> result;
    std::istringstream words(list);
    for (std::string word; std::getline(words, word, ',');) result.push_back(std::stoul(word));
    for (const std::size_t n : result)
        if (n == 0) throw std::runtime_error("numbers from 1 on, not " + list);
    return result;
}

std::string json(const Traffic& t) {
    std::ostringstream out;
    out << "{\"records\": " << t.records << ", \"messages\": " << t.messages
        << ", \"mostRecords\": " << t.mostRecords << ", \"mostMessages\": " << t.mostMessages
        << ", \"mostCopies\": " << t.mostCopies << "}";
    return out.str();
}

}  // namespace

void benchDomains(const Arguments& args) {
    const JetOptions options;
    const Band band = bandFromLevelSet(surfaceOf(args), std::sqrt(3.0));
    const auto seeds = std::size_t(args.number("seeds", 1));
    Buckets buckets;
    const Field field = marchJet(band, {}, seedsOn(band, seeds), options, buckets);
    const Schedule schedule = scheduleOf(field, options.bucketWidth);
    const std::size_t late = lateIn(buckets, schedule);
    for (const std::size_t parts : numbers(args.text("parts", "1,4,16,64")))
        for (const std::size_t pieces : numbers(args.text("pieces", "1,16"))) {
            const Replay r = replay(band, schedule, domainsOf(band, parts, pieces));
            std::printf(
                "{\"bench\": \"domains\", \"bandNodes\": %zu, \"leaves\": %zu, \"nodes\": %llu, "
                "\"seeds\": %zu, \"buckets\": %zu, \"steps\": %zu, \"late\": %zu, \"parts\": %zu, "
                "\"pieces\": %zu, \"largestShare\": %llu, \"mostWork\": %llu, \"busy\": %llu, "
                "\"links\": %s, \"halo\": %s}\n",
                band.size(), band.leaves.size(), (unsigned long long)r.nodes, seeds,
                buckets.accepted.size(), schedule.steps, late, parts, pieces,
                (unsigned long long)r.largestShare, (unsigned long long)r.mostWork,
                (unsigned long long)r.busy, json(r.links).c_str(), json(r.leaves).c_str());
        }
}

}  // namespace igeo::test
