#include <igeo/warnings.h>

#include <fmt/core.h>
#include <igeo/base/parallel.h>
#include <igeo/metric/curvature.h>
#include <igeo/results/lost_points.h>
#include <igeo/results/overrun_seeds.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace igeo {

namespace {

using Sentences = std::vector<std::string>;
using Lines = std::vector<const Polyline*>;

void append(Sentences& all, const Sentences& more) {
    all.insert(all.end(), more.begin(), more.end());
}
void append(Sentences& all, const std::string& sentence) {
    if (!sentence.empty()) all.push_back(sentence);
}

std::string lostVertices(const Distance& found, Progress& progress) {
    constexpr std::size_t kMost = 1000;
    constexpr double kOn = 1e-3;  // voxels; vertices without a face are elsewhere
    const TriangleMesh* const mesh = found.surface().triangles();
    const std::shared_ptr<const Field> marched = found.marched();
    if (!mesh || marched->seeds.empty() || marched->stoppedEarly ||
        marched->reached == marched->size())
        return {};
    const Band& band = found.band();
    std::vector<Vec3d> looked;
    const std::vector<Vec3d>& all = mesh->points;
    const std::size_t step = (all.size() + kMost - 1) / kMost;
    for (std::size_t k = 0; k < all.size(); k += step) looked.push_back(all[k]);
    std::vector<double> distance(looked.size(), std::numeric_limits<double>::quiet_NaN());
    parallelFor(looked.size(), 16, progress, [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) {
            const SurfacePoint p =
                found.surface().nearest(band, band.transform.indexFromWorld(looked[k]));
            if (!(p.snapDistance < kOn)) continue;
            const double d = sampleDistance(*marched, p.pIndex, Vec3d(band.normal[p.node]));
            distance[k] = d <= marched->greatest ? d : kInfinity;
        }
    });
    return lostWarning(*marched, step > 1 ? "vertices looked at" : "vertices", looked, distance);
}

std::string lengthsAgainstDistances(bool byJet, double dx, const Lines& paths,
                                    const std::string& what) {
    constexpr double kVoxels = 2;
    const double share = byJet ? 0.02 : 0.05;
    std::size_t count = 0, reached = 0, worst = 0;
    double most = 0;
    for (std::size_t k = 0; k < paths.size(); ++k) {
        const Polyline& p = *paths[k];
        if (p.status != PathStatus::Reached || !(p.startDistance > 0)) continue;
        ++reached;
        const double off = std::abs(p.endDistance + p.weightedLength - p.startDistance);
        if (off < kVoxels * dx || off < share * p.startDistance) continue;
        ++count;
        if (off / p.startDistance > most) most = off / p.startDistance, worst = k;
    }
    if (count == 0) return {};
    return fmt::format(
        "{} of {} paths are longer or shorter than their distances by more than {:.0f} % ({} {} by "
        "{:.0f} %): the distance or the path is unreliable there",
        count, reached, 100 * share, what, worst, 100 * most);
}

std::string longSteps(double dx, const Lines& paths, const std::string& what) {
    constexpr double kLong = 2.5;  // voxels
    std::size_t count = 0, worst = 0;
    double most = 0;
    for (std::size_t k = 0; k < paths.size(); ++k) {
        const std::vector<Vec3d>& points = paths[k]->points;
        double longest = 0;
        for (std::size_t i = 1; i < points.size(); ++i)
            longest = std::max(longest, length(points[i] - points[i - 1]) / dx);
        count += longest > kLong;
        if (longest > most) most = longest, worst = k;
    }
    if (count == 0) return {};
    return fmt::format(
        "{} of {} paths have a step of more than {} voxels ({} {}: {:.1f}): it may lead through a "
        "thin wall or across a slot; smaller voxels, or the mesh itself, tell the sheets apart",
        count, paths.size(), kLong, what, worst, most);
}

std::string lostPairs(const GeodesicSolver& solver, const std::vector<PairDistance>& pairs,
                      Progress& progress) {
    auto isLost = [](const PairDistance& p) { return !p.isSkipped() && !(p.distance < kInfinity); };
    if (!solver.surface().triangles() || std::none_of(pairs.begin(), pairs.end(), isLost))
        return {};
    const std::shared_ptr<const Band> band = solver.wholeBand(progress);
    std::vector<Vec3d> targets;
    for (const PairDistance& p : pairs) targets.push_back(p.target.position);
    LostPoints lost(*band, solver.wholeMetric(progress), targets);
    for (std::size_t k = 0; k < pairs.size(); ++k) {
        if (pairs[k].isSkipped()) continue;
        SurfacePoint source;
        source.pIndex = band->transform.indexFromWorld(pairs[k].source.position);
        lost.add({source}, k, pairs[k].distance);
    }
    return lost.warning("pairs");
}

Sentences warningsOf(const Lines& paths, const Surface& surface, bool byJet,
                     const std::string& what) {
    const double dx = surface.transform().dx;
    Sentences found;
    append(found, lengthsAgainstDistances(byJet, dx, paths, what));
    if (!surface.triangles()) append(found, longSteps(dx, paths, what));
    return found;
}

}  // namespace

Sentences surfaceWarnings(const GeodesicSolver& solver, Progress& progress) {
    const std::shared_ptr<const Band> band = solver.surface().madeBand(solver.bandWidth());
    if (!band) return {};
    Sentences found = unresolvedWarnings(solver.surface().unresolved(*band));
    if (const double gap = solver.surface().facts().joinGaps; gap > 0 && band->joints == 0)
        append(found,
               fmt::format("joinGaps {:.6g} joins nothing: no two components of the mesh are "
                           "as close as that, nor two rims; a component without a rim there, "
                           "such as a closed ring with a cut, is not joined to itself",
                           gap));
    const MetricDefinition& costs = solver.options().metric;
    if (const TriangleMesh* mesh = solver.surface().triangles();
        mesh && (costs.curvature || costs.bending))
        append(found, wideFacetWarning(*mesh, band->transform.dx, costs.curvatureScale));
    append(found, solver.costWarnings(progress));
    return found;
}

Sentences marchWarnings(const Distance& distance, const Sentences& sources) {
    Sentences found = overrunWarnings(*distance.marched(), sources);
    append(found, distance.costWarnings());
    return found;
}

Sentences lostWarnings(const Distance& distance, Progress& progress) {
    Sentences found;
    append(found, lostVertices(distance, progress));
    std::vector<Vec3d> targets;
    for (const SurfacePoint& p : distance.targets())
        targets.push_back(inWorld(p, distance.band().transform).position);
    append(found, lostWarning(*distance.marched(), "targets", targets, distance.atTargets()));
    return found;
}

Sentences lostWarnings(const GeodesicSolver& solver, const std::vector<PairDistance>& pairs,
                       Progress& progress) {
    Sentences found;
    append(found, lostPairs(solver, pairs, progress));
    return found;
}

Sentences pathWarnings(const Surface& surface, bool byJet, const std::vector<Polyline>& paths) {
    Lines lines;
    for (const Polyline& path : paths) lines.push_back(&path);
    return warningsOf(lines, surface, byJet, "target");
}
Sentences pathWarnings(const Surface& surface, const std::vector<PairDistance>& pairs) {
    Lines lines;
    for (const PairDistance& pair : pairs) lines.push_back(&pair.path);
    return warningsOf(lines, surface, /*byJet=*/true, "pair");
}

Sentences estimateWarnings(const AccuracyEstimate& estimate) {
    // Either way the estimate is then within a factor of three.
    constexpr double kDoubt = 2.5;
    const double all = estimate.meanError, known = estimate.withoutFacets;
    if (!(all > kDoubt * known)) return {};
    return {fmt::format(
        "{:.0f} % of the estimated error, {:.2g} %, is in doubt: what scatters about the surface "
        "may be facets that points do not show, which the estimate takes it for; if they scatter, "
        "the error is {:.2g} %; pairs of points within a sixth of the spacing would tell, or the "
        "mesh itself",
        100 * (1 - known / all), 100 * all, 100 * known)};
}

Sentences walkWarnings(const std::vector<Polyline>& walks) {
    Sentences found;
    for (std::size_t k = 0; k < walks.size(); ++k) {
        if (const std::size_t bends = walks[k].roundedBends)
            append(found, fmt::format(
                              "walk {} goes over {} sharp bend{} as the voxels round {} off, below "
                              "25 degrees or with sheets narrower than 3 voxels: behind {} its "
                              "direction is off by up to some degrees, or more beside a corner; "
                              "smaller voxels, or the mesh itself, show such edges",
                              k, bends, bends == 1 ? "" : "s", bends == 1 ? "it" : "them",
                              bends == 1 ? "it" : "them"));
        if (const std::size_t corners = walks[k].closeCorners)
            append(found,
                   fmt::format("walk {} goes over {} edge{} within about a voxel of a corner: a "
                               "slightly other walk goes on over another sheet, far away from this "
                               "one",
                               k, corners, corners == 1 ? "" : "s"));
    }
    return found;
}

}  // namespace igeo
