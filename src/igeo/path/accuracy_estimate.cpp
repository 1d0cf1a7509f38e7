#include <igeo/path/accuracy_estimate.h>

#include <igeo/base/parallel.h>
#include <igeo/path/curve_normals.h>
#include <igeo/path/detail/curve_on_triangles.h>
#include <igeo/path/straighten.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace igeo {

namespace {

/// The corner nearest to a point on S, of the triangle that it lies on.
Vec3d cornerNear(const SurfaceTriangles& triangles, const Vec3d& p) {
    const std::uint32_t t = triangles.nearest(p).triangle;
    Vec3d best = triangles.corner(t, 0);
    for (unsigned k = 1; k < 3; ++k)
        if (const Vec3d c = triangles.corner(t, k); length(c - p) < length(best - p)) best = c;
    return best;
}

/// The mean, in which no value counts more than half their number times the median: one alone then
/// adds no more than half a median.
double steadyMean(std::vector<double> values) {
    if (values.empty()) return 0;
    const auto middle = values.begin() + std::ptrdiff_t(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    const double most = double(values.size()) / 2 * *middle;
    double sum = 0;
    for (const double x : values) sum += std::min(x, most);
    return sum / double(values.size());
}

/// How S rounds an edge off. A geodesic over an edge of angle a becomes shorter by a share of a^2,
/// and its curvature shows a: the loss is `perBend` times the integral of
/// (k(s + apart) - k(s))^2 / 2, in which k is `sharpest` at most. Scatter alone makes `byScatter`
/// of that per length. Voxels.
struct Rounding {
    double apart, sharpest, perBend, byScatter;
};

/// Voxels round an edge to an arc about 1.1 voxels long, which is 1.1 a^2 / 12 shorter. The
/// integral of k^2 over it is a^2 / 1.1. Distances lose less at sharp edges.
constexpr Rounding kByVoxels{3, 1.2, 0.1, 0};

/// A fit to points rounds an edge over its radius r, whatever the voxels: 0.044 r a^2 is lost. The
/// fewer points beyond its unknowns a fit has, the nearer it passes to them, and the less is lost.
/// The curvature there is up to 1.6 a / r, or what voxels leave of that. A quadric follows slow
/// changes of curvature, so places that are compared are not farther apart than the arc.
Rounding roundingBy(const FitError& fit) {
    const double r = fit.radius, seen = std::hypot(r, 1.8);
    if (!(r > 0)) return kByVoxels;
    return {0.6 * seen, 2.1 / seen, r * seen * fit.freedom / 20,
            120 * fit.heightNoise / std::pow(seen, 5)};
}

/// Integrals along a geodesic, of its normal curvature k.
struct Bending {
    double square = 0;  ///< of k^2
    double uneven = 0;  ///< of (k(s + apart) - k(s))^2 / 2: none where S is smooth
};

Bending bendingOf(const Band& band, Path path, const Rounding& rounding) {
    addNormals(band, path);
    const std::vector<PathVertex>& v = path.vertices;
    std::vector<double> curvature(v.size(), 0);
    Bending bending;
    for (std::size_t k = 1, before = 1; k < v.size(); ++k) {
        const Vec3d step = v[k].pIndex - v[k - 1].pIndex;
        const double squared = dot(step, step), len = std::sqrt(squared);
        if (!(squared > 0)) continue;
        const double bend = dot(v[k].normal - v[k - 1].normal, step) / squared;
        bending.square += bend * bend * len;
        curvature[k] = std::clamp(bend, -rounding.sharpest, rounding.sharpest);
        while (v[k].arcLength - v[before].arcLength > rounding.apart) ++before;
        if (before == 1) continue;
        const double change = curvature[k] - curvature[before];
        bending.uneven += change * change / 2 * len;
    }
    return bending;
}

/// By how much the length of a path may be off as S bends, relative to itself.
double errorByBends(const Band& band, const Path& path, const FitError& fit) {
    const double meanOfDeviation = std::sqrt(2 / std::numbers::pi);  // of a normal distribution
    const Rounding rounding = roundingBy(fit);
    const Bending bending = bendingOf(band, path, rounding);
    const double byEdges = std::max(0.0, bending.uneven - rounding.byScatter * path.length);
    return std::hypot(rounding.perBend * byEdges,
                      meanOfDeviation * std::sqrt(fit.heightNoise * bending.square)) /
           path.length;
}

/// Nodes spread over what the field reaches.
std::vector<NodeIndex> spread(const Field& field, std::size_t count) {
    constexpr std::size_t kMostTried = 1 << 16;
    const std::size_t size = field.band->size();
    std::vector<NodeIndex> reached;
    if (field.reached < field.size()) {
        std::vector<NodeIndex> tried;
        for (std::size_t i = 0; i < size; i += size / kMostTried + 1) tried.push_back(NodeIndex(i));
        std::vector<NodeJet> jets(tried.size());
        field.at(tried, jets.data());
        for (std::size_t k = 0; k < tried.size(); ++k)
            if (jets[k].distance < kInfinity) reached.push_back(tried[k]);
    }
    std::vector<NodeIndex> nodes(count);
    for (std::size_t k = 0; k < count; ++k)
        nodes[k] = reached.empty() ? NodeIndex((2 * k + 1) * size / (2 * count))
                                   : reached[(2 * k + 1) * reached.size() / (2 * count)];
    return nodes;
}

}  // namespace

AccuracyEstimate estimateAccuracy(const Field& field, const FitError& fit, Progress& progress) {
    constexpr std::size_t kOnTriangles = 64, kElsewhere = 16;
    const Band& band = *field.band;
    AccuracyEstimate e;
    if (band.size() == 0) return e;
    if (field.solved) e.fallbackShare = double(field.fallbackCount) / double(field.solved);
    // Straightening forgives coarse steps.
    TraceOptions trace{.maxStep = 2, .tolerance = 0.01};
    trace.rough = hasExactCurves(field);
    const std::size_t samples = trace.rough ? kOnTriangles : kElsewhere;
    const std::vector<NodeIndex> nodes = spread(field, samples);
    std::vector<double> error(samples, -1);
    parallelFor(samples, 1, progress, [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) {
            Vec3d p = band.footPoint(nodes[k]);
            if (band.triangles && k % 2 == 1) p = cornerNear(*band.triangles, p);
            const Path path = tracePath(field, nearestSurfacePoint(band, p), trace);
            // Close to a seed the distance is exact by construction, and would lower the estimate.
            if (path.status != PathStatus::Reached || path.distance < 3 * field.startRadius)
                continue;
            const Path straight = straightened(field, path, progress);
            const double start = field.seeds[path.seed].start;
            error[k] = std::abs(start + straight.weightedLength - path.distance) / path.distance;
            if (!band.triangles) error[k] = std::hypot(error[k], errorByBends(band, straight, fit));
        }
    });
    std::erase_if(error, [](double x) { return x < 0; });
    e.samples = error.size();
    e.meanError = steadyMean(error);
    for (const double x : error) e.largestError = std::max(e.largestError, x);
    return e;
}

}  // namespace igeo
