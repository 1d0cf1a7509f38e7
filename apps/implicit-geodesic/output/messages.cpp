#include "output/messages.h"

#include <fmt/core.h>
#include <igeo/base/detail/text.h>
#include <igeo/warnings.h>

#include <algorithm>
#include <cmath>

#include "exit_code.h"
#include "output/output_files.h"

using igeo::textOf;
using igeo::Vec3d;

namespace {

/// Most targets with a line each.
constexpr std::size_t kFewTargets = 20;

/// For many targets: the range of their distances, and the number unreached.
int tellTargets(const RunReport& report, const igeo::Distance& distance, const Console& console) {
    const std::vector<double> d = distance.atTargets();
    double least = igeo::kInfinity, most = 0;
    std::size_t unreached = 0, first = 0;
    for (std::size_t k = 0; k < d.size(); ++k) {
        if (d[k] < igeo::kInfinity)
            least = std::min(least, d[k]), most = std::max(most, d[k]);
        else if (!std::isnan(d[k]) && unreached++ == 0)
            first = k;
    }
    if (least < igeo::kInfinity)
        console.info(
            fmt::format("{} targets: distances from {:.6g} to {:.6g}", d.size(), least, most));
    if (unreached > 0)
        console.warning(fmt::format("{} of {} targets, target {} the first, are unreachable: {}",
                                    unreached, d.size(), first,
                                    distance.marched()->stoppedEarly
                                        ? "they lie beyond the distance marched"
                                        : "no path on the surface joins them to a seed"));
    const auto stalled = std::count_if(
        report.paths.begin(), report.paths.end(),
        [](const igeo::Polyline& p) { return p.status == igeo::PathStatus::Stalled; });
    if (stalled > 0)
        console.warning(
            fmt::format("no descent to a seed was found from {} of {} targets", stalled, d.size()));
    const bool skipped = std::any_of(d.begin(), d.end(), [](double x) { return std::isnan(x); });
    return unreached > 0 || stalled > 0 || skipped ? kUnreached : kDone;
}

int tellPaths(const RunReport& report, const igeo::Distance& distance, const Console& console) {
    if (distance.targets().size() > kFewTargets) return tellTargets(report, distance, console);
    const std::shared_ptr<const igeo::Field> marched = distance.marched();
    const igeo::Field& field = *marched;
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
        if (p.status == igeo::PathStatus::OffSurface) continue;  // warnOfSkippedPoints reports it
        console.warning(fmt::format(
            "target {} is {}: {}", k, igeo::toString(p.status),
            p.status == igeo::PathStatus::Stalled ? "no descent from the target to a seed was found"
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

int tellVias(const RunReport& report, const Console& console) {
    int code = kDone;
    for (std::size_t k = 0; k < report.vias.size(); ++k) {
        const ViaCurve& via = report.vias[k];
        if (via.line.status == igeo::PathStatus::Reached) {
            console.info(fmt::format("via {}: {} points, {}geodesic {:.6g} long", k,
                                     via.points.size(), via.closed ? "closed, " : "",
                                     via.line.length));
            continue;
        }
        code = kUnreached;
        console.warning(fmt::format("via {} has no geodesic: {}", k,
                                    via.line.status == igeo::PathStatus::Stalled
                                        ? "the closed curve contracts to a point"
                                        : "no path on the surface joins its points"));
    }
    return code;
}

std::string pairsText(std::size_t n) { return fmt::format("{} pair{}", n, n == 1 ? "" : "s"); }

int tellPairs(const RunReport& report, const Console& console) {
    if (report.pairs.empty()) return kDone;
    std::size_t skipped = 0, lost = 0;
    for (const igeo::PairDistance& p : report.pairs)
        p.isSkipped() ? ++skipped : lost += !(p.distance < igeo::kInfinity);
    console.info(pairsText(report.pairs.size() - skipped) + " solved");
    if (lost > 0)
        console.warning(
            fmt::format("no path on the surface joins the points of {}{}", pairsText(lost),
                        report.obstacles.empty() ? "" : ", or an obstacle holds one of them"));
    return lost + skipped > 0 ? kUnreached : kDone;
}

}  // namespace

bool showsPaths(const RunOptions& o, std::size_t targets) {
    return targets <= kFewTargets || o.straighten || !o.paths.empty() || !o.image.empty() ||
           !o.view.empty() || !o.report.empty() || o.asked(Grid::Engraved);
}

void describe(const igeo::Distance& distance, const Console& console) {
    if (!console.verbose()) return;
    const igeo::Band& band = distance.band();
    const double dx = band.transform.dx;
    console.detail(fmt::format("band: h = {:.6g} ({:.4g} voxels), {} nodes{}; {} reached",
                               band.h * dx, band.h, band.size(),
                               distance.ofWholeSurface() ? "" : ", not of the whole surface",
                               distance.reached()));
    for (const auto& [what, points] :
         {std::pair("seed", &distance.seeds()), {"target", &distance.targets()}})
        for (std::size_t k = 0; k < points->size(); ++k) {
            const igeo::SurfacePoint& p = (*points)[k];
            if (p.joined) continue;
            if (k >= kFewTargets) {
                console.detail(fmt::format("... {} {}s in all", points->size(), what));
                break;
            }
            console.detail(fmt::format("{} {}: {}, moved {:.3g}", what, k,
                                       textOf(band.transform.worldFromIndex(p.pIndex), 9),
                                       p.snapDistance * dx));
        }
    const igeo::MetricPtr marchedWith = distance.marched()->metric;
    const igeo::Metric& metric = *marchedWith;
    if (metric.weighted() || metric.obstacles)
        console.detail(fmt::format("metric: weights from {:.4g} to {:.4g}, {} nodes blocked",
                                   metric.least(), metric.largest(), metric.insideCount()));
}

namespace {

/// "3 of 500 targets are off the surface and have no distance: target 4 (0,0,9) is 8 from the
/// surface, ..."
std::string skippedWarning(const char* what, std::size_t all, const std::vector<std::string>& few,
                           std::size_t skipped) {
    std::string list;
    for (const std::string& one : few) list += (list.empty() ? "" : "; ") + one;
    return fmt::format("{} of {} {} {} off the surface and {} no distance: {}{}", skipped, all,
                       what, skipped == 1 ? "is" : "are", skipped == 1 ? "has" : "have", list,
                       skipped > few.size() ? "; ..." : "");
}

void warnOfSkippedPoints(const igeo::Distance& distance, RunReport& report) {
    constexpr std::size_t kNamed = 3;
    std::vector<std::string> few;
    std::size_t skipped = 0;
    const std::vector<igeo::SurfacePoint>& targets = distance.targets();
    for (std::size_t k = 0; k < targets.size(); ++k) {
        if (!targets[k].offSurface || skipped++ >= kNamed) continue;
        const igeo::SnappedPoint p = inWorld(targets[k], distance.band().transform);
        few.push_back(
            fmt::format("target {} ({}) is {}", k, textOf(p.asked, 9), igeo::skippedReason(p)));
    }
    if (skipped > 0) report.warn(skippedWarning("targets", targets.size(), few, skipped));
    few.clear(), skipped = 0;
    for (std::size_t k = 0; k < report.pairs.size(); ++k)
        if (report.pairs[k].isSkipped() && skipped++ < kNamed)
            few.push_back(fmt::format("of pair {} {}", k, report.pairs[k].reason()));
    if (skipped > 0) report.warn(skippedWarning("pairs", report.pairs.size(), few, skipped));
}

/// Of the whole surface, if its band has been made.
void warnOfSurface(const igeo::GeodesicSolver& solver, RunReport& report,
                   igeo::Progress& progress) {
    const auto band = solver.surface().madeBand(solver.bandWidth());
    if (!band) return;
    report.unresolved = solver.surface().unresolved(*band);
    report.warn(igeo::surfaceWarnings(solver, progress));
    if (report.obstacles.empty() || solver.wholeMetric(progress)->blocksAny(*band)) return;
    std::string names;
    for (const std::string& name : report.obstacles) names += (names.empty() ? "" : ", ") + name;
    report.warn("no obstacle meets the surface, so nothing is blocked: " + names);
}

void warnOfMasks(const SeedInput& seeds, const igeo::Distance& distance, RunReport& report,
                 igeo::Progress& progress) {
    constexpr std::size_t kNamed = 3;
    for (std::size_t k = 0; k < seeds.masks.size(); ++k) {
        const igeo::ObstacleSet::Parts parts = seeds.masks[k]->parts(distance.band(), progress);
        const std::size_t off = parts.off.size();
        if (off == 0) continue;
        std::string list;
        for (std::size_t p = 0; p < std::min(off, kNamed); ++p)
            list +=
                fmt::format("{}{} voxel{} around ({})", p ? "; " : "", parts.off[p].voxels,
                            parts.off[p].voxels == 1 ? "" : "s", textOf(parts.off[p].position, 6));
        report.warn(fmt::format("{} of {} parts of {} {} not meet the surface and {} no seed: {}{}",
                                off, parts.all, seeds.seeds.names[seeds.seeds.curves.size() + k],
                                off == 1 ? "does" : "do", off == 1 ? "gives" : "give", list,
                                off > kNamed ? "; ..." : ""));
    }
}

}  // namespace

void warnOfResults(const igeo::GeodesicSolver& solver, const SeedInput& seeds,
                   const igeo::Distance& distance, RunReport& report, igeo::Progress& progress) {
    const bool byJet = solver.options().scheme == igeo::Scheme::Jet;
    warnOfSurface(solver, report, progress);
    warnOfMasks(seeds, distance, report, progress);
    report.warn(igeo::marchWarnings(distance, report.sources));
    report.warn(igeo::pathWarnings(solver.surface(), byJet, report.paths));
    report.warn(igeo::pathWarnings(solver.surface(), report.pairs));
    report.warn(igeo::walkWarnings(report.walks));
    warnOfSkippedPoints(distance, report);
    report.warn(igeo::lostWarnings(distance, progress));
    report.warn(igeo::lostWarnings(solver, report.pairs, progress));
}

namespace {

/// The range of the distances, and the share of the surface that they cover.
std::string reachOf(const RunReport& report, const igeo::Distance& distance) {
    const std::shared_ptr<const igeo::Field> marched = distance.marched();
    const igeo::Field& field = *marched;
    const igeo::Extent extent = distance.extent();
    const std::string most =
        fmt::format("distances up to {:.6g}", extent.maxDistance * distance.band().transform.dx);
    const std::size_t all = extent.nodes, lost = all - extent.reached;
    if (lost == 0 && distance.ofWholeSurface()) return most + " on the whole surface";
    if (field.stoppedEarly || !distance.ofWholeSurface())
        return most + " around the seeds" +
               (report.maxDistance < igeo::kInfinity
                    ? fmt::format("; --max-distance {:.6g} leaves out the rest", report.maxDistance)
                    : "");
    return fmt::format("{}; {} of the surface is not reached, as {}", most,
                       igeo::percent(double(lost) / double(all)),
                       field.metric->obstacles ? "obstacles or gaps lie between it and the seeds"
                                               : "no seed is on its components, or gaps lie "
                                                 "between it and the seeds");
}

}  // namespace

int tell(const RunReport& report, const igeo::Distance& distance, const RunOptions& o,
         const Console& console) {
    for (const std::string& w : report.warnings) console.warning(w);
    if (const std::size_t joints = distance.band().joints)
        console.info(fmt::format(
            "{} pair{} of components of the mesh, or of rims of one, joined over gaps of "
            "up to {:.6g}",
            joints, joints == 1 ? "" : "s", report.surface.joinGaps));
    const int paths = tellPaths(report, distance, console);
    tellWalks(report, console);
    const int pairs = std::max(tellPairs(report, console), tellVias(report, console));
    if (o.hasSeeds()) console.info(reachOf(report, distance));
    for (const auto& [name, file] : report.outputs)
        if (file != "/dev/null")
            console.file(
                fmt::format("wrote {} to {}", name, file == "-" ? "standard output" : file));
    return std::max(paths, pairs);
}
