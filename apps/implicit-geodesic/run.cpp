#include "run.h"

#include <fmt/core.h>
#include <igeo/base/detail/text.h>
#include <igeo/base/error.h>
#include <igeo/base/parallel.h>
#include <igeo/io/point_list.h>
#include <igeo/path/accuracy_estimate.h>

#include <algorithm>

#include "exit_code.h"
#include "input/guarded_read.h"
#include "input/seed_input.h"
#include "input/surface_input.h"
#include "output/output_files.h"
#include "output/report.h"
#include "output/result_checks.h"
#include "output/result_table.h"
#include "output/run_result.h"
#include "process.h"

using igeo::textOf;
using igeo::Vec3d;

namespace {

RunReport newReport(const igeo::GeodesicSolver& solver, const MetricInput& metric,
                    const SeedInput& seeds) {
    RunReport report;
    report.surface = solver.surface().facts();
    report.width = solver.bandWidth();
    report.snap = solver.maxSnap();
    report.maxDistance = seeds.limits.maxDistance;
    report.sources = seeds.names;
    report.weights = metric.weightNames;
    report.obstacles = metric.obstacleNames;
    auto warn = [&](const std::vector<std::string>& more) {
        report.warnings.insert(report.warnings.end(), more.begin(), more.end());
    };
    warn(report.surface.warnings);
    warn(report.width.warnings);
    warn(seeds.warnings);
    warn(metric.warnings);
    return report;
}

/// With -v: the band, the points and the metric.
void describe(const igeo::Distance& distance, const Console& console) {
    if (!console.verbose()) return;
    const igeo::Band& band = distance.band();
    const double dx = band.transform.dx;
    console.detail(fmt::format("band: h = {:.6g} ({:.4g} voxels), {} nodes{}", band.h * dx, band.h,
                               band.size(),
                               distance.ofWholeSurface() ? "" : ", not of the whole surface"));
    for (const auto& [what, points] :
         {std::pair("seed", &distance.seeds()), {"target", &distance.targets()}})
        for (std::size_t k = 0; k < points->size(); ++k) {
            const igeo::SurfacePoint& p = (*points)[k];
            if (p.joined) continue;
            console.detail(fmt::format("{} {}: {}, moved {:.3g}", what, k,
                                       textOf(band.transform.worldFromIndex(p.pIndex), 9),
                                       p.snapDistance * dx));
        }
    const igeo::Metric& metric = *distance.field().metric;
    if (metric.weighted() || metric.obstacles)
        console.detail(fmt::format("metric: weights from {:.4g} to {:.4g}, {} nodes blocked",
                                   metric.least(), metric.largest(), metric.insideCount()));
}

igeo::AccuracyEstimate estimate(const igeo::Distance& distance, const Console& console,
                                igeo::Progress& progress) {
    progress.update("accuracy", 0);
    const igeo::Field& field = distance.field();
    const igeo::AccuracyEstimate a = igeo::estimateAccuracy(field, 8, progress);
    progress.finished("accuracy");
    if (a.samples)
        console.detail(fmt::format(
            "accuracy: distances differ from straightened geodesics by {:.2g} % in the mean of {} "
            "samples, {:.2g} % at most",
            100 * a.meanError, a.samples, 100 * a.largestError));
    return a;
}

std::vector<igeo::Polyline> shoot(const igeo::GeodesicSolver& solver,
                                  const std::vector<Shot>& shots, igeo::Progress& progress) {
    std::vector<igeo::Polyline> walks;
    for (const Shot& shot : shots) {
        walks.push_back(igeo::naming("--shoot " + shot.text, [&] {
            return solver.shoot(shot.from, shot.direction, shot.length, progress);
        }));
    }
    if (!shots.empty()) progress.finished("shoot");
    return walks;
}

std::vector<igeo::PairDistance> solvePairs(const igeo::GeodesicSolver& solver, const SeedOptions& o,
                                           igeo::Progress& progress) {
    if (o.pairs.empty()) return {};
    std::vector<Vec3d> sources, targets;
    for (const igeo::AskedPair& pair :
         guardedRead(o.pairs, [&] { return igeo::readPairs(o.pairs); })) {
        sources.push_back(positionOf(pair.source, o, solver.surface()));
        targets.push_back(positionOf(pair.target, o, solver.surface()));
    }
    progress.update("pairs", 0);
    std::vector<igeo::PairDistance> pairs = solver.pairs(sources, targets, progress);
    progress.finished("pairs");
    return pairs;
}

/// What became of targets, walks and pairs.
/// @return kDone or kUnreached
int tellPaths(const RunReport& report, const igeo::Distance& distance, const Console& console) {
    const igeo::Field& field = distance.field();
    int code = kDone;
    for (std::size_t k = 0; k < report.paths.size(); ++k) {
        const igeo::Polyline& p = report.paths[k];
        if (p.status == igeo::PathStatus::Reached) {
            console.info(fmt::format("target {}: distance {:.6g}, geodesic {:.6g} {}", k,
                                     p.startDistance, p.weightedLength,
                                     field.metric->weighted()
                                         ? fmt::format("by the metric, {:.6g} long", p.length)
                                         : "long"));
            continue;
        }
        code = kUnreached;
        console.warning(fmt::format(
            "target {} is {}: {}", k, igeo::toString(p.status),
            p.status == igeo::PathStatus::Stalled ? "no way down from the target was found"
            : field.stoppedEarly                  ? "it lies beyond the distance marched"
                                                  : "no path on the surface joins it to a seed"));
    }
    return code;
}

void tellWalks(const RunReport& report, const Console& console) {
    for (std::size_t k = 0; k < report.walks.size(); ++k) {
        const igeo::Polyline& walk = report.walks[k];
        const std::string said = fmt::format("walk {}: {:.6g} long, ends at {}", k, walk.length,
                                             textOf(walk.points.back(), 9));
        if (walk.status == igeo::PathStatus::Reached)
            console.info(said);
        else
            console.warning(said + ", where the surface ends");
    }
}

int tellPairs(const RunReport& report, const Console& console) {
    if (report.pairs.empty()) return kDone;
    console.info(std::to_string(report.pairs.size()) + " pairs solved");
    const auto lost =
        std::count_if(report.pairs.begin(), report.pairs.end(),
                      [](const igeo::PairDistance& p) { return !(p.distance < igeo::kInfinity); });
    if (lost == 0) return kDone;
    console.warning(fmt::format("no path on the surface joins the points of {} pairs", lost));
    return kUnreached;
}

int tell(const RunReport& report, const igeo::Distance& distance, const RunOptions& o,
         const Console& console) {
    for (const std::string& w : report.warnings) console.warning(w);
    const int paths = tellPaths(report, distance, console);
    tellWalks(report, console);
    const int pairs = tellPairs(report, console);
    if (o.hasSeeds())
        console.info(fmt::format("distances up to {:.6g} on {} of {} band voxels in {}",
                                 distance.largest(), distance.field().reached,
                                 distance.band().size(), distanceFile(o, &report.surface.name)));
    return std::max(paths, pairs);
}

}  // namespace

igeo::SolverOptions solverOptions(const RunOptions& o) {
    igeo::SolverOptions options;
    options.scheme = o.scheme;
    options.order = o.order.value_or(options.order);
    options.band = o.band;
    options.bandVoxels = o.bandVoxels;
    return options;
}

PreparedSolver prepareSolver(const igeo::Surface& surface, const RunOptions& o,
                             igeo::Progress& progress) {
    MetricInput metric = readMetric(o, surface.transform());
    igeo::SolverOptions options = solverOptions(o);
    options.metric = metric.definition;
    return {igeo::GeodesicSolver(surface, options, progress), std::move(metric)};
}

int run(const RunOptions& options, const Console& console, ConsoleProgress& progress) {
    checkFiles(options);
    Stages stages(console, progress);
    const igeo::Surface surface = readSurface(options, stages);
    const igeo::SurfaceFacts& facts = surface.facts();
    console.detail(fmt::format("surface: {}, dx {:.6g}, {}", facts.name, surface.transform().dx,
                               facts.summary));
    return runOn(prepareSolver(surface, options, stages), options, console, stages);
}

int runOn(const PreparedSolver& prepared, const RunOptions& o, const Console& console,
          Stages& stages) {
    const igeo::QueryRules rules{o.snap.value_or(-1), o.space,
                                 o.memoryLimit > 0 ? o.memoryLimit * kGiB : machineMemory()};
    const igeo::GeodesicSolver solver = prepared.solver.with(rules);
    const SeedInput input = readSeeds(o, solver.surface());
    RunReport report = newReport(solver, prepared.metric, input);

    const igeo::Distance distance = o.hasSeeds()
                                        ? solver.distance(input.seeds, input.limits, stages)
                                        : solver.unreached(/*whole=*/!o.image.empty(), stages);
    describe(distance, console);
    if (distance.ofWholeSurface())
        if (const std::string w = solver.surface().facingWarning(distance.band()); !w.empty())
            report.warnings.push_back(w);

    report.paths = distance.paths(o.straighten, stages);
    stages.finished("trace");
    if (o.hasSeeds() && (o.verbose || !o.report.empty()))
        report.accuracy = estimate(distance, console, stages);
    report.walks = shoot(solver, o.shots, stages);
    report.pairs = solvePairs(solver, o, stages);

    RunResult result{o, solver, distance, report, stages};
    writeResults(result);
    stages.finished("write");
    report.seconds = stages.seconds();
    report.peakMemory = peakMemory();
    report.threads = igeo::ThreadLimit::current();
    if (!o.report.empty()) writeDocument(o.report, reportJson(report, distance.field()));
    return tell(report, distance, o, console);
}
