#include <igeo/metric/turning_tensors.h>

#include <igeo/band/tangent_frame.h>
#include <igeo/base/parallel.h>
#include <igeo/base/symmetric_eigen.h>

#include <algorithm>
#include <atomic>
#include <cmath>

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

/// Whether a metric turns too fast between a node and one of its neighbors.
bool turns(const Band& band, const Metric& metric, NodeIndex i) {
    constexpr double kLeastRatio = 1.5, kTurn = 0.3, kBend = 3, kSmooth = 0.8, kLeastStep = 0.7;
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
            // The least rotation that takes one normal to the other.
            const Vec3d along = there.cheap - (dot(there.cheap, n) / (1 + cosine)) * (m + n);
            turn = std::acos(std::min(std::abs(dot(here.cheap, along)), 1.0)) / step;
        }
        const double ratio = std::min(here.ratio, there.ratio);
        found = ratio * ratio * (turn / kTurn + bend / kBend) > 1;
    });
    return found;
}

}  // namespace

double shareOfTurningTensors(const Band& band, const Metric& metric) {
    if (!metric.anisotropic()) return 0;
    std::atomic<std::size_t> count{0}, all{0};
    parallelFor(band.size(), 1024, [&](std::size_t begin, std::size_t end) {
        std::size_t turning = 0, core = 0;
        for (auto i = NodeIndex(begin); i < end; ++i)
            if (band.inCore(i)) ++core, turning += turns(band, metric, i);
        count += turning, all += core;
    });
    return all > 0 ? double(count) / double(all) : 0;
}

}  // namespace igeo
