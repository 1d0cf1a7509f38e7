#include <igeo/path/accuracy_estimate.h>

#include <igeo/base/parallel.h>
#include <igeo/path/straighten.h>

#include <algorithm>

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

}  // namespace

AccuracyEstimate estimateAccuracy(const Field& field, std::size_t samples, Progress& progress) {
    const Band& band = *field.band;
    AccuracyEstimate e;
    if (band.size() == 0) return e;
    if (field.solved) e.fallbackShare = double(field.fallbackCount) / double(field.solved);
    std::vector<double> error(samples, -1);
    parallelFor(samples, 1, progress, [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) {
            const auto i = NodeIndex((2 * k + 1) * band.size() / (2 * samples));
            Vec3d p = band.footPoint(i);
            if (band.triangles && k % 2 == 1) p = cornerNear(*band.triangles, p);
            Path path = tracePath(field, nearestSurfacePoint(band, p));
            straighten(field, path, progress);
            // Close to a seed the distance is exact by construction, and would lower the estimate.
            if (path.status != PathStatus::Reached || path.distance < 3 * field.startRadius)
                continue;
            const SurfacePoint& seed = field.seeds[path.seed];
            const double length = seed.start + path.weightedLength;
            error[k] = std::abs(length - path.distance) / path.distance;
        }
    });
    for (const double x : error) {
        if (x < 0) continue;
        ++e.samples;
        e.meanError += x;
        e.largestError = std::max(e.largestError, x);
    }
    if (e.samples) e.meanError /= double(e.samples);
    return e;
}

}  // namespace igeo
