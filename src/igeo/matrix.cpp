#include <igeo/matrix.h>

#include <igeo/error.h>
#include <igeo/jet.h>
#include <igeo/parallel.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdio>
#include <cstring>

namespace igeo {

namespace {

/// The means of both directions, and by how much these differ at most.
double makeSymmetric(std::vector<double>& distance, std::size_t n) {
    double asymmetry = 0;
    for (std::size_t i = 0; i < n; ++i) {
        distance[i * n + i] = 0;
        for (std::size_t j = 0; j < i; ++j) {
            double &a = distance[i * n + j], &b = distance[j * n + i];
            if (a < kInfinity && b < kInfinity) {
                const double mean = (a + b) / 2;
                if (mean > 0) asymmetry = std::max(asymmetry, std::abs(a - b) / mean);
                a = b = mean;
            } else {
                a = b = std::min(a, b);
            }
        }
    }
    return asymmetry;
}

}  // namespace

DistanceMatrix distances(const Band& band, const MetricPtr& metric,
                         const std::vector<SurfacePoint>& seeds,
                         const std::vector<SurfacePoint>& targets, Progress& progress) {
    if (seeds.empty())
        throw Error(Error::Kind::InvalidArgument, "a distance matrix needs at least one seed");
    DistanceMatrix m{seeds, targets.empty() ? seeds : targets, {}, 0};
    m.distance.resize(m.seeds.size() * m.targets.size());
    CancelOnly quiet(progress);
    std::atomic<std::size_t> done{0};
    parallelFor(m.seeds.size(), 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) {
            SurfacePoint seed = m.seeds[k];
            seed.start = 0;
            JetOptions options;
            options.stopAt = m.targets;
            const Field field = marchJet(band, metric, {seed}, options, quiet);
            for (std::size_t t = 0; t < m.targets.size(); ++t) {
                const SurfacePoint& target = m.targets[t];
                m.distance[k * m.targets.size() + t] =
                    sampleDistance(band, field, target.pIndex, Vec3d(band.normal[target.node]));
            }
            progress.update("matrix", double(++done) / double(m.seeds.size()));
        }
    });
    if (targets.empty()) m.asymmetry = makeSymmetric(m.distance, seeds.size());
    return m;
}

std::string matrixCsv(const DistanceMatrix& m, double dx) {
    std::string text = "seed";
    for (std::size_t t = 0; t < m.targets.size(); ++t) text += "," + std::to_string(t);
    text += "\n";
    std::array<char, 32> number{};
    for (std::size_t s = 0; s < m.seeds.size(); ++s) {
        text += std::to_string(s);
        for (std::size_t t = 0; t < m.targets.size(); ++t) {
            std::snprintf(number.data(), number.size(), ",%.17g", dx * m.at(s, t));
            text += number.data();
        }
        text += "\n";
    }
    return text;
}

std::string matrixNpy(const DistanceMatrix& m, double dx) {
    // Magic, version, length of the header; the header fills the rest of a multiple of 64 bytes.
    constexpr std::size_t kFixed = 10, kAlign = 64;
    std::string header = "{'descr': '<f8', 'fortran_order': False, 'shape': (" +
                         std::to_string(m.seeds.size()) + ", " + std::to_string(m.targets.size()) +
                         "), }";
    header.resize((kFixed + header.size() + 1 + kAlign - 1) / kAlign * kAlign - kFixed - 1, ' ');
    header += '\n';
    std::string bytes = "\x93NUMPY";
    bytes += {char(1), char(0), char(header.size() & 0xff), char(header.size() >> 8)};
    bytes += header;
    for (const double d : m.distance) {
        std::uint64_t bits;
        const double world = dx * d;
        std::memcpy(&bits, &world, sizeof bits);
        for (int k = 0; k < 8; ++k) bytes += char(bits >> 8 * k & 0xff);
    }
    return bytes;
}

}  // namespace igeo
