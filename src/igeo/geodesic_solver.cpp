#include <igeo/geodesic_solver.h>

#include <igeo/band/detail/snap.h>
#include <igeo/base/detail/box.h>
#include <igeo/base/detail/text.h>
#include <igeo/base/error.h>
#include <igeo/march/godunov.h>
#include <igeo/march/jet.h>
#include <igeo/march/local_search.h>
#include <igeo/march/signed_field.h>
#include <igeo/path/exponential_map.h>
#include <igeo/results/farthest_points.h>

#include <algorithm>
#include <mutex>
#include <optional>

namespace igeo {

namespace {

using Kind = Error::Kind;

/// A signed distance needs curves or regions, and nothing else.
void requireSigned(const Seeds& seeds) {
    if (!seeds.points.empty() || seeds.samples > 0 || seeds.curves.empty() == seeds.regions.empty())
        throw Error(Kind::InvalidArgument,
                    "a signed distance needs closed curves or regions, and seeds of one kind only",
                    "give either curves or regions, and no other seed");
}

/// Voxels: up to here double precision tells differences of 1e-4.
constexpr double kLatestStart = 1e12;

/// @param start  world units times weight
void requireStart(double start, double dx, const std::string& what) {
    if (start >= 0 && start / dx <= kLatestStart) return;
    throw Error(Kind::InvalidArgument,
                fmt::format("{} starts at {:.6g}; allowed are 0 to {:.4g}, 1e12 voxels", what,
                            start, kLatestStart * dx),
                "give a smaller start value, or leave out what starts so late");
}

void requireStarts(const Seeds& seeds, double dx) {
    for (std::size_t k = 0; k < seeds.points.size(); ++k)
        requireStart(seeds.points[k].start, dx, "seed " + std::to_string(k));
    for (std::size_t k = 0; k < seeds.curves.size(); ++k)
        requireStart(seeds.curves[k].start, dx, "seed curve " + std::to_string(k));
}

/// What the march's distance is yet to become: 0 inside regions, or signed.
void finishInside(const Seeds& seeds, Field& field, Progress& progress) {
    std::vector<std::uint8_t> any(seeds.regions.empty() ? 0 : field.band->size());
    for (std::size_t k = seeds.regions.size(); k-- > 0;) {
        const std::vector<std::uint8_t> inside =
            nodesInside(*field.band, *seeds.regions[k], progress);
        for (std::size_t i = 0; i < any.size(); ++i) any[i] |= inside[i];
        // Of regions that overlap the first counts, so it comes last.
        if (!seeds.isSigned)
            clearInside(inside, std::uint32_t(seeds.points.size() + seeds.curves.size() + k),
                        field);
    }
    if (!seeds.isSigned) return;
    if (seeds.regions.empty())
        field.sign = signsOfCurves(field, progress);
    else
        signInside(any, field);
}

}  // namespace

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

    /// Copies share what the first query makes; the others wait for it.
    struct Cache {
        std::mutex mutex;
        std::optional<MetricPtr> wholeMetric;
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
    /// Unit: what is given may be of any length.
    Vec3d indexDirectionOf(const Vec3d& v) const {
        const double most = std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
        if (!(most > 0 && most < kInfinity)) return {};
        const Vec3d d = normalized(Vec3d{v.x / most, v.y / most, v.z / most});
        if (options.rules.space == Space::Index) return d;
        const auto& axis = transform().axis;
        return {dot(axis[0], d), dot(axis[1], d), dot(axis[2], d)};
    }
    double snapVoxels() const { return maxSnap / transform().dx; }
    bool tooFar(const SurfacePoint& p) const { return !isNear(p, transform(), maxSnap); }
    void requireNear(const SurfacePoint& p, const Band& band, const Vec3d& asked,
                     const std::string& what) const {
        if (tooFar(p))
            refuseFar(p, transform(), maxSnap, what + " (" + textOf(asked, 9) + ")",
                      boxOf(band) + hintFor(band, asked));
    }
    static std::string boxOf(const Band& band);
    std::string hintFor(const Band& band, const Vec3d& asked) const;
    std::shared_ptr<const Band> wholeBand(Progress& progress) const {
        surface.requireMemory(width, options.rules.memoryLimit);
        return surface.band(width, {}, progress);
    }
    /// The metric on the whole band is made once.
    MetricPtr metricOf(const Band& band, bool whole, Progress& progress) const {
        if (!whole) return metricOn(options.metric, band, progress);
        const std::lock_guard<std::mutex> lock(cache->mutex);
        if (!cache->wholeMetric) cache->wholeMetric = metricOn(options.metric, band, progress);
        return *cache->wholeMetric;
    }
};

/// The box of the surface in the world, for messages.
std::string GeodesicSolver::Setup::boxOf(const Band& band) {
    Box box;
    for (NodeIndex i = 0; i < band.size(); ++i)
        box.include(band.transform.worldFromIndex(band.footPoint(i)));
    return "; the surface lies between " + textOf(box.low) + " and " + textOf(box.high);
}

/// The mistakes of coordinates that are made most, where one of them puts the point on the surface.
std::string GeodesicSolver::Setup::hintFor(const Band& band, const Vec3d& asked) const {
    auto isOn = [&](const Vec3d& pIndex) {
        const double reach = length(pIndex);
        return reach < kFarthestIndex && !tooFar(surface.nearest(band, pIndex));
    };
    if (options.rules.space == Space::Index)
        return isOn(transform().indexFromWorld(asked)) ? "; as a point of the world it is on the "
                                                         "surface: Space::World"
                                                       : "";
    if (isOn(asked)) return "; as index coordinates it is on the surface: Space::Index";
    for (const double factor : {1000.0, 0.001, 100.0, 0.01, 25.4, 1 / 25.4})
        if (isOn(transform().indexFromWorld(factor * asked)))
            return fmt::format("; times {:.4g} it is on the surface: are its units the same?",
                               factor);
    return "";
}

namespace {

/// One query: its points, the band that it is solved on, and the march.
class Query {
public:
    Query(const GeodesicSolver::Setup& setup, const Seeds& seeds, const MarchLimits& limits,
          Progress& progress)
        : setup_(setup), asked_(seeds), limits_(limits), progress_(progress) {}
    Distance solve(const Surface& surface);

private:
    const Band& band() const { return *band_; }
    double firstReach(double limit) const;
    std::vector<Ball> regionWithin(double reach) const;
    void makeBand(const std::vector<Ball>& region);
    void snapPoints();
    bool anyTooFar() const;
    void requireNearPoints() const;
    void makeMetric();
    void requireFree(const std::vector<SurfacePoint>& points, const char* what) const;
    void addCurvesAndRegions();
    std::string nameOf(const char* what, std::size_t number, std::size_t place) const {
        return place < asked_.names.size() ? asked_.names[place]
                                           : what + (" " + std::to_string(number));
    }
    void addSamples();
    void march(double maxDistance);
    bool allFound() const;

    const GeodesicSolver::Setup& setup_;
    const Seeds& asked_;
    const MarchLimits& limits_;
    Progress& progress_;
    std::shared_ptr<const Band> band_;
    bool whole_ = false;
    MetricPtr metric_;
    std::vector<SurfacePoint> seeds_, targets_;
    Field field_;
};

/// How far a first march goes: to the limit, or as far as the targets may be.
double Query::firstReach(double limit) const {
    if (!limits_.stopAtTargets) return limit;
    double farthest = 0;
    for (const Vec3d& target : limits_.targets) {
        double nearest = kInfinity;
        for (const Seed& seed : asked_.points)
            nearest =
                std::min(nearest, length(setup_.indexOf(target) - setup_.indexOf(seed.position)));
        farthest = std::max(farthest, nearest);
    }
    return std::min(limit, std::max(1.5 * farthest, 16.0) * setup_.leastWeight);
}

/// Where a march up to `reach` (voxels times weight) from the seeds can come, and where targets
/// are looked for: no path is shorter than the straight line at the least weight. Empty:
/// everywhere.
std::vector<Ball> Query::regionWithin(double reach) const {
    // What a march looks at beyond its limit: its margin, the start discs, the band, its cells; and
    // a scheme may be some percent short.
    constexpr double kBeyond = 16, kShort = 1.1;
    // Every leaf is compared with every ball: for many points the whole surface is cheaper.
    constexpr std::size_t kMany = 200;
    if (!(reach < kInfinity) || asked_.points.size() + limits_.targets.size() > kMany ||
        setup_.needsWholeSurface || asked_.extended() || asked_.samples > 0)
        return {};
    const double radius = std::max(reach, 0.0) / setup_.leastWeight;
    std::vector<Ball> region;
    for (const Seed& seed : asked_.points)
        region.push_back(
            {setup_.indexOf(seed.position), setup_.snapVoxels() + kShort * radius + kBeyond});
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
    seeds_.clear();
    targets_.clear();
    for (const Seed& seed : asked_.points) {
        seeds_.push_back(setup_.surface.nearest(band(), setup_.indexOf(seed.position)));
        seeds_.back().start = seed.start / band().transform.dx;
    }
    for (const Vec3d& target : limits_.targets)
        targets_.push_back(setup_.surface.nearest(band(), setup_.indexOf(target)));
}

bool Query::anyTooFar() const {
    auto isFar = [&](const SurfacePoint& p) { return setup_.tooFar(p); };
    return std::any_of(seeds_.begin(), seeds_.end(), isFar) ||
           std::any_of(targets_.begin(), targets_.end(), isFar);
}

void Query::requireNearPoints() const {
    for (std::size_t k = 0; k < seeds_.size(); ++k)
        setup_.requireNear(seeds_[k], band(), asked_.points[k].position,
                           "seed " + std::to_string(k));
    for (std::size_t k = 0; k < targets_.size(); ++k)
        setup_.requireNear(targets_[k], band(), limits_.targets[k], "target " + std::to_string(k));
}

void Query::requireFree(const std::vector<SurfacePoint>& points, const char* what) const {
    for (std::size_t k = 0; k < points.size(); ++k) {
        const Vec3d& p = points[k].pIndex;
        if (!metric_->blocked(p, p, Vec3d(band().normal[points[k].node]))) continue;
        const Vec3d world = band().transform.worldFromIndex(p);
        throw Error(Kind::InvalidArgument,
                    std::string(what) + " " + std::to_string(k) + " (" + textOf(world, 9) +
                        ") lies inside an obstacle",
                    "move it, or leave the obstacle out");
    }
}

void Query::makeMetric() {
    metric_ = setup_.metricOf(band(), whole_, progress_);
    if (!metric_) return;
    requireFree(seeds_, "seed");
    requireFree(targets_, "target");
    progress_.finished("metric");
}

void Query::addCurvesAndRegions() {
    if (!asked_.extended()) return;
    auto add = [&](const std::vector<SurfacePoint>& more) {
        seeds_.insert(seeds_.end(), more.begin(), more.end());
    };
    for (std::size_t k = 0; k < asked_.curves.size(); ++k) {
        Curve curve = asked_.curves[k];
        for (Vec3d& p : curve.points) p = setup_.indexOf(p);
        curve.start /= band().transform.dx;
        add(naming(nameOf("seed curve", k, k),
                   [&] { return seedsAlong(band(), curve, setup_.snapVoxels(), progress_); }));
    }
    for (std::size_t k = 0; k < asked_.regions.size(); ++k) {
        const std::vector<SurfacePoint> rim = seedsAround(band(), *asked_.regions[k], progress_);
        if (rim.empty())
            throw Error(Kind::InvalidArgument,
                        nameOf("seed region", k, asked_.curves.size() + k) +
                            ": its rim does not cross the surface",
                        "give a region that holds some voxels of the surface, and not all");
        add(rim);
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
    const auto stopAt = limits_.stopAtTargets ? targets_ : std::vector<SurfacePoint>{};
    if (setup_.options.scheme == Scheme::Jet) {
        JetOptions jet;
        jet.maxDistance = maxDistance;
        jet.stopAt = stopAt;
        field_ = marchJet(band(), metric_, seeds_, jet, progress_);
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
        return sampleDistance(field_, t.pIndex) < kInfinity;
    });
}

Distance Query::solve(const Surface& surface) {
    const double limit = limits_.maxDistance / setup_.transform().dx;
    auto solveOn = [&](const std::vector<Ball>& region, double maxDistance) {
        makeBand(region);
        if (band().size() > 0) snapPoints();
        // The nearest point of the whole surface is what a message should name.
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
    finishInside(asked_, field_, progress_);
    return Distance(surface, setup_.width, band_, whole_, std::move(field_), std::move(targets_),
                    setup_.maxSnap);
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
    if (seeds.empty())
        throw Error(Kind::InvalidArgument, "there is no seed", "give a point, a curve or a region");
    if (seeds.isSigned) requireSigned(seeds);
    requireStarts(seeds, setup_->transform().dx);
    return Query(*setup_, seeds, limits, progress).solve(setup_->surface);
}

std::vector<PairDistance> GeodesicSolver::pairs(const std::vector<Vec3d>& sources,
                                                const std::vector<Vec3d>& targets,
                                                Progress& progress) const {
    const Setup& s = *setup_;
    PairSurface surface;
    surface.band = [&](const std::vector<Ball>& region, Progress& p) {
        return region.empty() ? s.wholeBand(p) : s.surface.band(s.width, region, p);
    };
    surface.metric = [&](const Band& b, Progress& p) { return metricOn(s.options.metric, b, p); };
    surface.nearest = [&](const Band& b, const Vec3d& p) { return s.surface.nearest(b, p); };
    surface.refuse = [&](const Vec3d& askedIndex, const std::string& what) {
        const std::shared_ptr<const Band> whole = s.wholeBand(progress);
        const bool index = s.options.rules.space == Space::Index;
        s.requireNear(s.surface.nearest(*whole, askedIndex), *whole,
                      index ? askedIndex : s.transform().worldFromIndex(askedIndex), what);
    };
    surface.leastWeight = s.needsWholeSurface ? 0 : s.leastWeight;
    surface.diagonal = s.surface.facts().diagonal;
    auto inIndexSpace = [&](std::vector<Vec3d> points) {
        for (Vec3d& p : points) p = s.indexOf(p);
        return points;
    };
    std::vector<PairDistance> pairs;
    for (const SolvedPair& pair : pairDistances(surface, inIndexSpace(sources),
                                                inIndexSpace(targets), s.snapVoxels(), progress))
        pairs.push_back({inWorld(pair.source, s.transform()), inWorld(pair.target, s.transform()),
                         pair.distance * s.transform().dx});
    return pairs;
}

Polyline GeodesicSolver::shoot(const Vec3d& from, const Vec3d& direction, double distance,
                               Progress& progress) const {
    constexpr double kBeyond = 8;  // voxels that a step and its cells look at
    const Setup& s = *setup_;
    const Vec3d start = s.indexOf(from), along = s.indexDirectionOf(direction);
    const double unit = s.options.rules.space == Space::Index ? 1 : s.transform().dx,
                 voxels = distance / unit;
    // Half a minute and a gigabyte.
    constexpr double kLongest = 1e7;
    if (!(voxels >= 0 && voxels <= kLongest))
        throw Error(Kind::InvalidArgument,
                    fmt::format("a path of length {:.6g}; allowed are 0 to {:.6g}, 1e7 voxels",
                                distance, kLongest * unit),
                    distance < 0 ? "turn the direction round to walk backwards"
                                 : "go on from the end of a shorter one");
    std::shared_ptr<const Band> band = s.surface.madeBand(s.width);
    if (!band)
        band = s.surface.band(s.width, {{start, s.snapVoxels() + voxels + kBeyond}}, progress);
    if (band->size() == 0) band = s.wholeBand(progress);
    const SurfacePoint p = s.surface.nearest(*band, start);
    s.requireNear(p, *band, from, "the start");
    return inWorld(igeo::shoot(*band, p, along, voxels, progress), s.transform());
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
Vec3d GeodesicSolver::indexOf(const Vec3d& position) const { return setup_->indexOf(position); }

}  // namespace igeo
