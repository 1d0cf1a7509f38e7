#include <igeo/march/field.h>

#include <igeo/base/parallel.h>
#include <igeo/march/detail/jet_state.h>

#include <cmath>
#include <optional>

namespace igeo {

std::size_t Field::size() const { return core ? core->state.size() : distance.size(); }

void Field::summarize() {
    constexpr std::size_t kChunk = 1 << 16;
    struct Part {
        std::size_t reached = 0;
        double largest = 0;
    };
    const std::size_t n = size();
    std::vector<Part> parts((n + kChunk - 1) / kChunk);
    auto summarizeAll = [&](const auto& valueAt) {
        parallelFor(parts.size(), 1, [&](std::size_t begin, std::size_t end) {
            for (std::size_t c = begin; c < end; ++c) {
                Part part;
                for (std::size_t k = c * kChunk; k < std::min(n, (c + 1) * kChunk); ++k) {
                    const double d = valueAt(k);
                    const bool isReached = d < kInfinity;
                    part.reached += isReached;
                    part.largest = std::max(part.largest, isReached ? d : 0);
                }
                parts[c] = part;
            }
        });
    };
    if (core)
        summarizeAll([&](std::size_t k) {
            const double d = core->marchedValueOf(NodeIndex(k));
            return d <= limit ? d : kInfinity;
        });
    else
        summarizeAll([&](std::size_t k) { return distance[k]; });
    source = sourcesOf(seeds);
    const bool pages = band && (!band->spine.empty() || band->ways);
    seedsNear = SeedsNear(seeds, pages ? Band::kSpineReach : startRadius);
    if (!seeds.empty())
        leastStart = std::min_element(seeds.begin(), seeds.end(), [](auto& a, auto& b) {
                         return a.start < b.start;
                     })->start;
    reached = 0;
    maxDistance = 0;
    for (const Part& part : parts) {
        reached += part.reached;
        maxDistance = std::max(maxDistance, part.largest);
    }
}

namespace {

/// Difference along one axis over reached neighbors that no obstacle hides; 0 without any.
double axisDifference(const Field& field, NodeIndex i, int axis) {
    const Band& band = *field.band;
    const std::vector<double>& d = field.distance;
    const NodeIndex lo = band.neighbor(i, Band::faceStep(2 * axis));
    const NodeIndex hi = band.neighbor(i, Band::faceStep(2 * axis + 1));
    auto counts = [&](NodeIndex j) {
        return j != kNoNode && d[j] < kInfinity && !band.severed(i, j) &&
               !field.metric->blocked(band, i, j);
    };
    const bool hasLo = counts(lo), hasHi = counts(hi);
    if (hasLo && hasHi) {
        // Where both neighbors lie below d[i], two fronts meet: the central difference cancels, and
        // d falls to both sides.
        if (d[lo] < d[i] && d[hi] < d[i]) return d[lo] <= d[hi] ? d[i] - d[lo] : d[hi] - d[i];
        return (d[hi] - d[lo]) / 2;
    }
    if (hasLo) return d[i] - d[lo];
    if (hasHi) return d[hi] - d[i];
    return 0;
}

}  // namespace

std::vector<Vec3f> surfaceGradient(const Field& field) {
    const Band& band = *field.band;
    std::vector<Vec3f> gradient(band.size());
    parallelFor(band.size(), 4096, [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) {
            const auto i = NodeIndex(k);
            if (!(field.distance[i] < kInfinity)) continue;
            const Vec3d g{axisDifference(field, i, 0), axisDifference(field, i, 1),
                          axisDifference(field, i, 2)};
            gradient[i] = Vec3f(tangential(g, Vec3d(band.normal[i])));
        }
    });
    return gradient;
}

namespace {

/// The weight at a part of the line from a seed to a point near it; none away from S.
std::optional<double> weightBetween(const Band& band, const Metric& metric,
                                    const SurfacePoint& seed, const Vec3d& pIndex, double part) {
    const Vec3d from = seed.nearestTo(pIndex);
    const SurfaceCell cell(band, metric, from + part * (pIndex - from), Vec3d(seed.normal));
    return cell.empty() ? std::nullopt : std::optional(metric.at(cell));
}

}  // namespace

bool costsJump(const Band& band, const Metric& metric, const SurfacePoint& seed,
               const Vec3d& pIndex, double here) {
    // A weight that changes evenly does so by a quarter of its change on a quarter of the line.
    constexpr double kNextTo = 1.5, kEven = 1.3, kJump = 0.45;  // kNextTo: voxels
    if (metric.weight.empty() || length(pIndex - seed.nearestTo(pIndex)) <= kNextTo) return false;
    const double change = std::log(here / seed.weight);
    if (std::abs(change) <= std::log(kEven)) return false;
    double last = seed.weight;
    for (const double part : {0.25, 0.5, 0.75, 1.0}) {
        const std::optional<double> next =
            part < 1 ? weightBetween(band, metric, seed, pIndex, part) : here;
        if (!next || std::abs(std::log(*next / last)) > kJump * std::abs(change)) return true;
        last = *next;
    }
    return false;
}

double meanFromSeed(const Band& band, const Metric& metric, const SurfacePoint& seed,
                    const Vec3d& pIndex, double here) {
    const double mean = (seed.weight + here) / 2;
    if (metric.weight.empty()) return mean;
    const std::optional<double> middle = weightBetween(band, metric, seed, pIndex, 0.5);
    return middle ? (mean + 2 * *middle) / 3 : mean;
}

double costToSeed(const Field& field, const SurfacePoint& seed, const Vec3d& pIndex,
                  const Vec3d& normal, double here) {
    const Vec3d chord = seed.nearestTo(pIndex) - pIndex;
    const double r = length(chord);
    if (!field.metric->anisotropic()) return meanToSeed(field, seed, pIndex, here) * r;
    const SurfaceCell middle(*field.band, *field.metric, pIndex + 0.5 * chord, normal);
    const Vec3d along = normalized(tangential(chord, middle.empty() ? normal : middle.normal));
    return r * (middle.empty() ? field.metric->stepCost(seed.node, along)
                               : field.metric->stepCost(middle, along));
}

SurfaceCell::SurfaceCell(const Band& band, const Metric& metric, const Vec3d& pIndex,
                         const Vec3d& sheetNormal)
    : BandCell(cellAt(band, pIndex)), normal(dropFacingCorners(band, *this, sheetNormal)) {
    metric.dropHiddenCorners(band, pIndex, normal, *this);
}

double segmentCost(const Band& band, const Metric& metric, const Vec3d& a, const Vec3d& b,
                   const Vec3d& sheetNormal) {
    if (!metric.weighted()) return length(b - a);
    return (metric.stepCost(SurfaceCell(band, metric, a, sheetNormal), b - a) +
            metric.stepCost(SurfaceCell(band, metric, b, sheetNormal), b - a)) /
           2;
}

}  // namespace igeo
