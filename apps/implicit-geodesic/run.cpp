#include "run.h"

#include <igeo/accuracy.h>
#include <igeo/atomic_file.h>
#include <igeo/band_width.h>
#include <igeo/error.h>
#include <igeo/extend.h>
#include <igeo/field_grids.h>
#include <igeo/godunov.h>
#include <igeo/jet.h>
#include <igeo/level_set.h>
#include <igeo/level_set_band.h>
#include <igeo/parallel.h>
#include <igeo/point_file.h>
#include <igeo/report.h>
#include <igeo/sampling.h>
#include <igeo/straighten.h>
#include <igeo/surface_point.h>
#include <igeo/trace.h>
#include <igeo/vdb_io.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <iostream>

#include "metric_input.h"
#include "outputs.h"
#include "usage_error.h"

namespace fs = std::filesystem;
using igeo::Error;
using igeo::Vec3d;

namespace {

std::string text(const char* pattern, double a, double b = 0, double c = 0) {
    char buffer[256];
    std::snprintf(buffer, sizeof buffer, pattern, a, b, c);
    return buffer;
}

std::string text(const Vec3d& p) { return text("%.9g,%.9g,%.9g", p.x, p.y, p.z); }

bool endsWith(const std::string& s, const std::string& end) {
    return s.size() >= end.size() && s.compare(s.size() - end.size(), end.size(), end) == 0;
}

/// The current job: what the stages hand on, and what they cost.
class Job {
public:
    Job(const Options& options, Console& console, ConsoleProgress& progress)
        : options_(options), console_(console), progress_(progress) {}
    int run();

private:
    void checkOutputs();
    void readSurface();
    void readAskedPoints();
    void chooseBandWidth();
    void solve();
    std::vector<igeo::Ball> regionWithin(double distance) const;
    void makeBand(const std::vector<igeo::Ball>& region);
    void snapPoints();
    void makeMetric();
    void addSamples();
    void march(double maxDistance);
    void trace();
    void writeResults();
    int summarise();

    bool asked(const char* grid) const;  ///< by --with

    std::vector<igeo::AskedPoint> readPoints(const std::vector<std::string>& given,
                                             const std::string& file, const char* what) const;
    Vec3d indexOf(const igeo::AskedPoint& p) const;
    std::vector<igeo::SurfacePoint> snapped(const std::vector<igeo::AskedPoint>& asked) const;
    bool tooFar(const igeo::SurfacePoint& p) const;
    void tell(const std::vector<igeo::SurfacePoint>& points,
              const std::vector<igeo::AskedPoint>& asked, const char* what);
    void refuseBlocked(const std::vector<igeo::SurfacePoint>& points, const char* what) const;
    /// Ends a stage: its name, and the time since the last one ended.
    void finished(const char* stage);
    std::string outputName() const;

    const Options& options_;
    Console& console_;
    ConsoleProgress& progress_;
    std::chrono::steady_clock::time_point stageStart_ = std::chrono::steady_clock::now();

    igeo::GridSource source_;
    igeo::LevelSet surface_;
    double h_ = 0;  ///< half the band's thickness, voxels
    igeo::Band band_;
    MetricInput metricInput_;
    igeo::MetricPtr metric_;  ///< null: Euclidean
    std::vector<igeo::AskedPoint> askedSeeds_, askedTargets_;
    std::vector<igeo::SurfacePoint> seeds_, targets_;
    igeo::Field field_;
    igeo::RunReport report_;
};

void Job::finished(const char* stage) {
    const auto now = std::chrono::steady_clock::now();
    const double seconds = std::chrono::duration<double>(now - stageStart_).count();
    stageStart_ = now;
    const auto same = std::find_if(report_.seconds.begin(), report_.seconds.end(),
                                   [&](const auto& entry) { return entry.first == stage; });
    if (same == report_.seconds.end())
        report_.seconds.emplace_back(stage, seconds);
    else
        same->second += seconds;
    progress_.clear();
    console_.detail(std::string(stage) + text(": %.3f s", seconds));
}

std::string Job::outputName() const {
    if (!options_.output.empty()) return options_.output;
    const std::string stem =
        source_.file == "-" ? surface_.name : fs::path(source_.file).stem().string();
    return stem + "_geodesic.vdb";
}

/// Finds out before the work, not after it, that its results have nowhere to go.
void Job::checkOutputs() {
    source_ = igeo::parseGridSource(options_.sdf);
    std::vector<std::pair<const char*, std::string>> outputs;
    if (source_.file != "-" || !options_.output.empty()) outputs.push_back({"-o", outputName()});
    if (!options_.paths.empty()) outputs.push_back({"--paths", options_.paths});
    if (!options_.json.empty()) outputs.push_back({"--json", options_.json});
    if (!options_.meshOut.empty()) outputs.push_back({"--mesh-out", options_.meshOut});
    if (!options_.isolines.empty()) outputs.push_back({"--isolines", options_.isolines});
    if (!options_.matrix.empty()) outputs.push_back({"--matrix", options_.matrix});
    if (!options_.image.empty()) outputs.push_back({"--image", options_.image});

    std::vector<std::string> inputs{source_.file, options_.seedFile, options_.targetFile};
    for (const auto* list : {&options_.weights, &options_.obstacles})
        for (const std::string& given : *list) inputs.push_back(igeo::parseGridSource(given).file);
    if (!options_.metric.empty()) inputs.push_back(igeo::parseGridSource(options_.metric).file);
    if (std::count(inputs.begin(), inputs.end(), "-") > 1)
        usageError("standard input is named for " +
                       std::to_string(std::count(inputs.begin(), inputs.end(), "-")) +
                       " inputs, and can be read once",
                   "give the others as files");

    std::vector<std::string> taken;
    for (const auto& [option, file] : outputs) {
        const std::string named = std::string(option) + " " + file;
        std::error_code ignored;
        const std::string whole =
            file == "-" ? file : fs::weakly_canonical(fs::absolute(file), ignored).string();
        for (const std::string& input : inputs)
            if (input != "-" && file != "-" && fs::equivalent(file, input, ignored))
                usageError(named + " would overwrite the input '" + input + "'",
                           std::string("give ") + option + " another name");
        const bool device = fs::exists(file, ignored) && !fs::is_regular_file(file, ignored) &&
                            !fs::is_directory(file, ignored);
        if (!device && std::find(taken.begin(), taken.end(), whole) != taken.end())
            usageError(named + ": two results cannot go to one place", "give each its own name");
        taken.push_back(whole);
        if (file == "-" || device) continue;
        const fs::path folder =
            fs::path(file).parent_path().empty() ? "." : fs::path(file).parent_path();
        if (!fs::is_directory(folder, ignored))
            usageError(named + ": there is no folder '" + folder.string() + "'",
                       "create it first, or write elsewhere");
        if (fs::is_directory(file, ignored))
            usageError(named + ": that is a folder", "add a file name");
        const bool exists = fs::exists(file, ignored);
        if (::access(folder.c_str(), W_OK) != 0 || (exists && ::access(file.c_str(), W_OK) != 0))
            usageError(named + ": no permission to write there", "write elsewhere");
    }
    checkOutputOptions(options_);
}

void Job::readSurface() {
    igeo::LoadedGrid loaded = igeo::readLevelSetGrid(source_);
    finished("read");
    surface_ = igeo::checkLevelSet(std::move(loaded), progress_);
    report_.file = source_.file;
    report_.grid = surface_.name;
    report_.activeVoxels = surface_.stats.activeVoxels;
    report_.halfWidth = surface_.stats.halfWidth;
    report_.largestCurvature = surface_.stats.largestCurvature;
    const auto& st = surface_.stats;
    console_.detail("surface: " + surface_.name + text(", dx %.6g", surface_.transform.dx) +
                    text(", half-width %.4g voxels, radius of curvature at least %.4g voxels",
                         st.halfWidth, 1 / st.largestCurvature));
    finished("check");
}

void Job::chooseBandWidth() {
    const auto& st = surface_.stats;
    const double dx = surface_.transform.dx;
    const igeo::BandBounds bounds = igeo::bandBounds(st.largestCurvature, st.reach, st.halfWidth);
    report_.bandLower = bounds.lower;
    report_.bandUpper = bounds.upper;
    // jet works on foot points, for which the narrowest band is enough.
    h_ = options_.scheme == "jet"
             ? bounds.lower
             : igeo::defaultBandWidth(options_.order, st.largestCurvature, bounds);
    if (options_.band > 0) h_ = igeo::requireBandWidth(options_.band / dx, bounds, dx);
    if (options_.bandVoxels > 0) h_ = igeo::requireBandWidth(options_.bandVoxels, bounds, dx);
    if (!bounds.resolved)
        surface_.warnings.push_back(
            "in places the surface bends or folds within " + text("%.2g voxels", bounds.lower) +
            ", less than the grid resolves: distances are less accurate there than elsewhere");
    igeo::widen(surface_, h_);
}

void Job::makeBand(const std::vector<igeo::Ball>& region) {
    band_ = igeo::bandFromLevelSet(surface_, h_, region, progress_);
    console_.detail(text("band: h = %.6g (%.4g voxels), %.0f nodes", h_ * surface_.transform.dx, h_,
                         double(band_.size())) +
                    (region.empty() ? "" : " near the seeds"));
    finished("band");
}

std::vector<igeo::AskedPoint> Job::readPoints(const std::vector<std::string>& given,
                                              const std::string& file, const char* what) const {
    std::vector<igeo::AskedPoint> points;
    for (const std::string& s : given) {
        try {
            points.push_back(igeo::parsePoint(s));
        } catch (const Error& e) {
            throw Error(e.kind(), std::string("--") + what + ": " + e.what(), e.remedy());
        }
    }
    if (!file.empty())
        for (const igeo::AskedPoint& p : igeo::readPoints(file)) points.push_back(p);
    return points;
}

void Job::readAskedPoints() {
    askedSeeds_ = readPoints(options_.seeds, options_.seedFile, "seed");
    askedTargets_ = readPoints(options_.targets, options_.targetFile, "target");
}

Vec3d Job::indexOf(const igeo::AskedPoint& p) const {
    return options_.indexSpace ? p.position : surface_.transform.indexFromWorld(p.position);
}

std::vector<igeo::SurfacePoint> Job::snapped(const std::vector<igeo::AskedPoint>& asked) const {
    std::vector<igeo::SurfacePoint> points;
    for (const igeo::AskedPoint& p : asked) {
        points.push_back(igeo::nearestSurfacePoint(band_, indexOf(p)));
        points.back().start = p.start / band_.transform.dx;
    }
    return points;
}

bool Job::tooFar(const igeo::SurfacePoint& p) const {
    return p.snapDistance * band_.transform.dx > report_.snap * (1 + 1e-6);
}

void Job::snapPoints() {
    seeds_ = snapped(askedSeeds_);
    targets_ = snapped(askedTargets_);
}

/// Where the points are now; refuses those that were too far from the surface.
void Job::tell(const std::vector<igeo::SurfacePoint>& points,
               const std::vector<igeo::AskedPoint>& asked, const char* what) {
    const igeo::Similarity& t = band_.transform;
    for (std::size_t k = 0; k < points.size(); ++k) {
        const igeo::SurfacePoint& p = points[k];
        if (tooFar(p))
            usageError(std::string(what) + " " + std::to_string(k) + " (" +
                           text(asked[k].position) + ") is " +
                           text("%.6g from the surface, %.6g is allowed", p.snapDistance * t.dx,
                                report_.snap),
                       "the nearest point of the surface is " + text(t.worldFromIndex(p.pIndex)) +
                           " (world); move it there or raise --snap");
        console_.detail(std::string(what) + " " + std::to_string(k) + ": " +
                        text(t.worldFromIndex(p.pIndex)) +
                        text(", moved %.3g", p.snapDistance * t.dx));
    }
}

void Job::refuseBlocked(const std::vector<igeo::SurfacePoint>& points, const char* what) const {
    for (std::size_t k = 0; k < points.size(); ++k) {
        const Vec3d& p = points[k].pIndex;
        if (metric_->blocked(p, p, Vec3d(band_.normal[points[k].node])))
            usageError(std::string(what) + " " + std::to_string(k) + " (" +
                           text(band_.transform.worldFromIndex(p)) + ") lies inside an obstacle",
                       "move it, or leave the obstacle out");
    }
}

void Job::makeMetric() {
    metric_ = metricInput_.on(band_, progress_);
    if (!metric_) return;
    refuseBlocked(seeds_, "seed");
    refuseBlocked(targets_, "target");
    console_.detail(text("metric: weights from %.4g to %.4g, %.0f nodes blocked", metric_->least(),
                         metric_->largest(), double(metric_->insideCount())));
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
    if (!(distance < igeo::kInfinity) || askedSeeds_.size() + askedTargets_.size() > kMany ||
        metricInput_.needsWholeSurface() || options_.sample > 0)
        return {};
    const double radius = std::max(distance, 0.0) / metricInput_.leastWeight();
    const double snap = report_.snap / surface_.transform.dx;
    std::vector<igeo::Ball> region;
    for (const igeo::AskedPoint& p : askedSeeds_)
        region.push_back({indexOf(p), snap + kShort * radius + kBeyond});
    for (const igeo::AskedPoint& p : askedTargets_) region.push_back({indexOf(p), snap + kBeyond});
    return region;
}

/// Band, points and march. What stays near the seeds never sees the rest of the surface.
void Job::solve() {
    const double dx = surface_.transform.dx;
    report_.snap = options_.snap >= 0 ? options_.snap : report_.halfWidth * dx;
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
            for (const igeo::AskedPoint& s : askedSeeds_)
                nearest = std::min(nearest, igeo::length(indexOf(t) - indexOf(s)));
            farthest = std::max(farthest, nearest);
        }
        reach = std::min(limit, std::max(1.5 * farthest, 16.0) * metricInput_.leastWeight());
    }
    const auto box = surface_.psi->evalActiveVoxelBoundingBox().dim();
    const double diagonal = std::sqrt(box.asVec3d().lengthSqr());
    while (true) {
        const auto region = reach > 0.5 * diagonal * metricInput_.leastWeight()
                                ? std::vector<igeo::Ball>{}
                                : regionWithin(reach);
        const bool whole = region.empty();
        makeBand(region);
        if (whole || band_.size() > 0) snapPoints();
        auto far = [&](const igeo::SurfacePoint& p) { return tooFar(p); };
        if (!whole && (band_.size() == 0 || std::any_of(seeds_.begin(), seeds_.end(), far) ||
                       std::any_of(targets_.begin(), targets_.end(), far))) {
            // For the message: the nearest point of the whole surface.
            makeBand({});
            snapPoints();
        }
        tell(seeds_, askedSeeds_, "seed");
        tell(targets_, askedTargets_, "target");
        finished("snap");
        makeMetric();
        addSamples();
        march(whole ? limit : reach);
        const bool found =
            std::all_of(targets_.begin(), targets_.end(), [&](const igeo::SurfacePoint& t) {
                return igeo::sampleDistance(band_, field_, t.pIndex) < igeo::kInfinity;
            });
        if (whole || reach >= limit || found) return;
        reach = std::min(limit, 2 * reach);
    }
}

void Job::addSamples() {
    if (options_.sample == 0) return;
    const auto count = std::size_t(options_.sample);
    for (const igeo::SurfacePoint& p :
         igeo::farthestPoints(band_, metric_, seeds_, count, progress_))
        seeds_.push_back(p);
    finished("sample");
}

void Job::march(double maxDistance) {
    const auto stopAt = options_.stopAtTargets ? targets_ : std::vector<igeo::SurfacePoint>{};
    if (options_.scheme == "jet") {
        igeo::JetOptions jet;
        jet.maxDistance = maxDistance;
        jet.stopAt = stopAt;
        field_ = igeo::marchJet(band_, metric_, seeds_, jet, progress_);
    } else {
        igeo::GodunovOptions godunov;
        godunov.order = options_.order;
        godunov.maxDistance = maxDistance;
        godunov.stopAt = stopAt;
        field_ = igeo::marchGodunov(band_, metric_, seeds_, godunov, progress_);
    }
    finished("march");
}

void Job::trace() {
    const bool wantsAccuracy = options_.verbose || !options_.json.empty();
    if (targets_.empty() && !wantsAccuracy && !asked("gradient") && !options_.needsGradient())
        return;
    if (field_.gradient.empty()) field_.gradient = igeo::surfaceGradient(band_, field_);
    report_.paths = igeo::tracePaths(band_, field_, field_.gradient, targets_, {}, progress_);
    if (options_.straighten)
        for (igeo::Path& path : report_.paths) igeo::straighten(band_, field_, path);
    finished("trace");
    if (!wantsAccuracy) return;
    report_.accuracy = igeo::estimateAccuracy(band_, field_, field_.gradient);
    const igeo::AccuracyEstimate& a = report_.accuracy;
    if (a.samples)
        console_.detail(
            text("accuracy: distances differ from straightened geodesics by %.2g %% in "
                 "the mean of %.0f samples, %.2g %% at most",
                 100 * a.meanError, double(a.samples), 100 * a.largestError));
    finished("accuracy");
}

bool Job::asked(const char* grid) const {
    return std::count(options_.with.begin(), options_.with.end(), grid) > 0;
}

void Job::writeResults() {
    const std::string output = outputName();
    const auto& transform = surface_.psi->transform();
    const std::string base =
        options_.name.empty() ? surface_.psi->getName() + "_geodesic" : options_.name;

    openvdb::GridCPtrVec grids;
    if (asked("surface")) grids.push_back(surface_.psi);
    auto distance = igeo::distanceGrid(band_, field_, transform, base);
    const double dx = band_.transform.dx;
    distance->insertMeta("geodesic_scheme", openvdb::StringMetadata(field_.scheme));
    distance->insertMeta("geodesic_band", openvdb::FloatMetadata(float(band_.h * dx)));
    distance->insertMeta("geodesic_seed_count", openvdb::Int32Metadata(int(seeds_.size())));
    distance->insertMeta("geodesic_max", openvdb::FloatMetadata(float(field_.maxDistance * dx)));
    distance->insertMeta("geodesic_unreached",
                         openvdb::Int64Metadata(std::int64_t(band_.size() - field_.reached)));
    std::string weight;
    for (const std::string& name : metricInput_.weightNames())
        weight += (weight.empty() ? "" : " * ") + name;
    distance->insertMeta("geodesic_weight", openvdb::StringMetadata(weight.empty() ? "1" : weight));
    if (options_.extend) igeo::extendDistance(*distance, surface_, band_, field_);
    grids.push_back(distance);
    const Result result{surface_, band_, field_, targets_, metricInput_, report_};
    for (const auto& grid : extraGrids(options_, result, base, progress_)) grids.push_back(grid);
    progress_.throwIfCancelled();
    igeo::writeVdb(output, grids);
    report_.outputs.emplace_back("distance", output);

    auto write = [&](const std::string& file, const std::string& content) {
        if (file == "-")
            std::cout << content << std::flush;
        else
            igeo::writeFile(file, content);
        if (!std::cout) igeo::AtomicFile::throwWriteError("standard output", errno);
    };
    if (!options_.paths.empty()) {
        const bool obj = endsWith(options_.paths, ".obj");
        write(options_.paths, obj ? igeo::geodesicsObj(report_.paths, band_)
                                  : igeo::geodesicsJson(report_, band_, field_));
        report_.outputs.emplace_back("paths", options_.paths);
    }
    for (const Document& document : documents(options_, result, progress_)) {
        write(document.file, document.content);
        report_.outputs.emplace_back(document.kind, document.file);
    }
    writeImage(options_, result, progress_);
    if (!options_.image.empty()) report_.outputs.emplace_back("image", options_.image);
    finished("write");

    for (const std::string& w : surface_.warnings) report_.warnings.push_back(w);
    rusage usage{};
    ::getrusage(RUSAGE_SELF, &usage);
    report_.peakMemory = std::uint64_t(usage.ru_maxrss) * 1024;
    report_.threads = igeo::ThreadLimit::current();
    if (!options_.json.empty()) write(options_.json, igeo::reportJson(report_, band_, field_));
}

int Job::summarise() {
    const double dx = band_.transform.dx;
    for (const std::string& w : surface_.warnings) console_.warning(w);
    int code = kDone;
    for (std::size_t k = 0; k < report_.paths.size(); ++k) {
        const igeo::Path& p = report_.paths[k];
        const std::string name = "target " + std::to_string(k);
        if (p.status == igeo::PathStatus::Reached) {
            console_.info(name + (field_.metric->weighted()
                                      ? text(": distance %.6g, geodesic %.6g by the metric, %.6g "
                                             "long",
                                             p.distance * dx, p.length * dx, p.arcLength * dx)
                                      : text(": distance %.6g, geodesic %.6g long", p.distance * dx,
                                             p.length * dx)));
            continue;
        }
        code = kUnreached;
        console_.warning(name + " is " + igeo::toString(p.status) + ": " +
                         (p.status == igeo::PathStatus::Stalled
                              ? "no way down from the target was found"
                          : field_.stoppedEarly ? "it lies beyond the distance marched"
                                                : "no path on the surface joins it to a seed"));
    }
    console_.info(text("distances up to %.6g on %.0f of %.0f band voxels in ",
                       field_.maxDistance * dx, double(field_.reached), double(band_.size())) +
                  outputName());
    return code;
}

int Job::run() {
    if (options_.seeds.empty() && options_.seedFile.empty() && options_.sample == 0)
        usageError("no seed is given", "add --seed x,y,z, --seeds FILE or --sample K");
    checkOutputs();
    readSurface();
    readAskedPoints();
    metricInput_.read(options_, surface_.transform);
    report_.weights = metricInput_.weightNames();
    report_.obstacles = metricInput_.obstacleNames();
    chooseBandWidth();
    solve();
    trace();
    writeResults();
    return summarise();
}

}  // namespace

int run(const Options& options, Console& console, ConsoleProgress& progress) {
    return Job(options, console, progress).run();
}
