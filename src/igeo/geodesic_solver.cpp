#include <igeo/geodesic_solver.h>

#include <fmt/core.h>
#include <igeo/band/detail/snap.h>
#include <igeo/base/detail/box.h>
#include <igeo/base/detail/text.h>
#include <igeo/base/error.h>
#include <igeo/base/parallel.h>
#include <igeo/march/godunov.h>
#include <igeo/march/jet.h>
#include <igeo/march/local_search.h>
#include <igeo/march/signed_field.h>
#include <igeo/results/farthest_points.h>

#include <algorithm>
#include <mutex>
#include <optional>

namespace igeo {

namespace {
using Kind = Error::Kind;
}

struct GeodesicSolver::Setup {
    Setup(Surface s, SolverOptions o, Progress& progress)
        : surface(std::move(s)),
          options(std::move(o)),
          width(igeo::bandWidth(surface, options, progress)),
          leastWeight(igeo::leastWeight(options.metric)),
          needsWholeSurface(igeo::needsWholeSurface(options.metric) || !(leastWeight > 0)) {
        follow(options.rules);
    }

    const Surface surface;
    SolverOptions options;
    const BandWidth width;
    const double leastWeight;
    const bool needsWholeSurface;  ///< for the metric
    double maxSnap = 0;

    /// Copies of a solver share what the first query makes; concurrent queries wait for it.
    struct Cache {
        std::mutex mutex;
        std::optional<MetricPtr> wholeMetric;
        std::size_t wholeMarches = 0;
        std::shared_ptr<const Band> ofCore;
        JetCorePtr wholeCore;
        const std::shared_ptr<CostWarnings> wholeCosts = std::make_shared<CostWarnings>();
    };
    std::shared_ptr<Cache> cache = std::make_shared<Cache>();

    void follow(const QueryRules& rules) {
        options.rules = rules;
        maxSnap = rules.maxSnap >= 0 ? rules.maxSnap : surface.facts().snap;
    }
    const Similarity& transform() const { return surface.transform(); }
    Vec3d indexOf(const Vec3d& p) const {
        return options.rules.space == Space::Index ? p : transform().indexFromWorld(p);
    }
    double snapVoxels() const { return maxSnap / transform().dx; }
    bool tooFar(const SurfacePoint& p) const { return !isNear(p, transform(), maxSnap); }
    void requireNear(const SurfacePoint& p, const Band& band, const Vec3d& asked,
                     const std::string& what) const {
        if (tooFar(p))
            refuseFar(p, transform(), maxSnap, what + " (" + textOf(asked, 9) + ")",
                      boxOf(band) + hintFor(band, asked, p));
    }
    static std::string boxOf(const Band& band);
    std::string hintFor(const Band& band, const Vec3d& asked, const SurfacePoint& asGiven) const;
    std::shared_ptr<const Band> wholeBand(Progress& progress) const {
        surface.requireMemory(width, options.rules.memoryLimit);
        return surface.band(width, {}, progress);
    }
    /// The metric of the whole band is made once.
    MetricPtr metricOf(const Band& band, bool whole, Progress& progress) const {
        if (!whole) return metricOn(options.metric, band, progress);
        const std::lock_guard<std::mutex> lock(cache->mutex);
        if (!cache->wholeMetric) cache->wholeMetric = metricOn(options.metric, band, progress);
        return *cache->wholeMetric;
    }
    /// The part that marches on the whole band share; made for the second march, because most
    /// solvers do only one and the memory is then wasted. Null for the first.
    JetCorePtr coreOf(const std::shared_ptr<const Band>& band, const MetricPtr& metric) const {
        const std::lock_guard<std::mutex> lock(cache->mutex);
        if (cache->wholeMarches++ > 0 && cache->ofCore != band) {
            cache->wholeCore = jetCore(*band, metric);
            cache->ofCore = band;
        }
        return cache->wholeCore;
    }
};

/// The bounding box of the surface in world space, for messages.
std::string GeodesicSolver::Setup::boxOf(const Band& band) {
    Box box;
    for (NodeIndex i = 0; i < band.size(); ++i)
        box.include(band.transform.worldFromIndex(band.footPoint(i)));
    return "; the surface lies between " + textOf(box.low) + " and " + textOf(box.high);
}

/// A hint for the most common mistakes with coordinates, where correcting one puts the point on the
/// surface.
std::string GeodesicSolver::Setup::hintFor(const Band& band, const Vec3d& asked,
                                           const SurfacePoint& asGiven) const {
    auto isOn = [&](const Vec3d& pIndex, const auto& isNearer) {
        return length(pIndex) < kFarthestIndex && isNearer(surface.nearest(band, pIndex));
    };
    auto isInOther = [&](const SurfacePoint& p) { return isInOtherSpace(asGiven, p); };
    if (options.rules.space == Space::Index)
        return isOn(transform().indexFromWorld(asked), isInOther)
                   ? "; as a point of the world it is on the surface: Space::World"
                   : "";
    if (isOn(asked, isInOther)) return "; as index coordinates it is on the surface: Space::Index";
    // A small factor brings any point to a surface that passes through the origin.
    constexpr double kFromOrigin = 10;  // voxels
    for (const double factor : {1000.0, 0.001, 100.0, 0.01, 25.4, 1 / 25.4})
        if (length(factor * asked) > kFromOrigin * transform().dx &&
            isOn(transform().indexFromWorld(factor * asked),
                 [&](const SurfacePoint& p) { return !tooFar(p); }))
            return fmt::format("; times {:.4g} it is on the surface: are its units the same?",
                               factor);
    return "";
}

namespace {

/// One query: its points, its band, and the march.
class Query {
public:
    Query(const GeodesicSolver::Setup& setup, const Seeds& seeds, const MarchLimits& limits,
          Progress& progress)
        : setup_(setup), asked_(seeds), limits_(limits), progress_(progress) {
        for (std::size_t k = 0; k < seeds.points.size(); ++k)
            points_.push_back({seeds.points[k], "seed " + std::to_string(k), false});
        for (std::size_t g = 0; g < seeds.groups.size(); ++g) addGroup(seeds.groups[g], g);
    }
    Distance solve(const Surface& surface);

private:
    /// A point of a source.
    struct AskedPoint {
        Seed seed;
        std::string name;  ///< for messages
        bool joined;       ///< belongs to the same group as the one before
    };

    void addGroup(const SeedGroup& group, std::size_t number);
    const Band& band() const { return *band_; }
    double firstReach(double limit) const;
    std::vector<Ball> regionWithin(double reach) const;
    void makeBand(const std::vector<Ball>& region);
    void snapPoints();
    bool anyTooFar() const;
    void requireNearPoints();
    void makeMetric();
    void requireFree(const SurfacePoint& p, const std::string& what) const;
    void addCurvesAndRegions();
    std::string nameOf(const char* what, std::size_t number, std::size_t place) const {
        return place < asked_.names.size() ? asked_.names[place]
                                           : what + (" " + std::to_string(number));
    }
    void addSamples();
    void march(double maxDistance);
    bool allFound() const;
    void requireStartWithin(double limit) const;

    const GeodesicSolver::Setup& setup_;
    const Seeds& asked_;
    const MarchLimits& limits_;
    Progress& progress_;
    std::vector<AskedPoint> points_;
    std::shared_ptr<const Band> band_;
    bool whole_ = false;
    MetricPtr metric_;
    std::vector<SurfacePoint> seeds_, targets_;
    Field field_;
};

void Query::addGroup(const SeedGroup& group, std::size_t number) {
    const std::string name =
        "group " + (group.name.empty() ? std::to_string(number) : "'" + group.name + "'");
    if (group.points.empty())
        throw Error(Kind::InvalidArgument, name + " has no points", "give it one, or leave it out");
    for (std::size_t k = 0; k < group.points.size(); ++k)
        points_.push_back({group.points[k], "seed " + std::to_string(k) + " of " + name, k > 0});
}

/// The reach of the first march: the limit, or an estimate of the distance to the farthest target.
double Query::firstReach(double limit) const {
    if (!limits_.stopAtTargets) return limit;
    double farthest = 0;
    for (const Vec3d& target : limits_.targets) {
        double nearest = kInfinity;
        for (const AskedPoint& p : points_)
            nearest =
                std::min(nearest, length(setup_.indexOf(target) - setup_.indexOf(p.seed.position)));
        farthest = std::max(farthest, nearest);
    }
    return std::min(limit, std::max(1.5 * farthest, 16.0) * setup_.leastWeight);
}

/// The balls that a march up to `reach` (voxels times weight) from the seeds visits, and those
/// around targets: no path is shorter than the straight line at the least weight. Empty: the whole
/// surface.
std::vector<Ball> Query::regionWithin(double reach) const {
    // A march reads voxels beyond its limit: its margin, the start discs, the band, its cells. Its
    // distances may be some percent short.
    constexpr double kBeyond = 16, kShort = 1.1;
    // Every leaf is compared with every ball: for many points the whole surface is cheaper.
    constexpr std::size_t kMany = 200;
    if (!(reach < kInfinity) || points_.size() + limits_.targets.size() > kMany ||
        setup_.needsWholeSurface || asked_.extended() || asked_.samples > 0)
        return {};
    const double radius = std::max(reach, 0.0) / setup_.leastWeight;
    std::vector<Ball> region;
    for (const AskedPoint& p : points_)
        region.push_back(
            {setup_.indexOf(p.seed.position), setup_.snapVoxels() + kShort * radius + kBeyond});
    for (const Vec3d& target : limits_.targets)
        region.push_back({setup_.indexOf(target), setup_.snapVoxels() + kBeyond});
    return region;
}

void Query::makeBand(const std::vector<Ball>& region) {
    whole_ = region.empty();
    band_ =
        whole_ ? setup_.wholeBand(progress_) : setup_.surface.band(setup_.width, region, progress_);
    progress_.finished("band");
}

void Query::snapPoints() {
    auto snapAll = [&](std::size_t count, const auto& positionOf) {
        std::vector<SurfacePoint> snapped(count);
        parallelFor(count, 64, progress_, [&](std::size_t begin, std::size_t end) {
            for (std::size_t k = begin; k < end; ++k)
                snapped[k] = setup_.surface.nearest(band(), setup_.indexOf(positionOf(k)));
        });
        return snapped;
    };
    seeds_ = snapAll(points_.size(), [&](std::size_t k) { return points_[k].seed.position; });
    for (std::size_t k = 0; k < seeds_.size(); ++k) {
        seeds_[k].start = points_[k].seed.start / band().transform.dx;
        seeds_[k].joined = points_[k].joined;
    }
    targets_ = snapAll(limits_.targets.size(), [&](std::size_t k) { return limits_.targets[k]; });
}

bool Query::anyTooFar() const {
    auto isFar = [&](const SurfacePoint& p) { return setup_.tooFar(p); };
    return std::any_of(seeds_.begin(), seeds_.end(), isFar) ||
           std::any_of(targets_.begin(), targets_.end(), isFar);
}

void Query::requireNearPoints() {
    for (std::size_t k = 0; k < seeds_.size(); ++k)
        setup_.requireNear(seeds_[k], band(), points_[k].seed.position, points_[k].name);
    for (std::size_t k = 0; k < targets_.size(); ++k) {
        targets_[k].offSurface = setup_.options.rules.skipOffSurface && setup_.tooFar(targets_[k]);
        if (targets_[k].offSurface) continue;
        setup_.requireNear(targets_[k], band(), limits_.targets[k], "target " + std::to_string(k));
    }
}

void Query::requireFree(const SurfacePoint& p, const std::string& what) const {
    if (!metric_->blocked(p.pIndex, p.pIndex, Vec3d(band().normal[p.node]))) return;
    const Vec3d world = band().transform.worldFromIndex(p.pIndex);
    throw Error(Kind::InvalidArgument, what + " (" + textOf(world, 9) + ") lies inside an obstacle",
                "move it, or leave the obstacle out");
}

void Query::makeMetric() {
    metric_ = setup_.metricOf(band(), whole_, progress_);
    if (!metric_) return;
    for (std::size_t k = 0; k < seeds_.size(); ++k) requireFree(seeds_[k], points_[k].name);
    for (std::size_t k = 0; k < targets_.size(); ++k)
        if (!targets_[k].offSurface) requireFree(targets_[k], "target " + std::to_string(k));
    progress_.finished("metric");
}

void Query::addCurvesAndRegions() {
    if (!asked_.extended()) return;
    auto add = [&](const std::vector<SurfacePoint>& more, const std::string& name) {
        auto isBlocked = [&](const SurfacePoint& p) {
            return metric_ && metric_->blocked(p.pIndex, p.pIndex, Vec3d(band().normal[p.node]));
        };
        if (std::all_of(more.begin(), more.end(), isBlocked))
            throw Error(Kind::InvalidArgument, name + " lies inside obstacles",
                        "move it, or leave the obstacle out");
        seeds_.insert(seeds_.end(), more.begin(), more.end());
    };
    for (std::size_t k = 0; k < asked_.curves.size(); ++k) {
        Curve curve = asked_.curves[k];
        for (Vec3d& p : curve.points) p = setup_.indexOf(p);
        curve.start /= band().transform.dx;
        const std::string name = nameOf("seed curve", k, k);
        add(naming(name, [&] { return seedsAlong(band(), curve, setup_.snapVoxels(), progress_); }),
            name);
    }
    for (std::size_t k = 0; k < asked_.regions.size(); ++k) {
        const std::string name = nameOf("seed region", k, asked_.curves.size() + k);
        std::vector<SurfacePoint> rim = seedsAround(band(), *asked_.regions[k], progress_);
        if (rim.empty() && !asked_.isSigned)
            rim = seedWithin(band(), *asked_.regions[k], progress_);
        if (rim.empty())
            throw Error(Kind::InvalidArgument, name + ": its rim does not cross the surface",
                        "give a region that holds some voxels of the surface, and not all");
        add(rim, name);
    }
    progress_.finished("seeds");
}

void Query::addSamples() {
    if (asked_.samples == 0) return;
    for (const SurfacePoint& p : farthestPoints(band(), metric_, seeds_, asked_.samples, progress_))
        seeds_.push_back(p);
    progress_.finished("sample");
}

void Query::march(double maxDistance) {
    auto stopAt = limits_.stopAtTargets ? targets_ : std::vector<SurfacePoint>{};
    std::erase_if(stopAt, [](const SurfacePoint& p) { return p.offSurface; });
    if (setup_.options.scheme == Scheme::Jet) {
        JetOptions jet;
        jet.maxDistance = maxDistance;
        jet.stopAt = coreAround(band(), stopAt);
        // Signs and regions are set at the nodes.
        jet.extend = !asked_.regions.empty() || asked_.isSigned;
        const JetCorePtr core = whole_ ? setup_.coreOf(band_, metric_) : nullptr;
        field_ = core ? marchJet(core, seeds_, jet, progress_)
                      : marchJet(band(), metric_, seeds_, jet, progress_);
    } else {
        GodunovOptions godunov;
        godunov.order = setup_.options.order;
        godunov.maxDistance = maxDistance;
        godunov.stopAt = stopAt;
        field_ = marchGodunov(band(), metric_, seeds_, godunov, progress_);
    }
    progress_.finished("march");
}

bool Query::allFound() const {
    return std::all_of(targets_.begin(), targets_.end(), [&](const SurfacePoint& t) {
        return t.offSurface || sampleDistance(field_, t.pIndex) < kInfinity;
    });
}

void Query::requireStartWithin(double limit) const {
    if (points_.empty() || asked_.extended()) return;
    double least = kInfinity;
    for (const AskedPoint& p : points_) least = std::min(least, p.seed.start);
    if (least <= limit) return;
    throw Error(Kind::InvalidArgument,
                fmt::format("the first seed starts at {:.6g}, beyond the largest distance, {:.6g}",
                            least, limit),
                "give a larger limit, or smaller starts");
}

Distance Query::solve(const Surface& surface) {
    requireStartWithin(limits_.maxDistance);
    const double limit = limits_.maxDistance / setup_.transform().dx;
    auto solveOn = [&](const std::vector<Ball>& region, double maxDistance) {
        makeBand(region);
        if (band().size() > 0) snapPoints();
        // The message should name the nearest point of the whole surface.
        if (!whole_ && (band().size() == 0 || anyTooFar())) {
            makeBand({});
            snapPoints();
        }
        requireNearPoints();
        progress_.finished("snap");
        makeMetric();
        addCurvesAndRegions();
        addSamples();
        march(maxDistance);
    };
    const bool near =
        searchNear(firstReach(limit), limit, 0.5 * surface.facts().diagonal * setup_.leastWeight,
                   [&](double reach) {
                       const std::vector<Ball> region = regionWithin(reach);
                       solveOn(region, region.empty() ? limit : reach);
                       return region.empty() || allFound();
                   });
    if (!near) solveOn({}, limit);
    field_.greatest = limit;
    finishInside(asked_.regions, asked_.points.size() + asked_.groups.size() + asked_.curves.size(),
                 asked_.isSigned, field_, progress_);
    return Distance(surface, setup_.width, band_, whole_, std::move(field_), std::move(targets_),
                    setup_.maxSnap,
                    whole_ ? setup_.cache->wholeCosts : std::make_shared<CostWarnings>());
}

}  // namespace

BandWidth bandWidth(const Surface& surface, const SolverOptions& o, Progress& progress) {
    const double voxels = o.band > 0 ? o.band / surface.transform().dx : o.bandVoxels;
    return surface.bandWidth(o.scheme, o.order, voxels, progress);
}

GeodesicSolver::GeodesicSolver(Surface surface, SolverOptions options, Progress& progress)
    : setup_(std::make_shared<const Setup>(std::move(surface), std::move(options), progress)) {}

GeodesicSolver GeodesicSolver::with(const QueryRules& rules) const {
    const auto setup = std::make_shared<Setup>(*setup_);
    setup->follow(rules);
    GeodesicSolver other = *this;
    other.setup_ = setup;
    return other;
}

Distance GeodesicSolver::distance(const Seeds& seeds, const MarchLimits& limits,
                                  Progress& progress) const {
    seeds.requireUsable(setup_->transform().dx);
    return Query(*setup_, seeds, limits, progress).solve(setup_->surface);
}

Distance GeodesicSolver::unreached(bool whole, Progress& progress) const {
    std::shared_ptr<const Band> band;
    if (whole) {
        band = wholeBand(progress);
    } else {
        auto none = std::make_shared<Band>();
        none->transform = setup_->transform();
        none->h = setup_->width.h;
        band = none;
    }
    Field field;
    field.band = band.get();
    field.distance.assign(band->size(), kInfinity);
    field.scheme = toString(setup_->options.scheme);
    return Distance(setup_->surface, setup_->width, band, whole, std::move(field), {},
                    setup_->maxSnap);
}

const Surface& GeodesicSolver::surface() const { return setup_->surface; }
const SolverOptions& GeodesicSolver::options() const { return setup_->options; }
const BandWidth& GeodesicSolver::bandWidth() const { return setup_->width; }
double GeodesicSolver::maxSnap() const { return setup_->maxSnap; }
std::shared_ptr<const Band> GeodesicSolver::wholeBand(Progress& progress) const {
    return setup_->wholeBand(progress);
}
MetricPtr GeodesicSolver::wholeMetric(Progress& progress) const {
    return setup_->metricOf(*wholeBand(progress), true, progress);
}
std::vector<std::string> GeodesicSolver::costWarnings(Progress& progress) const {
    const MetricPtr metric = wholeMetric(progress);
    if (!metric) return {};
    return setup_->cache->wholeCosts->of(*wholeBand(progress), *metric,
                                         options().scheme == Scheme::Jet);
}
Vec3d GeodesicSolver::indexOf(const Vec3d& position) const { return setup_->indexOf(position); }
void GeodesicSolver::requireNear(const Vec3d& position, const std::string& what) const {
    const std::shared_ptr<const Band> whole = wholeBand();
    setup_->requireNear(surface().nearest(*whole, indexOf(position)), *whole, position, what);
}

}  // namespace igeo
