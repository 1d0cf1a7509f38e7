#include "run.h"

#include <igeo/band/surface_point.h>
#include <igeo/base/detail/format.h>
#include <igeo/base/error.h>
#include <igeo/base/parallel.h>
#include <igeo/io/point_list.h>
#include <igeo/march/godunov.h>
#include <igeo/march/jet.h>
#include <igeo/path/accuracy_estimate.h>
#include <igeo/path/exponential_map.h>
#include <igeo/path/straighten.h>
#include <igeo/path/trace.h>
#include <igeo/results/farthest_points.h>
#include <igeo/results/pair_distances.h>
#include <igeo/results/report.h>

#include <algorithm>
#include <memory>

#include "exit_code.h"
#include "guarded_read.h"
#include "metric_input.h"
#include "output_files.h"
#include "outputs.h"
#include "process.h"
#include "seed_input.h"
#include "stages.h"
#include "surface_input.h"
#include "usage_error.h"

using igeo::format;
using igeo::Vec3d;

namespace {

std::string text(const Vec3d& p) { return format("%.9g,%.9g,%.9g", p.x, p.y, p.z); }

/// A job on a surface: what its stages hand on.
class Job {
public:
    Job(const SurfaceInput& surface, MetricInput& metric, const RunOptions& options,
        Console& console, ConsoleProgress& progress, Stages stages)
        : surface_(surface),
          metricInput_(metric),
          options_(options),
          console_(console),
          progress_(progress),
          stages_(std::move(stages)),
          outputs_(options),
          report_(surface.report()) {}
    int run();

private:
    void solve();
    std::vector<igeo::Ball> regionWithin(double distance) const;
    const igeo::Band& band() const { return *band_; }
    void makeBand(const std::vector<igeo::Ball>& region);
    void snapPoints();
    void makeMetric();
    void addSeeds();
    void march(double maxDistance);
    void trace();
    void estimateAccuracy();
    void shoot();
    void solvePairs();
    void writeResults();
    int summarize();

    Vec3d indexOf(const Vec3d& p) const {
        return options_.indexSpace() ? p : surface_.transform().indexFromWorld(p);
    }
    std::vector<igeo::SurfacePoint> snapped(const std::vector<igeo::AskedPoint>& asked) const;
    bool tooFar(const igeo::SurfacePoint& p) const {
        return p.snapDistance * band().transform.dx > report_.snap * (1 + 1e-6);
    }
    void tell(const igeo::SurfacePoint& p, const Vec3d& asked, const std::string& what);
    void refuseBlocked(const std::vector<igeo::SurfacePoint>& points, const char* what) const;
    void finished(const char* stage) { stages_.finished(stage); }

    const SurfaceInput& surface_;
    MetricInput& metricInput_;
    const RunOptions& options_;
    Console& console_;
    ConsoleProgress& progress_;
    Stages stages_;
    Outputs outputs_;

    SeedInput seedInput_;
    std::vector<igeo::AskedPoint> askedTargets_;
    /// Never changed once made: it may be everybody's.
    SurfaceInput::BandPtr band_ = std::make_shared<igeo::Band>();
    bool wholeBand_ = false;
    igeo::MetricPtr metric_;  ///< null: Euclidean
    std::vector<igeo::SurfacePoint> seeds_, targets_;
    igeo::Field field_;
    igeo::RunReport report_;
};

void Job::makeBand(const std::vector<igeo::Ball>& region) {
    if (region.empty()) surface_.requireMemory(options_.memoryLimit);
    band_ = surface_.band(region, progress_);
    wholeBand_ = region.empty();
    console_.detail(format("band: h = %.6g (%.4g voxels), %.0f nodes",
                           band().h * band().transform.dx, band().h, double(band().size())) +
                    (wholeBand_ ? "" : ", not of the whole surface"));
    const std::string unreliable = wholeBand_ ? surface_.unreliableShare(band()) : "";
    if (!unreliable.empty()) report_.warnings.push_back(unreliable);
    finished("band");
}

std::vector<igeo::SurfacePoint> Job::snapped(const std::vector<igeo::AskedPoint>& asked) const {
    std::vector<igeo::SurfacePoint> points;
    for (const igeo::AskedPoint& p : asked) {
        points.push_back(surface_.nearest(band(), indexOf(p.position)));
        points.back().start = p.start / band().transform.dx;
    }
    return points;
}

void Job::snapPoints() {
    seeds_ = snapped(seedInput_.points());
    targets_ = snapped(askedTargets_);
}

/// Where a point is now; refuses one that was too far from the surface.
void Job::tell(const igeo::SurfacePoint& p, const Vec3d& asked, const std::string& what) {
    const igeo::Similarity& t = band().transform;
    const std::string place = text(t.worldFromIndex(p.pIndex));
    if (tooFar(p))
        usageError(what + " (" + text(asked) + ") is " +
                       format("%.6g from the surface, %.6g is allowed", p.snapDistance * t.dx,
                              report_.snap),
                   "the nearest point of the surface is " + place +
                       " (world); move it there or raise --snap");
    console_.detail(what + ": " + place + format(", moved %.3g", p.snapDistance * t.dx));
}

void Job::refuseBlocked(const std::vector<igeo::SurfacePoint>& points, const char* what) const {
    for (std::size_t k = 0; k < points.size(); ++k) {
        const Vec3d& p = points[k].pIndex;
        if (metric_->blocked(p, p, Vec3d(band().normal[points[k].node])))
            usageError(std::string(what) + " " + std::to_string(k) + " (" +
                           text(band().transform.worldFromIndex(p)) + ") lies inside an obstacle",
                       "move it, or leave the obstacle out");
    }
}

void Job::makeMetric() {
    metric_ =
        wholeBand_ ? metricInput_.onWhole(band(), progress_) : metricInput_.on(band(), progress_);
    if (!metric_) return;
    refuseBlocked(seeds_, "seed");
    refuseBlocked(targets_, "target");
    console_.detail(format("metric: weights from %.4g to %.4g, %.0f nodes blocked",
                           metric_->least(), metric_->largest(), double(metric_->insideCount())));
    finished("metric");
}

/// Where a march up to `distance` (voxels times weight) from the seeds can come, and where targets
/// are looked for: no path is shorter than the straight line at the least weight. Empty:
/// everywhere.
std::vector<igeo::Ball> Job::regionWithin(double distance) const {
    // What a march looks at beyond its limit: its margin, the start discs, the band, its cells; and
    // a scheme may be some percent short.
    constexpr double kBeyond = 16, kShort = 1.1;
    // Every leaf is held against every ball: for many points the whole surface is cheaper.
    constexpr std::size_t kMany = 200;
    const std::vector<igeo::AskedPoint>& seeds = seedInput_.points();
    if (!(distance < igeo::kInfinity) || seeds.size() + askedTargets_.size() > kMany ||
        metricInput_.needsWholeSurface() || seedInput_.extended() || options_.sample > 0)
        return {};
    const double radius = std::max(distance, 0.0) / metricInput_.leastWeight();
    const double snap = report_.snap / surface_.transform().dx;
    std::vector<igeo::Ball> region;
    for (const igeo::AskedPoint& p : seeds)
        region.push_back({indexOf(p.position), snap + kShort * radius + kBeyond});
    for (const igeo::AskedPoint& p : askedTargets_)
        region.push_back({indexOf(p.position), snap + kBeyond});
    return region;
}

/// Band, points and march. What stays near the seeds never sees the rest of the surface.
void Job::solve() {
    const std::vector<igeo::AskedPoint>& askedSeeds = seedInput_.points();
    const double dx = surface_.transform().dx;
    double limit = igeo::kInfinity;
    if (options_.maxDistance > 0) {
        report_.maxDistance = options_.maxDistance;
        limit = options_.maxDistance / dx;
    }
    // How far targets are is not known: a reach that doubles until all are found, at no more than
    // twice the cost of the last.
    double reach = limit;
    if (options_.stopAtTargets) {
        double farthest = 0;
        for (const igeo::AskedPoint& t : askedTargets_) {
            double nearest = igeo::kInfinity;
            for (const igeo::AskedPoint& s : askedSeeds)
                nearest =
                    std::min(nearest, igeo::length(indexOf(t.position) - indexOf(s.position)));
            farthest = std::max(farthest, nearest);
        }
        reach = std::min(limit, std::max(1.5 * farthest, 16.0) * metricInput_.leastWeight());
    }
    const double half = 0.5 * surface_.diagonal() * metricInput_.leastWeight();
    while (true) {
        const auto region = reach > half ? std::vector<igeo::Ball>{} : regionWithin(reach);
        makeBand(region);
        const bool whole = wholeBand_;
        if (whole || band().size() > 0) snapPoints();
        auto isFar = [&](const igeo::SurfacePoint& p) { return tooFar(p); };
        if (!whole && (band().size() == 0 || std::any_of(seeds_.begin(), seeds_.end(), isFar) ||
                       std::any_of(targets_.begin(), targets_.end(), isFar))) {
            // For the message: the nearest point of the whole surface.
            makeBand({});
            snapPoints();
        }
        for (std::size_t k = 0; k < seeds_.size(); ++k)
            tell(seeds_[k], askedSeeds[k].position, "seed " + std::to_string(k));
        for (std::size_t k = 0; k < targets_.size(); ++k)
            tell(targets_[k], askedTargets_[k].position, "target " + std::to_string(k));
        finished("snap");
        makeMetric();
        addSeeds();
        march(whole ? limit : reach);
        const bool found =
            std::all_of(targets_.begin(), targets_.end(), [&](const igeo::SurfacePoint& t) {
                return igeo::sampleDistance(band(), field_, t.pIndex) < igeo::kInfinity;
            });
        if (whole || reach >= limit || found) break;
        reach = std::min(limit, 2 * reach);
    }
    seedInput_.finish(band(), field_);
}

/// Those of curves and regions, and samples.
void Job::addSeeds() {
    if (seedInput_.extended()) {
        for (const igeo::SurfacePoint& s :
             seedInput_.extendedSeeds(band(), report_.snap / band().transform.dx))
            seeds_.push_back(s);
        finished("seeds");
    }
    if (options_.sample == 0) return;
    for (const igeo::SurfacePoint& p :
         igeo::farthestPoints(band(), metric_, seeds_, std::size_t(options_.sample), progress_))
        seeds_.push_back(p);
    finished("sample");
}

void Job::march(double maxDistance) {
    const auto stopAt = options_.stopAtTargets ? targets_ : std::vector<igeo::SurfacePoint>{};
    if (options_.scheme == Scheme::Jet) {
        igeo::JetOptions jet;
        jet.maxDistance = maxDistance;
        jet.stopAt = stopAt;
        field_ = igeo::marchJet(band(), metric_, seeds_, jet, progress_);
    } else {
        igeo::GodunovOptions godunov;
        godunov.order = options_.order;
        godunov.maxDistance = maxDistance;
        godunov.stopAt = stopAt;
        field_ = igeo::marchGodunov(band(), metric_, seeds_, godunov, progress_);
    }
    finished("march");
}

void Job::trace() {
    const bool wantsAccuracy = options_.verbose || !options_.report.empty();
    if (targets_.empty() && !wantsAccuracy && !options_.needsGradient()) return;
    if (field_.gradient.empty()) field_.gradient = igeo::surfaceGradient(band(), field_);
    report_.paths = igeo::tracePaths(band(), field_, field_.gradient, targets_, {}, progress_);
    std::size_t done = 0;
    if (options_.straighten)
        for (igeo::Path& path : report_.paths) {
            igeo::straighten(band(), field_, path);
            progress_.update("straighten", double(++done) / double(report_.paths.size()));
        }
    finished("trace");
    if (wantsAccuracy) estimateAccuracy();
}

void Job::estimateAccuracy() {
    progress_.update("accuracy", 0);
    report_.accuracy = igeo::estimateAccuracy(band(), field_, field_.gradient);
    const igeo::AccuracyEstimate& a = report_.accuracy;
    if (a.samples)
        console_.detail(
            format("accuracy: distances differ from straightened geodesics by %.2g %% in "
                   "the mean of %.0f samples, %.2g %% at most",
                   100 * a.meanError, double(a.samples), 100 * a.largestError));
    finished("accuracy");
}

/// Walks straight on; on their own part of the surface where the band is of another.
void Job::shoot() {
    constexpr double kBeyond = 8;  // voxels that a step and its cells look at
    const igeo::Similarity& t = surface_.transform();
    for (const Shot& shot : options_.shots) {
        const std::string what = "--shoot " + shot.text;
        const Vec3d from = indexOf(shot.from);
        const double length = options_.indexSpace() ? shot.length : shot.length / t.dx;
        SurfaceInput::BandPtr around = band_;
        if (!wholeBand_) {
            around = surface_.band({{from, report_.snap / t.dx + length + kBeyond}}, progress_);
            if (around->size() == 0) around = surface_.band({}, progress_);
        }
        const igeo::SurfacePoint start = surface_.nearest(*around, from);
        tell(start, shot.from, what);
        try {
            report_.walks.push_back(
                igeo::shoot(*around, start, indexOf(shot.from + shot.direction) - from, length));
        } catch (const igeo::Error& e) {
            throw igeo::Error(e.kind(), what + ": " + e.what(), e.remedy());
        }
    }
    if (!options_.shots.empty()) finished("shoot");
}

void Job::solvePairs() {
    if (options_.pairs.empty()) return;
    std::vector<Vec3d> sources, targets;
    for (const igeo::AskedPair& pair :
         guardedRead(options_.pairs, [&] { return igeo::readPairs(options_.pairs); })) {
        sources.push_back(indexOf(pair.source));
        targets.push_back(indexOf(pair.target));
    }
    igeo::PairSurface surface;
    surface.band = [&](const auto& region, igeo::Progress& p) { return surface_.band(region, p); };
    surface.metric = [&](const auto& b, igeo::Progress& p) { return metricInput_.on(b, p); };
    surface.nearest = [&](const auto& b, const Vec3d& p) { return surface_.nearest(b, p); };
    surface.leastWeight = metricInput_.needsWholeSurface() ? 0 : metricInput_.leastWeight();
    surface.diagonal = surface_.diagonal();
    progress_.update("pairs", 0);
    report_.pairs = igeo::pairDistances(surface, sources, targets,
                                        report_.snap / surface_.transform().dx, progress_);
    finished("pairs");
}

void Job::writeResults() {
    const Result result{surface_, band(), field_, targets_, metricInput_, report_};
    if (options_.hasSeeds()) {
        outputs_.countCells(result, progress_);
        outputs_.writeVolume(result, progress_);
    }
    outputs_.writeDocuments(result, progress_);
    finished("write");

    report_.seconds = stages_.seconds();
    report_.peakMemory = peakMemory();
    report_.threads = igeo::ThreadLimit::current();
    if (!options_.report.empty())
        writeDocument(options_.report, igeo::reportJson(report_, band(), field_));
}

int Job::summarize() {
    const double dx = surface_.transform().dx;
    for (const std::string& w : report_.warnings) console_.warning(w);
    int code = kDone;
    for (std::size_t k = 0; k < report_.paths.size(); ++k) {
        const igeo::Path& p = report_.paths[k];
        const std::string name = "target " + std::to_string(k);
        if (p.status == igeo::PathStatus::Reached) {
            console_.info(name +
                          (field_.metric->weighted()
                               ? format(": distance %.6g, geodesic %.6g by the metric, %.6g "
                                        "long",
                                        p.distance * dx, p.weightedLength * dx, p.length * dx)
                               : format(": distance %.6g, geodesic %.6g long", p.distance * dx,
                                        p.weightedLength * dx)));
            continue;
        }
        code = kUnreached;
        console_.warning(name + " is " + igeo::toString(p.status) + ": " +
                         (p.status == igeo::PathStatus::Stalled
                              ? "no way down from the target was found"
                          : field_.stoppedEarly ? "it lies beyond the distance marched"
                                                : "no path on the surface joins it to a seed"));
    }
    for (std::size_t k = 0; k < report_.walks.size(); ++k) {
        const igeo::Path& walk = report_.walks[k];
        const igeo::Similarity& t = surface_.transform();
        const std::string said = "walk " + std::to_string(k) + ": " +
                                 format("%.6g long, ends at ", walk.length * t.dx) +
                                 text(t.worldFromIndex(walk.vertices.back().pIndex));
        if (walk.status == igeo::PathStatus::Reached)
            console_.info(said);
        else
            console_.warning(said + ", where the surface ends");
    }
    const auto lost =
        std::count_if(report_.pairs.begin(), report_.pairs.end(),
                      [](const igeo::PairDistance& p) { return !(p.distance < igeo::kInfinity); });
    if (!report_.pairs.empty())
        console_.info(std::to_string(report_.pairs.size()) + " pairs solved");
    if (lost > 0) {
        code = kUnreached;
        console_.warning("no path on the surface joins the points of " + std::to_string(lost) +
                         " pairs");
    }
    if (options_.hasSeeds())
        console_.info(format("distances up to %.6g on %.0f of %.0f band voxels in ",
                             field_.maxDistance * dx, double(field_.reached),
                             double(band().size())) +
                      distanceFile(options_, surface_.name()));
    return code;
}

int Job::run() {
    report_.snap = options_.snap.value_or(surface_.snap());
    seedInput_.read(options_, surface_.transform());
    askedTargets_ = askedPoints(options_.targets, options_.targetFile);
    metricInput_.read(surface_.transform());
    for (const auto* warnings : {&seedInput_.warnings(), &metricInput_.warnings()})
        report_.warnings.insert(report_.warnings.end(), warnings->begin(), warnings->end());
    report_.sources = seedInput_.names();
    report_.weights = metricInput_.weightNames();
    report_.obstacles = metricInput_.obstacleNames();
    progress_.update("band", 0);
    if (options_.hasSeeds()) {
        solve();
        trace();
    } else {
        // A picture shows all of the surface.
        if (!options_.image.empty()) makeBand({});
        if (!wholeBand_) {
            auto none = std::make_shared<igeo::Band>();
            none->transform = surface_.transform();
            none->h = surface_.h();
            band_ = none;
        }
        field_.distance.assign(band().size(), igeo::kInfinity);
        field_.scheme = nameOf(options_.scheme);
    }
    shoot();
    solvePairs();
    writeResults();
    return summarize();
}

}  // namespace

void checkRun(const RunOptions& options) { checkOutputFiles(options); }

int run(const RunOptions& options, Console& console, ConsoleProgress& progress) {
    checkRun(options);
    Stages stages(console, progress);
    const std::unique_ptr<SurfaceInput> surface = SurfaceInput::of(options);
    progress.update("read", 0);
    surface->read();
    stages.finished("read");
    surface->prepare(progress);
    console.detail("surface: " + surface->name() + format(", dx %.6g, ", surface->transform().dx) +
                   surface->summary());
    stages.finished("check");
    MetricInput metric(options);
    return Job(*surface, metric, options, console, progress, std::move(stages)).run();
}

int runOn(const SurfaceInput& surface, MetricInput& metric, const RunOptions& options,
          Console& console, ConsoleProgress& progress) {
    return Job(surface, metric, options, console, progress, Stages(console, progress)).run();
}
