#include <igeo/results/detail/openness.h>

#include <igeo/base/parallel.h>

#include <cmath>
#include <numbers>

namespace igeo {

namespace {

/// Samples per pixel; side of the pattern of their rotations
constexpr int kTaps = 8, kPattern = 4;

/// For small numbers; faster than std::lround, a function call.
int rounded(double x) { return int(x + (x < 0 ? -0.5 : 0.5)); }

class Surroundings {
public:
    Surroundings(const Frame& frame, const std::vector<Sample>& samples,
                 const std::vector<Vec3f>& normals, double radius)
        : frame_(frame),
          samples_(samples),
          normals_(normals),
          radius_(radius),
          places_(samples.size()) {
        parallelFor(std::size_t(frame.height), 16, [&](std::size_t begin, std::size_t end) {
            for (int y = int(begin); y < int(end); ++y)
                for (int x = 0; x < frame.width; ++x)
                    if (const std::size_t i = index(x, y); samples[i].covered())
                        places_[i] = double(samples[i].depth) * frame.toward(x + 0.5, y + 0.5);
        });
        // A spiral, rotated by a different angle in each pixel of the pattern.
        constexpr double kTurns = 5 * 2 * std::numbers::pi;
        for (int turn = 0; turn < kPattern * kPattern; ++turn)
            for (int k = 0; k < kTaps; ++k) {
                const double share = (k + 0.5) / kTaps,
                             angle = kTurns * share +
                                     turn * 2 * std::numbers::pi / (kPattern * kPattern);
                taps_[std::size_t(turn * kTaps + k)] = {share * std::cos(angle),
                                                        share * std::sin(angle)};
            }
    }

    /// The share of light blocked from pixel (x, y), 0 to 1, with the pattern's noise.
    double covered(int x, int y) const {
        constexpr double kFlat = 0.08;  // smaller rises are ignored: curvature, rounding
        // Neighbors in the pattern differ by about a quarter of a turn.
        static constexpr std::array<int, 16> kTurn{0, 8,  2, 10, 12, 4, 14, 6,
                                                   3, 11, 1, 9,  15, 7, 13, 5};
        const std::size_t i = index(x, y);
        const Vec3d p = places_[i], n = facing(i, p);
        const double reach = std::max(radius_ * frame_.scale / double(samples_[i].depth), 3.0);
        const int turn = kTurn[std::size_t(y % kPattern * kPattern + x % kPattern)];
        double sum = 0;
        for (int k = 0; k < kTaps; ++k) {
            const auto& tap = taps_[std::size_t(turn * kTaps + k)];
            const int u = x + rounded(reach * tap[0]), v = y + rounded(reach * tap[1]);
            if (u < 0 || v < 0 || u >= frame_.width || v >= frame_.height) continue;
            const std::size_t j = index(u, v);
            if (!samples_[j].covered()) continue;
            const Vec3d r = places_[j] - p;
            const double rise = dot(r, n), square = dot(r, r),
                         off = 1 - square / (radius_ * radius_);
            if (rise > 0 && off > 0) sum += off * std::max(0.0, rise / std::sqrt(square) - kFlat);
        }
        return std::min(1.0, 2.2 * sum / kTaps);
    }

    /// The mean of `values` over the pattern around a pixel, on its sheet.
    double smoothed(const std::vector<float>& values, int x, int y) const {
        const std::size_t i = index(x, y);
        const Vec3d p = places_[i], n(normals_[i]);
        double sum = 0, count = 0;
        for (int v = std::max(y - 1, 0); v <= std::min(y + 2, frame_.height - 1); ++v)
            for (int u = std::max(x - 1, 0); u <= std::min(x + 2, frame_.width - 1); ++u) {
                const std::size_t j = index(u, v);
                if (!samples_[j].covered()) continue;
                const Vec3d r = places_[j] - p;
                if (std::abs(dot(r, n)) > 0.1 * radius_) continue;
                sum += double(values[j]);
                ++count;
            }
        return count > 0 ? sum / count : double(values[i]);
    }

    bool seen(int x, int y) const { return samples_[index(x, y)].covered(); }
    std::size_t index(int x, int y) const {
        return std::size_t(y) * std::size_t(frame_.width) + std::size_t(x);
    }

private:
    Vec3d facing(std::size_t i, const Vec3d& fromEye) const {
        const Vec3d n(normals_[i]);
        return dot(n, fromEye) > 0 ? -n : n;
    }

    const Frame& frame_;
    const std::vector<Sample>& samples_;
    const std::vector<Vec3f>& normals_;
    double radius_;
    std::vector<Vec3d> places_;  ///< from the eye; of covered pixels
    std::array<std::array<double, 2>, std::size_t(kTaps* kPattern* kPattern)> taps_;
};

}  // namespace

std::vector<float> openness(const Frame& frame, const std::vector<Sample>& samples,
                            const std::vector<Vec3f>& normals, double radius) {
    const Surroundings around(frame, samples, normals, radius);
    std::vector<float> raw(samples.size()), open(samples.size(), 1.0f);
    auto forSeen = [&](auto visit) {
        parallelFor(std::size_t(frame.height), 8, [&](std::size_t begin, std::size_t end) {
            for (int y = int(begin); y < int(end); ++y)
                for (int x = 0; x < frame.width; ++x)
                    if (around.seen(x, y)) visit(x, y);
        });
    };
    forSeen([&](int x, int y) { raw[around.index(x, y)] = float(around.covered(x, y)); });
    forSeen(
        [&](int x, int y) { open[around.index(x, y)] = 1 - float(around.smoothed(raw, x, y)); });
    return open;
}

}  // namespace igeo
