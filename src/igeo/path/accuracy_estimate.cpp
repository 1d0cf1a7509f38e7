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

/// By how much the length of a path is off in the mean, relative to itself, as S rises and falls.
double errorByHeights(const Band& band, Path path, double heightNoise) {
    if (!(heightNoise > 0)) return 0;
    addNormals(band, path);
    double curvature2 = 0;
    for (std::size_t k = 1; k < path.vertices.size(); ++k) {
        const PathVertex &a = path.vertices[k - 1], &b = path.vertices[k];
        const Vec3d step = b.pIndex - a.pIndex;
        const double len = length(step);
        if (!(len > 0)) continue;
        const double turn = dot(b.normal - a.normal, step) / len;
        curvature2 += turn * turn / len;
    }
    const double meanOfDeviation = std::sqrt(2 / std::numbers::pi);  // of a normal distribution
    return meanOfDeviation * std::sqrt(heightNoise * curvature2) / path.length;
}

}  // namespace

AccuracyEstimate estimateAccuracy(const Field& field, double heightNoise, Progress& progress) {
    constexpr std::size_t kOnTriangles = 64, kElsewhere = 16;
    const Band& band = *field.band;
    AccuracyEstimate e;
    if (band.size() == 0) return e;
    if (field.solved) e.fallbackShare = double(field.fallbackCount) / double(field.solved);
    // Straightening forgives coarse steps.
    TraceOptions trace{.maxStep = 2, .tolerance = 0.01};
    trace.rough = hasExactCurves(field);
    const std::size_t samples = trace.rough ? kOnTriangles : kElsewhere;
    std::vector<double> error(samples, -1);
    parallelFor(samples, 1, progress, [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) {
            const auto i = NodeIndex((2 * k + 1) * band.size() / (2 * samples));
            Vec3d p = band.footPoint(i);
            if (band.triangles && k % 2 == 1) p = cornerNear(*band.triangles, p);
            const Path path = tracePath(field, nearestSurfacePoint(band, p), trace);
            // Close to a seed the distance is exact by construction, and would lower the estimate.
            if (path.status != PathStatus::Reached || path.distance < 3 * field.startRadius)
                continue;
            const SurfacePoint& seed = field.seeds[path.seed];
            const double length = seed.start + straightenedLength(field, path, progress);
            error[k] = std::hypot(std::abs(length - path.distance) / path.distance,
                                  errorByHeights(band, path, heightNoise));
        }
    });
    std::erase_if(error, [](double x) { return x < 0; });
    e.samples = error.size();
    e.meanError = steadyMean(error);
    for (const double x : error) e.largestError = std::max(e.largestError, x);
    return e;
}

}  // namespace igeo
