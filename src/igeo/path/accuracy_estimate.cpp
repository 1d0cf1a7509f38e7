#include <igeo/path/accuracy_estimate.h>

#include <igeo/base/parallel.h>
#include <igeo/path/straighten.h>

#include <algorithm>

namespace igeo {

AccuracyEstimate estimateAccuracy(const Field& field, std::size_t samples, Progress& progress) {
    const Band& band = *field.band;
    AccuracyEstimate e;
    if (band.size() == 0) return e;
    if (field.solved) e.fallbackShare = double(field.fallbackCount) / double(field.solved);
    std::vector<double> error(samples, -1);
    parallelFor(samples, 1, progress, [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) {
            const auto i = NodeIndex((2 * k + 1) * band.size() / (2 * samples));
            SurfacePoint target;
            target.node = i;
            target.pIndex = target.askedIndex = band.footPoint(i);
            projectToSurface(band, target.pIndex);
            Path path = tracePath(field, target);
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
