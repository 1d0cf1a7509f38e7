#include "run.h"

#include <fmt/core.h>
#include <igeo/base/digest.h>
#include <igeo/base/error.h>
#include <igeo/base/parallel.h>
#include <igeo/io/point_list.h>
#include <igeo/path/accuracy_estimate.h>
#include <igeo/warnings.h>

#include "input/guarded_read.h"
#include "input/seed_input.h"
#include "input/surface_input.h"
#include "output/grids.h"
#include "output/messages.h"
#include "output/output_files.h"
#include "output/report.h"
#include "output/result_checks.h"
#include "output/result_table.h"
#include "output/run_result.h"
#include "prepared_solver.h"
#include "process.h"

using igeo::Vec3d;

namespace {

/// Whether a requested document names its inputs with their digests.
bool writesDocument(const RunOptions& o) {
    const std::vector<std::string> files{o.paths, o.isolines, o.matrix, o.pairsOut};
    return !o.report.empty() || std::any_of(files.begin(), files.end(), [](const std::string& f) {
        return f == "-" || endingOf(f) == ".json";
    });
}

RunReport newReport(const igeo::GeodesicSolver& solver, const MetricInput& metric,
                    const SeedInput& seeds, const RunOptions& o, const FileDigests& digests) {
    RunReport report;
    report.command = withoutProcessOptions(o.words);
    if (writesDocument(o) || !digests.empty())
        for (const std::string& file : inputFiles(o)) {
            const auto known = digests.find(file);
            report.inputs.emplace_back(
                file, known == digests.end() ? igeo::digestOfFile(file) : known->second);
        }
    if (o.space == igeo::Space::World) {
        for (const igeo::Seed& seed : seeds.seeds.points)
            report.askedSeeds.push_back(seed.position);
        report.askedTargets = seeds.limits.targets;
    }
    report.surface = solver.surface().facts();
    report.width = solver.bandWidth();
    report.snap = solver.maxSnap();
    report.maxDistance = seeds.limits.maxDistance;
    report.skipOffSurface = o.skipOffSurface;
    report.sources = seeds.names;
    report.weights = metric.weightNames;
    report.obstacles = metric.obstacleNames;
    report.warn(report.surface.warnings);
    report.warn(report.width.warnings);
    report.warn(seeds.warnings);
    report.warn(metric.warnings);
    return report;
}

igeo::AccuracyEstimate estimate(const igeo::Distance& distance, const igeo::FitError& fit,
                                const Console& console, igeo::Progress& progress) {
    progress.update("accuracy", 0);
    const igeo::AccuracyEstimate a = igeo::estimateAccuracy(*distance.marched(), fit, progress);
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

std::vector<igeo::PairDistance> solvePairs(const igeo::GeodesicSolver& solver, const RunOptions& o,
                                           igeo::Progress& progress) {
    if (o.pairs.empty()) return {};
    std::vector<Vec3d> sources, targets;
    for (const igeo::AskedPair& pair :
         guardedRead(o.pairs, [&] { return igeo::readPairs(o.pairs); })) {
        sources.push_back(positionOf(pair.source, o, solver.surface()));
        targets.push_back(positionOf(pair.target, o, solver.surface()));
    }
    progress.update("pairs", 0);
    std::vector<igeo::PairDistance> pairs =
        o.paths.empty() ? solver.pairs(sources, targets, progress)
                        : solver.pairPaths(sources, targets, o.straighten, progress);
    progress.finished("pairs");
    return pairs;
}

std::vector<ViaCurve> solveVias(const igeo::GeodesicSolver& solver, const RunOptions& o,
                                RunReport& report, igeo::Progress& progress) {
    std::vector<ViaCurve> curves;
    std::vector<std::string> warnings;
    const std::vector<ViaInput> vias = readVias(o, solver.surface(), warnings);
    report.warn(warnings);
    for (const ViaInput& via : vias) {
        ViaCurve curve{via.name, via.points, via.closed, {}};
        if (o.space == igeo::Space::Index)
            for (Vec3d& p : curve.points) p = solver.surface().transform().worldFromIndex(p);
        curve.line = igeo::naming(via.name, [&] {
            return solver.through(via.points, via.closed, o.straighten, progress);
        });
        curves.push_back(std::move(curve));
    }
    if (!curves.empty()) progress.finished("via");
    return curves;
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
    MetricInput metric = readMetric(o, surface);
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
    PreparedSolver prepared = prepareSolver(surface, options, stages);
    prepared.lastRun = true;
    return runOn(prepared, options, console, stages).exitCode;
}

RunOutcome runOn(const PreparedSolver& prepared, const RunOptions& o, const Console& console,
                 Stages& stages, const FileDigests& digests) {
    const igeo::QueryRules rules{o.snap.value_or(-1), o.space,
                                 o.memoryLimit > 0 ? o.memoryLimit * kGiB : machineMemory(),
                                 o.skipOffSurface};
    const igeo::GeodesicSolver solver = prepared.solver.with(rules);
    checkGridNames(o, solver.surface().gridName());
    checkFileOfGrid(o, solver.surface().facts().name);
    const SeedInput input = readSeeds(o, solver.surface());
    checkSeeds(o, input.seeds);
    RunReport report = newReport(solver, prepared.metric, input, o, digests);

    const igeo::Distance distance =
        o.hasSeeds() ? solver.distance(input.seeds, input.limits, stages)
                     : solver.unreached(
                           /*whole=*/!o.image.empty() || !o.view.empty(), stages);
    describe(distance, console);
    if (showsPaths(o, distance.targets().size())) {
        report.paths = distance.paths(o.straighten, stages);
        stages.finished("trace");
    }
    if (o.hasSeeds() && (o.verbose || !o.report.empty()))
        report.accuracy = estimate(distance, report.surface.fit, console, stages);
    report.warn(igeo::estimateWarnings(report.accuracy));
    report.walks = shoot(solver, o.shots, stages);
    report.pairs = solvePairs(solver, o, stages);
    report.vias = solveVias(solver, o, report, stages);
    warnOfResults(solver, input, distance, report, stages);

    report.seconds = stages.seconds();
    report.peakMemory = peakMemory();
    report.threads = igeo::ThreadLimit::current();
    RunResult result{o, input, solver, distance, report, stages, prepared.lastRun};
    writeResults(result);
    stages.finished("write");
    report.seconds = stages.seconds();
    report.peakMemory = peakMemory();
    if (!o.report.empty()) {
        const std::size_t reached = distance.reached();
        writeDocument(o.report,
                      reportJson(report, *distance.marched(),
                                 {distance.band().size(), reached, distance.extent().maxDistance}));
        report.outputs.emplace_back("report", o.report);
    }
    return {tell(report, distance, o, console), report.warnings,
            provenanceJson(report, *distance.marched())};
}
