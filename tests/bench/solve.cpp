#include <igeo/base/atomic_file.h>
#include <igeo/base/parallel.h>
#include <igeo/march/godunov.h>
#include <igeo/march/jet.h>
#include <igeo/results/picture.h>
#include <igeo/surface/band_bounds.h>
#include <igeo/surface/level_set_band.h>
#include <igeo/surface/level_set_check.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>

#include "commands.h"
#include "points_csv.h"
#include "stages.h"
#include "sweep.h"

namespace igeo::test {
namespace {

constexpr double kStartRadius = 3.5;  // voxels, that of the march

Field godunov(const Band& band, const SurfacePoint& seed, int order) {
    GodunovOptions options;
    options.order = order;
    options.startRadius = kStartRadius;
    return marchGodunov(band, {}, {seed}, options);
}

/// Twice as many iterations each time until they no longer change the result by more than 0.1 % of
/// the largest distance in the mean, or are eight. Only the last run of maskSdf is in `stages`.
Field sweepUntilDone(const Band& band, const SurfacePoint& seed, Stages& stages,
                     const std::string& stage, int& iterations) {
    constexpr double kTolerance = 1e-3;
    Sweep sweep(band, seed, kStartRadius);
    Field field;
    double change = kInfinity;
    for (iterations = 1;; iterations *= 2) {
        stages.restart();
        sweep.run(iterations);
        const Stages done = stages.with(stage);
        Field next = sweep.field();
        if (!field.distance.empty()) {
            change = 0;
            for (std::size_t i = 0; i < band.size(); ++i)
                change += std::abs(next.distance[i] - field.distance[i]) / double(band.size());
        }
        field = std::move(next);
        if (change < kTolerance * field.maxDistance || iterations == 8) {
            stages = done;
            return field;
        }
    }
}

/// Voxels next to S, whose foot points stand for it.
std::vector<NodeIndex> nearNodes(const Band& band) {
    std::vector<NodeIndex> near;
    for (NodeIndex i = 0; i < band.size(); ++i)
        if (std::abs(band.psi[i]) < 1) near.push_back(i);
    return near;
}

PointsCsv surfacePoints(const Field& field, double samples) {
    const Band& band = *field.band;
    const std::vector<NodeIndex> near = nearNodes(band);
    PointsCsv csv;
    const std::size_t stride = strideFor(near.size(), samples);
    for (std::size_t k = 0; k < near.size(); k += stride) {
        const Vec3d foot = band.footPoint(near[k]);
        const double d = field.atFootPoints ? field.distance[near[k]] : sampleDistance(field, foot);
        csv.add(band.transform.worldFromIndex(foot), d * band.transform.dx);
    }
    return csv;
}

/// As many points as a row of a matrix has columns.
std::vector<SurfacePoint> targetsOn(const Band& band) {
    constexpr double kTargets = 1000;
    const std::vector<NodeIndex> near = nearNodes(band);
    std::vector<SurfacePoint> targets;
    for (std::size_t k = 0; k < near.size(); k += strideFor(near.size(), kTargets))
        targets.push_back(nearestSurfacePoint(band, band.footPoint(near[k])));
    return targets;
}

PointsCsv valuesAt(const std::vector<SurfacePoint>& targets, const std::vector<Arrival>& first,
                   const Band& band) {
    PointsCsv csv;
    for (std::size_t k = 0; k < targets.size(); ++k)
        csv.add(band.transform.worldFromIndex(targets[k].pIndex),
                first[k].distance * band.transform.dx);
    return csv;
}

}  // namespace

void benchSolve(const Arguments& args) {
    const ThreadLimit limit(int(args.number("threads", 1)));
    const std::string method = args.text("method");
    const bool atPoints = method == "jet-points";
    const int order = method == "jet" || atPoints ? 0 : method == "godunov2" ? 2 : 1;
    int iterations = 1;

    Stages stages;
    LoadedGrid loaded = readLevelSetGrid({args.text("sdf"), ""});
    stages.finished("read");
    LevelSet levelSet = checkLevelSet(std::move(loaded));
    stages.finished("check");
    const LevelSetStats& stats = levelSet.stats;
    const BandBounds bounds = bandBounds(stats);
    const double h =
        order == 0 ? bounds.lower : defaultBandWidth(order, stats.largestCurvature, bounds);
    widen(levelSet, h);
    const Band band = bandFromLevelSet(levelSet, h);
    stages.finished("band");
    std::vector<SurfacePoint> targets;
    std::optional<SharedPoints> read;  // as a row of a matrix
    JetCorePtr core;                   // null: the march makes its links as it goes
    if (atPoints) {
        targets = targetsOn(band);
        read.emplace(band, targets);
        core = jetCore(band, {});
        stages.finished("setup");
    }
    std::vector<Arrival> arrivals;
    const auto solve = [&](const Vec3d& pIndex, const std::string& stage) {
        const SurfacePoint seed = nearestSurfacePoint(band, pIndex);
        if (method == "sweep") return sweepUntilDone(band, seed, stages, stage, iterations);
        if (order == 1 && method != "godunov1")
            throw std::runtime_error("no method '" + method + "'");
        JetOptions jet;
        jet.startRadius = args.number("start-radius", jet.startRadius);
        jet.bucketWidth = args.number("bucket-width", jet.bucketWidth);
        jet.extend = !atPoints;
        Field field = order > 0 ? godunov(band, seed, order)
                      : core    ? marchJet(core, {seed}, jet)
                                : marchJet(band, {}, {seed}, jet);
        if (read) arrivals = read->read(field);
        stages.finished(stage);
        return field;
    };
    const Field field = solve(band.transform.indexFromWorld(args.point("seed")), "first");
    const double peak = peakMemory();
    const PointsCsv values =
        read ? valuesAt(targets, arrivals, band) : surfacePoints(field, args.number("samples", 0));
    if (args.has("points")) writePoints(args.text("points"), values);
    stages.restart();
    if (method == "jet") {  // as GeodesicSolver does for its second seed
        core = jetCore(band, {});
        stages.finished("links");
    }
    solve(band.footPoint(NodeIndex(band.size() / 3)), "further");

    std::printf(
        "{\"method\": \"%s\", \"nodes\": %zu, \"h\": %.6g, \"iterations\": %d, \"threads\": %d, "
        "%s, \"peakBytes\": %.0f}\n",
        method.c_str(), band.size(), h, iterations, ThreadLimit::current(), stages.json().c_str(),
        peak);
}

void benchPicture(const Arguments& args) {
    const LevelSet levelSet = checkLevelSet(readLevelSetGrid({args.text("sdf"), ""}));
    const Band band = bandFromLevelSet(levelSet, std::sqrt(3.0));
    const double dx = band.transform.dx, most = args.number("most", 1);
    const SurfacePoint seed =
        nearestSurfacePoint(band, band.transform.indexFromWorld(args.point("seed")));
    const Field field = marchJet(band, {}, {seed});
    const std::vector<double> exact = readPoints(args.text("exact")).distance;
    const std::vector<NodeIndex> near = nearNodes(band);
    if (near.size() != exact.size()) throw std::runtime_error("--exact is of another level set");
    const double largest = *std::max_element(exact.begin(), exact.end());

    Field error;
    error.band = &band;
    error.seeds = {seed};
    error.distance.assign(band.size(), kInfinity);
    for (std::size_t k = 0; k < near.size(); ++k) {
        const double off = std::abs(field.distance[near[k]] * dx - exact[k]);
        if (off < kInfinity) error.distance[near[k]] = std::min(100 * off / largest, most) / dx;
    }
    error.summarize();
    error.maxDistance = most / dx;
    PictureOptions options;
    options.width = 800, options.height = 600;
    options.colorMap = "magma";
    options.isolineSpacing = -1;
    options.quantity = "error";
    options.unit = "% of the largest";
    if (args.has("camera")) options.eye = args.point("camera");
    if (args.has("up")) options.up = args.point("up");
    writeFile(args.text("image"), renderPng(&levelSet, error, {}, options));
    std::printf("{\"nodes\": %zu}\n", near.size());
}

}  // namespace igeo::test
