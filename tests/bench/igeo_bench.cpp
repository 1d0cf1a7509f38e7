/// Stage times of the library on spheres, and what scripts/compare.py needs, as JSON on stdout.
///
///     igeo_bench march [--n N] [--scheme godunov] [--order 1] [--half-width W] [--runs 3]
///     [--threads 1] [--contrast C]
///     igeo_bench sweep [--n N]      godunov beside openvdb::tools::maskSdf, same band, one thread
///     igeo_bench solve|picture|exact|vertex|domains      see commands.h
///
/// With a contrast there is a weight per node, from 1 to C (1: uniform), in waves over the sphere.
///
/// Times are the least of the runs. Run it on a quiet machine and compare ratios.
#include <igeo/base/parallel.h>
#include <igeo/march/godunov.h>
#include <igeo/march/jet.h>
#include <igeo/surface/band_bounds.h>
#include <igeo/surface/level_set_band.h>
#include <support/arguments.h>
#include <support/errors.h>
#include <support/openvdb.h>
#include <support/shapes.h>

#include <chrono>
#include <cstdio>
#include <functional>
#include <map>
#include <string>

#include "commands.h"
#include "heap.h"
#include "stages.h"
#include "sweep.h"

namespace igeo::test {
namespace {

constexpr double kRadius = 0.4;

double seconds(int runs, const std::function<void()>& work) {
    double least = kInfinity;
    for (int k = 0; k < runs; ++k) {
        const auto start = std::chrono::steady_clock::now();
        work();
        const std::chrono::duration<double> d = std::chrono::steady_clock::now() - start;
        least = std::min(least, d.count());
    }
    return least;
}

struct Sphere {
    LevelSet levelSet;
    Band band;
    SurfacePoint seed;

    Sphere(int n, double h, double halfWidth)
        : levelSet(checkedLevelSet(makeLevelSet(sphere(kCenter, kRadius), 1.0 / n, halfWidth))),
          band(bandFromLevelSet(levelSet, h)),
          seed(pointOn(band, kCenter + kRadius * genericDirection())) {}
};

/// Weights from 1 to `contrast`, four waves over the sphere; null without a contrast.
MetricPtr wavyMetric(const Band& band, double contrast) {
    if (!(contrast > 0)) return nullptr;
    auto metric = std::make_shared<Metric>();
    for (NodeIndex i = 0; i < band.size(); ++i) {
        const double x = worldOf(band, band.footPoint(i)).x() - kCenter.x();
        metric->weight.push_back(
            float(std::pow(contrast, 0.5 + 0.5 * std::sin(4 * M_PI * x / kRadius))));
    }
    return metric;
}

void benchMarch(const Arguments& args) {
    const int n = int(args.number("n", 200)), runs = int(args.number("runs", 3));
    const double h = args.number("half-width", 1.7320508);
    const std::string scheme = args.text("scheme", "jet");
    const LevelSet levelSet = checkedLevelSet(
        makeLevelSet(sphere(kCenter, kRadius), 1.0 / n, std::max(args.number("input", 3), h)));
    const double before = peakMemory();
    const ThreadLimit limit(int(args.number("threads", 1)));
    Band band;
    const openvdb::Vec3d start = kCenter + kRadius * genericDirection();
    // Of the diameter of the sphere; 0: all of it. As the program does, with a band around the
    // seed only.
    const double limitDistance = args.number("max-distance", 0) * 2 * kRadius * n;
    std::vector<Ball> region;
    if (limitDistance > 0)
        region.push_back({Vec3d(start.x(), start.y(), start.z()) * double(n), limitDistance + 20});
    const double bandSeconds = seconds(runs, [&] { band = bandFromLevelSet(levelSet, h, region); });
    const SurfacePoint seed = pointOn(band, start);
    const MetricPtr metric = wavyMetric(band, args.number("contrast", 0));
    Field field;
    const double march = seconds(runs, [&] {
        GodunovOptions godunov;
        JetOptions jet;
        godunov.order = int(args.number("order", 2));
        if (limitDistance > 0) godunov.maxDistance = jet.maxDistance = limitDistance;
        field = scheme == "jet" ? marchJet(band, metric, {seed}, jet)
                                : marchGodunov(band, metric, {seed}, godunov);
    });
    const double nodes = double(band.size());
    std::printf(
        "{\"bench\": \"march\", \"n\": %d, \"nodes\": %.0f, \"reached\": %zu, \"scheme\": \"%s\", "
        "\"threads\": %d, \"bandSeconds\": %.6f, \"marchSeconds\": %.6f, \"bandNsPerNode\": %.1f, "
        "\"marchNsPerNode\": %.1f, \"bandBytesPerNode\": %.1f, \"peakBytesPerNode\": %.1f}\n",
        n, nodes, field.reached, field.scheme.c_str(), ThreadLimit::current(), bandSeconds, march,
        1e9 * bandSeconds / nodes, 1e9 * march / nodes, double(band.memUsage()) / nodes,
        (peakMemory() - before) / nodes);
}

/// godunov order 1 and maskSdf solve the same equations on the same voxels: a small sphere of exact
/// distances around the seed, the band as mask. maskSdf repeats its sweeps until its largest
/// difference from the march is below `tolerance`; on large grids its single-precision values drift
/// down with every sweep and do not get there.
void benchSweep(const Arguments& args) {
    const int n = int(args.number("n", 200));
    const double h = args.number("half-width", 1.7320508), tolerance = 1e-3;
    const Sphere s(n, h, std::max(3.0, h));
    const ThreadLimit limit(1);
    GodunovOptions options;
    options.order = 1;
    Field field;
    const double march = seconds(3, [&] { field = marchGodunov(s.band, {}, {s.seed}, options); });

    Sweep sweeper(s.band, s.seed, field.startRadius);
    for (int iterations = 1; iterations <= 8; iterations *= 2) {
        const double sweep = seconds(1, [&] { sweeper.run(iterations); });
        const Field swept = sweeper.field();
        double worst = 0;
        for (std::size_t i = 0; i < s.band.size(); ++i)
            worst = std::max(worst, std::abs(swept.distance[i] - field.distance[i]));
        std::printf(
            "{\"bench\": \"sweep\", \"n\": %d, \"nodes\": %zu, \"iterations\": %d, "
            "\"marchSeconds\": %.6f, \"sweepSeconds\": %.6f, \"ratio\": %.2f, "
            "\"largestDifferenceVoxels\": %.6f}\n",
            n, s.band.size(), iterations, march, sweep, sweep / march, worst);
        if (worst < tolerance * field.maxDistance) break;
    }
}

}  // namespace
}  // namespace igeo::test

int main(int argc, char** argv) try {
    useLargePages();
    using namespace igeo::test;
    const std::map<std::string, void (*)(const Arguments&)> commands{
        {"march", benchMarch},     {"sweep", benchSweep}, {"solve", benchSolve},
        {"picture", benchPicture}, {"exact", benchExact}, {"vertex", benchVertex},
        {"domains", benchDomains}};
    const auto command = commands.find(argc > 1 ? argv[1] : "");
    if (command == commands.end())
        throw std::runtime_error(
            "usage: igeo_bench march|sweep|solve|picture|exact|vertex|domains [--name value]");
    command->second(Arguments(argc, argv, 2));
    return 0;
} catch (const std::exception& error) {
    std::fprintf(stderr, "igeo_bench: %s\n", error.what());
    return 2;
}
