#include <igeo/metric/unresolved_costs.h>

#include <igeo/band/detail/turned.h>
#include <igeo/band/tangent_frame.h>
#include <igeo/base/detail/text.h>
#include <igeo/base/parallel.h>
#include <igeo/base/symmetric_eigen.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numbers>

namespace igeo {

namespace {

/// The metric in the tangent plane of a node.
struct Axes {
    double ratio;  ///< of the costs along both
    Vec3d cheap;   ///< unit
};

Axes axesAt(const Band& band, const Metric& metric, NodeIndex i) {
    const Vec3d n(band.normal[i]), u = anyNormalTo(n), v = cross(n, u);
    const Tensor& g = metric.tensor[i];
    const SymmetricEigen2 e = symmetricEigen(product(g, u, u), product(g, u, v), product(g, v, v));
    // The eigenvector is that of the axis that costs more.
    return {std::sqrt(e.largest() / std::max(e.least(), 1e-30)), normalized(e.x * v - e.y * u)};
}

/// Closer nodes are left out: a small error of their places is a large one of the rate of change.
constexpr double kLeastStep = 0.7;  // voxels

/// Whether a metric turns too fast between a node and one of its neighbors.
bool turns(const Band& band, const Metric& metric, NodeIndex i) {
    constexpr double kLeastRatio = 1.5, kTurn = 0.3, kBend = 3, kSmooth = 0.8;
    const Axes here = axesAt(band, metric, i);
    if (here.ratio < kLeastRatio) return false;
    const Vec3d n(band.normal[i]), foot = band.footPoint(i);
    bool found = false;
    band.forNeighbors(&BandLeaf::band, i, [&](NodeIndex k, int, int, int) {
        if (!band.inCore(k)) return;
        const Vec3d m(band.normal[k]);
        const double step = length(band.footPoint(k) - foot), cosine = dot(n, m);
        // At a crease the normal turns at once: that is no bend.
        if (found || step < kLeastStep || cosine < kSmooth || !band.linked(i, k)) return;
        const Axes there = axesAt(band, metric, k);
        const double bend = std::acos(std::min(cosine, 1.0)) / step;
        double turn = 0;
        if (there.ratio > kLeastRatio) {
            const Vec3d along = turned(there.cheap, m, n);
            turn = std::acos(std::min(std::abs(dot(here.cheap, along)), 1.0)) / step;
        }
        const double ratio = std::min(here.ratio, there.ratio);
        found = ratio * ratio * (turn / kTurn + bend / kBend) > 1;
    });
    return found;
}

/// Whether the weight changes too fast between a node and one of its neighbors.
bool isSteep(const Band& band, const Metric& metric, NodeIndex i) {
    constexpr double kSteep = 0.4;
    const double here = double(metric.weight[i]);
    const Vec3d foot = band.footPoint(i);
    bool found = false;
    if (metric.inside(i)) return found;
    band.forNeighbors(&BandLeaf::band, i, [&](NodeIndex k, int, int, int) {
        if (found || !band.inCore(k) || metric.inside(k)) return;
        const double there = double(metric.weight[k]), step = length(band.footPoint(k) - foot);
        found = step > kLeastStep &&
                std::max(here, there) > (1 + kSteep * step) * std::min(here, there) &&
                band.linked(i, k);
    });
    return found;
}

/// Whether a narrow passage between obstacles leads over the segment from a to b, both of which are
/// inside: a part of the segment is free, and from its middle a line of 1.5 voxels to each side.
bool isPassage(const Metric& metric, const Vec3d& a, const Vec3d& b, const Vec3d& normal) {
    constexpr double kSpacing = 0.1, kNarrow = 1, kBeyond = 1.5;  // voxels
    constexpr int kSlants = 40;
    const Vec3d step = b - a, along = normalized(step), across = normalized(cross(normal, step));
    const auto isFree = [&](double t) {
        const Vec3d p = a + t * step;
        return !metric.blocked(p, p, normal);
    };
    const int count = int(std::ceil(length(step) / kSpacing));
    for (int k = 1; k < count; ++k) {
        if (!isFree(double(k) / count)) continue;
        const int first = k;
        while (k < count && isFree(double(k) / count)) ++k;
        if ((k - first) * kSpacing > kNarrow) return false;
        const Vec3d p = a + (first + k - 1) / (2.0 * count) * step;
        const auto leadsOn = [&](double side) {
            for (int slant = -kSlants; slant <= kSlants; ++slant) {
                const double angle = slant * std::numbers::pi / 3 / kSlants;
                const Vec3d line = side * std::cos(angle) * across + std::sin(angle) * along;
                if (!metric.blocked(p, p + kBeyond * line, normal)) return true;
            }
            return false;
        };
        return leadsOn(-1) && leadsOn(1);
    }
    return false;
}

/// Whether a narrow passage leads between a node inside an obstacle, beside one outside, and
/// another inside.
bool isBesidePassage(const Band& band, const Metric& metric, NodeIndex i) {
    if (!metric.inside(i)) return false;
    bool isAtRim = false, found = false;
    band.forNeighbors(&BandLeaf::band, i, [&](NodeIndex k, int, int, int) {
        isAtRim = isAtRim || (band.inCore(k) && !metric.inside(k));
    });
    const Vec3d foot = band.footPoint(i), normal(band.normal[i]);
    if (!isAtRim || !metric.blocked(foot, foot, normal)) return false;
    band.forNeighbors(&BandLeaf::band, i, [&](NodeIndex k, int, int, int) {
        if (found || k < i || !band.inCore(k) || !metric.inside(k) || !band.linked(i, k)) return;
        const Vec3d other = band.footPoint(k);
        found = metric.blocked(other, other, normal) && isPassage(metric, foot, other, normal);
    });
    return found;
}

/// Nodes to look at for a share that single ones do not decide; a quarter of them is next to S.
constexpr std::size_t kEnough = 200'000;

/// The share of the nodes next to S for which `holds` does.
/// @param most  nodes to look at
template <typename Holds>
double shareOfCore(const Band& band, const Holds& holds, std::size_t most = kEnough) {
    const std::size_t stride = (band.size() + most - 1) / std::max<std::size_t>(most, 1);
    std::atomic<std::size_t> count{0}, all{0};
    parallelFor(band.size() / std::max<std::size_t>(stride, 1), 1024,
                [&](std::size_t begin, std::size_t end) {
                    std::size_t found = 0, core = 0;
                    for (std::size_t k = begin; k < end; ++k) {
                        const auto i = NodeIndex(k * stride);
                        if (band.inCore(i)) ++core, found += holds(i);
                    }
                    count += found, all += core;
                });
    return all > 0 ? double(count) / double(all) : 0;
}

}  // namespace

double shareOfTurningTensors(const Band& band, const Metric& metric) {
    if (!metric.anisotropic()) return 0;
    return shareOfCore(band, [&](NodeIndex i) { return turns(band, metric, i); });
}

double shareOfSteepWeights(const Band& band, const Metric& metric) {
    if (metric.weight.empty()) return 0;
    return shareOfCore(band, [&](NodeIndex i) { return isSteep(band, metric, i); });
}

double shareAtNarrowPassages(const Band& band, const Metric& metric) {
    if (!metric.obstacles) return 0;
    return shareOfCore(
        band, [&](NodeIndex i) { return isBesidePassage(band, metric, i); }, band.size());
}

std::vector<std::string> costWarnings(const Band& band, const Metric& metric, bool byJet) {
    constexpr double kSteep = 0.08, kTurning = 0.01;
    std::vector<std::string> warnings;
    if (!band.spine.empty() && (metric.obstacles || metric.least() < metric.largest()))
        warnings.push_back(
            "beside " + percent(double(band.spine.size()) / double(band.coreSize())) +
            " of the surface three or more sheets of the mesh share an edge, and are too close for "
            "the voxels: where they are less than 15 degrees apart, distances with weights or "
            "obstacles are off by up to 15 voxels from sheet to sheet; use smaller voxels, or one "
            "cost everywhere");
    if (const double share = shareAtNarrowPassages(band, metric); share > 0)
        warnings.push_back("obstacles leave passages narrower than a voxel beside " +
                           percent(share) +
                           " of the surface: paths may not lead through them, and distances come "
                           "out too long; use smaller voxels, or close the passages");
    if (const double share = shareOfSteepWeights(band, metric); share > kSteep)
        warnings.push_back("on " + percent(share) +
                           " of the surface weights change by more than 40 % per voxel: distances "
                           "may be off by several percent; use smaller voxels, or smoother "
                           "weights");
    if (!byJet) return warnings;
    if (const double share = shareOfTurningTensors(band, metric); share > kTurning)
        warnings.push_back("on " + percent(share) +
                           " of the surface the cheap direction of the metric turns within too few "
                           "voxels for its ratio of costs: distances may be off by more than 5 %; "
                           "use smaller voxels, or bring the costs closer together");
    return warnings;
}

std::vector<std::string> CostWarnings::of(const Band& band, const Metric& metric, bool byJet) {
    {
        const std::lock_guard<std::mutex> lock(mutex_);
        if (found_) return *found_;
    }
    const std::vector<std::string> found = costWarnings(band, metric, byJet);
    const std::lock_guard<std::mutex> lock(mutex_);
    found_ = found;
    return found;
}

}  // namespace igeo
