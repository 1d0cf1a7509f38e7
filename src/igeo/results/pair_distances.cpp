#include <igeo/results/pair_distances.h>

#include <fmt/core.h>
#include <igeo/base/detail/steps.h>
#include <igeo/base/error.h>
#include <igeo/base/parallel.h>
#include <igeo/march/jet.h>
#include <igeo/march/local_search.h>
#include <igeo/path/curve_normals.h>
#include <igeo/path/straighten.h>
#include <igeo/surface/level_set_band.h>

#include <algorithm>
#include <limits>
#include <map>
#include <string>
#include <tuple>

namespace igeo {

namespace {

class PairSolver {
public:
    PairSolver(const PairSurface& surface, const std::vector<Vec3d>& sources,
               const std::vector<Vec3d>& targets, double snap, Progress& progress)
        : surface_(surface),
          sources_(sources),
          targets_(targets),
          snap_(snap),
          quiet_(progress),
          pairs_(sources.size()) {}

    std::vector<SolvedPair> solve(Progress& progress);

private:
    /// Pairs that share a source.
    using Group = std::vector<std::size_t>;

    std::vector<Group> groups() const;
    double straight(std::size_t k) const { return length(targets_[k] - sources_[k]); }
    /// The balls of all paths of this length between a group's points, and of the voxels that a
    /// march reads.
    std::vector<Ball> region(const Group& group, double reach) const;
    /// Solves a group on the surface near it; false if that takes the whole surface.
    bool solveAround(const Group& group);
    /// @param core  of the band in the metric, if it exists
    /// @return whether all targets are within `reach`, or a point is too far from S
    bool solveOn(const Band& band, const MetricPtr& metric, const Group& whole, double reach,
                 const JetCorePtr& core);
    MetricPtr metricOn(const Band& band) {
        return surface_.metric ? surface_.metric(band, quiet_) : nullptr;
    }
    /// The geodesic from the seed of a field to a target.
    Path pathTo(const Field& field, const SurfacePoint& target);
    bool snapTo(const Band& band, const Vec3d& asked, SurfacePoint& p) const;
    void refuseFarPoints() const;
    void markSkippedPairs();

    const PairSurface& surface_;
    const std::vector<Vec3d>&sources_, &targets_;
    const double snap_;
    CancelOnly quiet_;
    std::vector<SolvedPair> pairs_;
};

std::vector<PairSolver::Group> PairSolver::groups() const {
    std::map<std::tuple<double, double, double>, std::size_t> numbers;
    std::vector<Group> groups;
    for (std::size_t k = 0; k < sources_.size(); ++k) {
        const Vec3d& s = sources_[k];
        const auto at = numbers.try_emplace({s.x, s.y, s.z}, groups.size()).first;
        if (at->second == groups.size()) groups.emplace_back();
        groups[at->second].push_back(k);
    }
    return groups;
}

std::vector<Ball> PairSolver::region(const Group& group, double reach) const {
    // The start disc, the nodes around a target that the march waits for, the margin behind the
    // front, and the cells and band around all that. The scheme's distances may be some percent
    // short.
    constexpr double kBeyond = 12, kShort = 1.1;
    const double longest = kShort * reach / surface_.leastWeight;
    std::vector<Ball> balls;
    for (const std::size_t k : group)
        balls.push_back({0.5 * (sources_[k] + targets_[k]), longest / 2 + snap_ + kBeyond});
    return balls;
}

bool PairSolver::snapTo(const Band& band, const Vec3d& asked, SurfacePoint& p) const {
    if (band.size() == 0) {
        p.askedIndex = asked;
        p.snapDistance = kInfinity;
    } else {
        p = surface_.nearest ? surface_.nearest(band, asked) : nearestSurfacePoint(band, asked);
    }
    p.offSurface = !(p.snapDistance <= snap_);
    return !p.offSurface;
}

bool PairSolver::solveOn(const Band& band, const MetricPtr& metric, const Group& whole,
                         double reach, const JetCorePtr& core) {
    SurfacePoint source;
    snapTo(band, sources_[whole.front()], source);
    JetOptions options;
    options.extend = surface_.paths != PairSurface::Paths::None;
    // A margin for the cells around a target at the limit.
    options.maxDistance = reach + 2 * (metric ? metric->largest() : 1);
    Group group;
    std::vector<SurfacePoint> targets;
    for (const std::size_t k : whole) {
        pairs_[k].source = source;
        if (!snapTo(band, targets_[k], pairs_[k].target) || source.offSurface) continue;
        group.push_back(k);
        targets.push_back(pairs_[k].target);
    }
    if (group.empty() || (group.size() < whole.size() && !surface_.skipOffSurface)) return true;
    options.stopAt = coreAround(band, targets);
    const Field field = core ? marchJet(core, {source}, options, quiet_)
                             : marchJet(band, metric, {source}, options, quiet_);
    bool found = true;
    for (const std::size_t k : group) {
        SolvedPair& pair = pairs_[k];
        pair.distance =
            sampleDistance(field, pair.target.pIndex, Vec3d(band.normal[pair.target.node]));
        found = found && pair.distance <= reach;
    }
    if (surface_.paths != PairSurface::Paths::None && (found || !(reach < kInfinity)))
        for (const std::size_t k : group) pairs_[k].path = pathTo(field, pairs_[k].target);
    return found;
}

Path PairSolver::pathTo(const Field& field, const SurfacePoint& target) {
    Path path = tracePath(field, target);
    if (surface_.paths == PairSurface::Paths::Straightened) straighten(field, path, quiet_);
    if (path.status != PathStatus::Reached) path.vertices.clear();
    addNormals(*field.band, path);
    std::reverse(path.vertices.begin(), path.vertices.end());
    for (PathVertex& v : path.vertices) v.arcLength = path.length - v.arcLength;
    path.target.node = kNoNode;
    return path;
}

bool PairSolver::solveAround(const Group& group) {
    if (!(surface_.leastWeight > 0)) return false;
    double reach = 16;
    for (const std::size_t k : group) reach = std::max(reach, 1.5 * straight(k));
    const double least = surface_.leastWeight;
    return searchNear(reach * least, kInfinity, surface_.diagonal / 2 * least, [&](double within) {
        const auto band = surface_.band(region(group, within), quiet_);
        return solveOn(*band, metricOn(*band), group, within, nullptr);
    });
}

void PairSolver::refuseFarPoints() const {
    for (std::size_t k = 0; k < pairs_.size(); ++k)
        for (const SurfacePoint* p : {&pairs_[k].source, &pairs_[k].target})
            if (p->offSurface) {
                const bool target = p == &pairs_[k].target;
                const std::string what =
                    surface_.nameOf
                        ? surface_.nameOf(k, target)
                        : fmt::format("the {} of pair {}", target ? "target" : "source", k);
                if (surface_.refuse) surface_.refuse(p->askedIndex, what);
                throw Error(
                    Error::Kind::InvalidArgument,
                    fmt::format("{} is more than {:g} voxels from the surface", what, snap_),
                    "move it to the surface, or allow for more");
            }
}

void PairSolver::markSkippedPairs() {
    for (SolvedPair& pair : pairs_) {
        if (!pair.source.offSurface && !pair.target.offSurface) continue;
        pair.distance = std::numeric_limits<double>::quiet_NaN();
        pair.path = {};
        pair.path.status = PathStatus::OffSurface;
        // Only a part of the surface was searched: the nearest point may be elsewhere.
        for (SurfacePoint* p : {&pair.source, &pair.target})
            if (p->offSurface) p->snapDistance = kInfinity;
    }
}

std::vector<SolvedPair> PairSolver::solve(Progress& progress) {
    const std::vector<Group> all = groups();
    std::vector<std::uint8_t> done(all.size(), 0);
    Steps steps(progress, "pairs", all.size());
    auto forAll = [&](const auto& solveGroup) {
        parallelFor(all.size(), 1, [&](std::size_t begin, std::size_t end) {
            for (std::size_t g = begin; g < end; ++g) {
                if (done[g]) continue;
                done[g] = solveGroup(all[g]);
                if (done[g]) steps.add(1);
            }
        });
        progress.throwIfCancelled();
    };
    forAll([&](const Group& group) { return solveAround(group); });
    if (std::find(done.begin(), done.end(), 0) != done.end()) {
        const auto whole = surface_.band({}, quiet_);
        const MetricPtr metric = metricOn(*whole);
        const JetCorePtr core = jetCore(*whole, metric);
        forAll([&](const Group& group) { return solveOn(*whole, metric, group, kInfinity, core); });
    }
    surface_.skipOffSurface ? markSkippedPairs() : refuseFarPoints();
    for (SolvedPair& pair : pairs_) pair.source.node = pair.target.node = kNoNode;
    return std::move(pairs_);
}

bool finite(const Vec3d& p) {
    return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
}

}  // namespace

std::vector<SolvedPair> pairDistances(const PairSurface& surface, const std::vector<Vec3d>& sources,
                                      const std::vector<Vec3d>& targets, double snap,
                                      Progress& progress) {
    if (sources.size() != targets.size())
        throw Error(
            Error::Kind::InvalidArgument,
            fmt::format("{} sources and {} targets are no pairs", sources.size(), targets.size()));
    if (!(snap >= 0))
        throw Error(Error::Kind::InvalidArgument, "points cannot be less than 0 from S");
    for (std::size_t k = 0; k < sources.size(); ++k)
        if (!finite(sources[k]) || !finite(targets[k]))
            throw Error(Error::Kind::InvalidArgument, fmt::format("pair {} is not finite", k));
    return PairSolver(surface, sources, targets, snap, progress).solve(progress);
}

}  // namespace igeo
