#include <igeo/results/distance_matrix.h>

#include <fmt/core.h>
#include <igeo/base/error.h>
#include <igeo/base/parallel.h>
#include <igeo/march/jet.h>
#include <igeo/results/detail/npy.h>

#include <algorithm>
#include <atomic>
#include <cstring>
#include <limits>

namespace igeo {

void makeSymmetric(DistanceMatrix& m) {
    const std::size_t n = m.seeds.size();
    m.asymmetry = 0;
    for (std::size_t i = 0; i < n; ++i) {
        m.distance[i * n + i] = 0;
        for (std::size_t j = 0; j < i; ++j) {
            double &a = m.distance[i * n + j], &b = m.distance[j * n + i];
            if (a < kInfinity && b < kInfinity) {
                const double mean = (a + b) / 2;
                if (mean > 0) m.asymmetry = std::max(m.asymmetry, std::abs(a - b) / mean);
                a = b = mean;
            } else {
                a = b = std::min(a, b);
            }
        }
    }
}

DistanceMatrix distanceRows(const Band& band, const MetricPtr& metric,
                            const std::vector<SurfacePoint>& seeds,
                            const std::vector<SurfacePoint>& targets, std::size_t firstRow,
                            std::size_t endRow, Progress& progress) {
    if (seeds.empty())
        throw Error(Error::Kind::InvalidArgument, "a distance matrix needs at least one seed");
    DistanceMatrix m{seeds, targets.empty() ? seeds : targets, firstRow, {}, 0};
    if (targets.empty()) m.asymmetry = std::numeric_limits<double>::quiet_NaN();
    const std::size_t rows = endRow - firstRow, columns = m.targets.size();
    m.distance.resize(rows * columns);
    CancelOnly quiet(progress);
    std::atomic<std::size_t> done{0};
    parallelFor(rows, 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) {
            SurfacePoint seed = m.seeds[firstRow + k];
            seed.start = 0;
            JetOptions options;
            options.stopAt = m.targets;
            const Field field = marchJet(band, metric, {seed}, options, quiet);
            for (std::size_t t = 0; t < columns; ++t) {
                const SurfacePoint& target = m.targets[t];
                // In world units here, so that rows read from files have the same bits.
                m.distance[k * columns + t] =
                    band.transform.dx *
                    sampleDistance(field, target.pIndex, Vec3d(band.normal[target.node]));
            }
            progress.update("matrix", double(++done) / double(rows));
        }
    });
    return m;
}

DistanceMatrix distances(const Band& band, const MetricPtr& metric,
                         const std::vector<SurfacePoint>& seeds,
                         const std::vector<SurfacePoint>& targets, Progress& progress) {
    DistanceMatrix m = distanceRows(band, metric, seeds, targets, 0, seeds.size(), progress);
    if (targets.empty()) makeSymmetric(m);
    return m;
}

std::string matrixCsv(const DistanceMatrix& m) {
    std::string text = "seed";
    for (std::size_t t = 0; t < m.targets.size(); ++t) text += fmt::format(",{}", t);
    text += "\n";
    for (std::size_t s = m.firstRow; s < m.firstRow + m.rows(); ++s) {
        text += std::to_string(s);
        for (std::size_t t = 0; t < m.targets.size(); ++t)
            text += fmt::format(",{:.17g}", m.at(s, t));
        text += "\n";
    }
    return text;
}

std::string matrixNpy(const DistanceMatrix& m) {
    return npy(m.distance, fmt::format("({}, {})", m.rows(), m.targets.size()));
}

}  // namespace igeo
