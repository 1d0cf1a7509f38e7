#include <igeo/metric/slope.h>

#include <fmt/core.h>
#include <igeo/base/error.h>
#include <igeo/base/parallel.h>

#include <cmath>
#include <numbers>
#include <utility>

namespace igeo {

namespace {

void check(const SlopeWeight& slope) {
    if (std::abs(length(slope.up) - 1) < 1e-6 && slope.steepest > 0 &&
        slope.steepest < std::numbers::pi / 2 && slope.power > 0 && std::isfinite(slope.power))
        return;
    throw Error(Error::Kind::InvalidArgument,
                fmt::format("a slope of {} radians at most, to the power of {}; allowed are angles "
                            "above 0 and below pi/2, powers above 0, and a direction of length 1",
                            slope.steepest, slope.power));
}

/// `up` in the axes of the index space, unit.
Vec3d upInIndex(const Similarity& transform, const Vec3d& up) {
    return normalized(transform.indexFromWorld(up) - transform.indexFromWorld({}));
}

class SteepObstacles final : public Obstacles {
public:
    SteepObstacles(const Vec3d& up, double leastCosine, std::shared_ptr<const Obstacles> others)
        : up_(up), leastCosine_(leastCosine), others_(std::move(others)) {}

    bool block(const Vec3d& a, const Vec3d& b, const Vec3d& normal) const override {
        return std::abs(dot(normal, up_)) < leastCosine_ ||
               (others_ && others_->block(a, b, normal));
    }
    bool mayBeNear(const Vec3d&, double) const override { return true; }

private:
    Vec3d up_;
    double leastCosine_;
    std::shared_ptr<const Obstacles> others_;
};

}  // namespace

std::vector<float> slopeWeights(const Band& band, const SlopeWeight& slope) {
    check(slope);
    const Vec3d up = upInIndex(band.transform, slope.up);
    const double most = std::tan(slope.steepest);
    std::vector<float> weights(band.size());
    parallelFor(band.size(), 4096, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const Vec3d n = normalized(Vec3d(band.normal[i]));
            const double tangent = length(cross(n, up)) / std::max(std::abs(dot(n, up)), 1e-12);
            weights[i] = float(1 + std::pow(std::min(tangent / most, 1.0), slope.power));
        }
    });
    return weights;
}

std::shared_ptr<const Obstacles> steepObstacles(const Similarity& transform,
                                                const SlopeWeight& slope,
                                                std::shared_ptr<const Obstacles> others) {
    check(slope);
    // Rounding of normals must not block a plane at the limit.
    constexpr double kRounding = 1e-6;
    return std::make_shared<SteepObstacles>(
        upInIndex(transform, slope.up), std::cos(slope.steepest) - kRounding, std::move(others));
}

}  // namespace igeo
