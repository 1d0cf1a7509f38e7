// GeodesicSolver: pairs of points, curves through points, walks, and their vertices.
#include <igeo/geodesic_solver.h>

#include <fmt/core.h>
#include <igeo/band/detail/snap.h>
#include <igeo/base/error.h>
#include <igeo/path/curve_normals.h>
#include <igeo/path/exponential_map.h>
#include <igeo/path/straighten.h>

#include <algorithm>
#include <cmath>

namespace igeo {

namespace {

using Kind = Error::Kind;

/// The surface of a solver, as pairDistances takes it.
PairSurface pairSurface(const GeodesicSolver& solver) {
    const MetricDefinition& metric = solver.options().metric;
    PairSurface surface;
    surface.band = [&solver](const std::vector<Ball>& region, Progress& p) {
        return region.empty() ? solver.wholeBand(p)
                              : solver.surface().band(solver.bandWidth(), region, p);
    };
    surface.metric = [&metric](const Band& b, Progress& p) { return metricOn(metric, b, p); };
    surface.nearest = [&solver](const Band& b, const Vec3d& p) {
        return solver.surface().nearest(b, p);
    };
    surface.refuse = [&solver](const Vec3d& askedIndex, const std::string& what) {
        const bool index = solver.options().rules.space == Space::Index;
        solver.requireNear(
            index ? askedIndex : solver.surface().transform().worldFromIndex(askedIndex), what);
    };
    surface.leastWeight = needsWholeSurface(metric) ? 0 : leastWeight(metric);
    surface.diagonal = solver.surface().facts().diagonal;
    surface.skipOffSurface = solver.options().rules.skipOffSurface;
    return surface;
}

std::vector<SolvedPair> solve(const GeodesicSolver& solver, const PairSurface& surface,
                              const std::vector<Vec3d>& sources, const std::vector<Vec3d>& targets,
                              Progress& progress) {
    auto inIndexSpace = [&](std::vector<Vec3d> points) {
        for (Vec3d& p : points) p = solver.indexOf(p);
        return points;
    };
    return pairDistances(surface, inIndexSpace(sources), inIndexSpace(targets),
                         solver.maxSnap() / solver.surface().transform().dx, progress);
}

/// @param sources, targets  as given by the caller
std::vector<PairDistance> pairsInWorld(const GeodesicSolver& solver,
                                       const std::vector<SolvedPair>& solved,
                                       const std::vector<Vec3d>& sources,
                                       const std::vector<Vec3d>& targets) {
    const Similarity& transform = solver.surface().transform();
    std::vector<PairDistance> pairs;
    for (const SolvedPair& pair : solved) {
        pairs.push_back({inWorld(pair.source, transform), inWorld(pair.target, transform),
                         pair.distance * transform.dx, inWorld(pair.path, transform)});
        PairDistance& p = pairs.back();
        if (solver.options().rules.space == Space::World) {
            p.source.asked = sources[pairs.size() - 1];
            p.target.asked = targets[pairs.size() - 1];
        }
        p.path.start = p.source;
        p.path.end = p.target;
        p.path.endDistance = p.distance;
        p.path.startDistance = 0;
    }
    return pairs;
}

/// Joins legs end to end.
/// @param corners  the vertices between them
Path chained(const std::vector<SolvedPair>& legs, std::vector<std::size_t>& corners) {
    Path chain;
    for (const SolvedPair& leg : legs) {
        chain.status = leg.path.status;
        if (chain.status != PathStatus::Reached) {
            chain.vertices.clear();
            return chain;
        }
        const PathVertex before = chain.vertices.empty() ? PathVertex{} : chain.vertices.back();
        for (PathVertex v : leg.path.vertices) {
            if (&leg != &legs.front() && v.arcLength == 0) continue;
            v.arcLength += before.arcLength;
            v.distance += before.distance;
            chain.vertices.push_back(v);
        }
        if (&leg != &legs.back()) corners.push_back(chain.vertices.size() - 1);
        chain.length += leg.path.length;
        chain.weightedLength += leg.path.weightedLength;
    }
    return chain;
}

/// Relaxes a path as a whole, on the part of the surface that shorter paths between its ends can
/// reach.
void relaxWhole(const PairSurface& surface, bool closed, Path& path, Progress& progress) {
    constexpr double kBeyond = 12;  // voxels that projections and cells read beyond it
    std::vector<Ball> region;
    if (!closed && surface.leastWeight > 0)
        region.push_back({0.5 * (path.vertices.front().pIndex + path.vertices.back().pIndex),
                          path.weightedLength / surface.leastWeight / 2 + kBeyond});
    const auto band = surface.band(region, progress);
    Field field;
    field.band = band.get();
    if (MetricPtr metric = surface.metric(*band, progress)) field.metric = metric;
    const Vec3d sheet = path.vertices.front().normal;
    if (straightenWhole(field, path, closed, progress)) return addNormals(*band, path, sheet);
    path.status = PathStatus::Stalled;
    path.vertices.clear();
}

/// Unit normal of a band's surface at a point of it, world space.
/// @param about  a normal not far from it
Vec3d normalOn(const Band& band, const Vec3d& p, const Vec3d& about) {
    const Similarity& t = band.transform;
    return t.worldFromIndexDirection(
        normalAt(band, t.indexFromWorld(p), t.indexFromWorldDirection(about)));
}

/// A unit vector, for an input of any length; zero for a zero input.
Vec3d indexDirection(const GeodesicSolver& solver, const Vec3d& v) {
    const double most = std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
    if (!(most > 0 && most < kInfinity)) return {};
    const Vec3d d = normalized(Vec3d{v.x / most, v.y / most, v.z / most});
    if (solver.options().rules.space == Space::Index) return d;
    return solver.surface().transform().indexFromWorldDirection(d);
}

}  // namespace

std::string PairDistance::reason() const {
    if (!isSkipped()) return "";
    return std::string("the ") + (source.offSurface ? "source" : "target") + " is off the surface";
}

std::vector<PairDistance> GeodesicSolver::pairs(const std::vector<Vec3d>& sources,
                                                const std::vector<Vec3d>& targets,
                                                Progress& progress) const {
    return pairsInWorld(*this, solve(*this, pairSurface(*this), sources, targets, progress),
                        sources, targets);
}

std::vector<PairDistance> GeodesicSolver::pairPaths(const std::vector<Vec3d>& sources,
                                                    const std::vector<Vec3d>& targets,
                                                    bool straighten, Progress& progress) const {
    PairSurface surface = pairSurface(*this);
    surface.paths = straighten ? PairSurface::Paths::Straightened : PairSurface::Paths::Traced;
    return pairsInWorld(*this, solve(*this, surface, sources, targets, progress), sources, targets);
}

Polyline GeodesicSolver::through(const std::vector<Vec3d>& points, bool closed, bool whole,
                                 Progress& progress) const {
    const std::size_t least = closed ? 3 : 2;
    if (points.size() < least)
        throw Error(Kind::InvalidArgument,
                    fmt::format("{} points for a{} curve", points.size(), closed ? " closed" : ""),
                    fmt::format("give {} or more", least));
    std::vector<Vec3d> from = points, to(points.begin() + 1, points.end());
    closed ? to.push_back(points.front()) : from.pop_back();
    PairSurface surface = pairSurface(*this);
    surface.paths = PairSurface::Paths::Straightened;
    surface.skipOffSurface = false;
    surface.nameOf = [&points](std::size_t leg, bool target) {
        return fmt::format("point {}", (leg + target) % points.size());
    };
    const std::vector<SolvedPair> legs = solve(*this, surface, from, to, progress);
    std::vector<std::size_t> corners;
    Path path = chained(legs, corners);
    if (whole && path.status == PathStatus::Reached && path.length > 0) {
        corners.clear();
        relaxWhole(surface, closed, path, progress);
    }
    const Similarity& transform = this->surface().transform();
    Polyline line = inWorld(path, transform);
    line.start = inWorld(legs.front().source, transform);
    line.end = inWorld(legs.back().target, transform);
    line.startDistance = 0;
    line.endDistance = line.weightedLength;
    line.corners = std::move(corners);
    return line;
}

Polyline GeodesicSolver::shoot(const Vec3d& from, const Vec3d& direction, double distance,
                               Progress& progress) const {
    constexpr double kBeyond = 8;  // voxels that a step and its cells read beyond it
    const Similarity& transform = surface().transform();
    const Vec3d start = indexOf(from), along = indexDirection(*this, direction);
    const double unit = options().rules.space == Space::Index ? 1 : transform.dx,
                 voxels = distance / unit;
    // This length takes half a minute and a gigabyte.
    constexpr double kLongest = 1e7;
    if (!(voxels >= 0 && voxels <= kLongest))
        throw Error(Kind::InvalidArgument,
                    fmt::format("a path of length {:.6g}; allowed are 0 to {:.6g}, 1e7 voxels",
                                distance, kLongest * unit),
                    distance < 0 ? "reverse the direction instead"
                                 : "continue from the end of a shorter one");
    std::shared_ptr<const Band> band = surface().madeBand(bandWidth());
    if (!band)
        band = surface().band(bandWidth(), {{start, maxSnap() / transform.dx + voxels + kBeyond}},
                              progress);
    if (band->size() == 0) band = wholeBand(progress);
    const SurfacePoint p = surface().nearest(*band, start);
    if (!isNear(p, transform, maxSnap())) requireNear(from, "the start");
    Path path = igeo::shoot(*band, p, along, voxels, progress);
    addNormals(*band, path);
    return inWorld(path, transform);
}

Polyline GeodesicSolver::resampled(const Polyline& line, double step) const {
    constexpr double kMost = 1e7, kSame = 1e-6;  // kSame: of a step
    if (!(step > 0 && line.length / step < kMost))
        throw Error(Kind::InvalidArgument,
                    fmt::format("vertices {:.6g} apart on a path of length {:.6g}; allowed are "
                                "lengths above 0 that give 1e7 vertices at most",
                                step, line.length),
                    "take a larger step");
    if (line.points.size() < 2) return line;
    const std::shared_ptr<const Band> made = surface().madeBand(bandWidth());
    const Band* const mesh = made && made->triangles ? made.get() : nullptr;
    Polyline out = line;
    for (auto* list : {&out.points, &out.normals}) list->clear();
    for (auto* list : {&out.arcLength, &out.distance}) list->clear();
    out.corners.clear();
    // Adds the point at a fraction t of the segment that ends at vertex k.
    auto add = [&](std::size_t k, double t) {
        auto between = [&](const auto& v) {
            return t == 1 ? v[k] : v[k - 1] + t * (v[k] - v[k - 1]);
        };
        out.points.push_back(between(line.points));
        out.normals.push_back(normalized(between(line.normals)));
        out.arcLength.push_back(between(line.arcLength));
        out.distance.push_back(between(line.distance));
        // On a mesh normals jump at the edges, so they are not interpolated.
        if (mesh && t > 0 && t < 1)
            out.normals.back() = normalOn(*mesh, out.points.back(), out.normals.back());
    };
    add(1, 0);
    auto corner = line.corners.begin();
    for (std::size_t k = 1; k < line.points.size();) {
        const std::size_t last =
            corner == line.corners.end() ? line.points.size() - 1 : std::max(k, *corner++);
        const double from = out.arcLength.back(), end = line.arcLength[last] - kSame * step;
        for (double n = 1; from + n * step < end; ++n) {
            while (line.arcLength[k] < from + n * step) ++k;
            const double before = line.arcLength[k - 1];
            add(k, (from + n * step - before) / (line.arcLength[k] - before));
        }
        add(last, 1);
        if (last + 1 < line.points.size()) out.corners.push_back(out.points.size() - 1);
        k = last + 1;
    }
    return out;
}

}  // namespace igeo
