#include "clouds.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace igeo::test {
namespace {

constexpr double kPi = 3.14159265358979323846;

/// Uniform in [-1, 1); the standard's distributions differ between libraries.
double uniform(std::mt19937& random) { return random() * std::ldexp(1.0, -31) - 1; }

double gaussian(std::mt19937& random) {
    const double u = 1 - (uniform(random) + 1) / 2;
    return std::sqrt(-2 * std::log(u)) * std::cos(kPi * uniform(random));
}

void add(PointCloud& cloud, const Vec3d& p, const Vec3d& normal, const CloudOptions& options,
         double spacing, std::mt19937& random) {
    const double off = options.noise > 0 ? options.noise * spacing * gaussian(random) : 0;
    cloud.points.push_back(p + off * normal);
    if (options.normals) cloud.normals.push_back(Vec3f(normal));
}

}  // namespace

PointCloud sphereCloud(std::size_t count, double radius, const Vec3d& center,
                       const CloudOptions& options) {
    std::mt19937 random(options.seed);
    PointCloud cloud{"sphere", {}, {}};
    const double spacing = std::sqrt(4 * kPi / double(count));
    for (std::size_t i = 0; i < count; ++i) {
        const double z = 1 - (2 * double(i) + 1) / double(count), r = std::sqrt(1 - z * z);
        const double turn = double(i) * kPi * (3 - std::sqrt(5.0));
        const Vec3d jitter{uniform(random), uniform(random), uniform(random)};
        const Vec3d n =
            normalized(Vec3d{r * std::cos(turn), r * std::sin(turn), z} + (0.3 * spacing) * jitter);
        add(cloud, center + radius * n, n, options, radius * spacing, random);
    }
    return cloud;
}

PointCloud torusCloud(std::size_t count, double majorRadius, double minorRadius,
                      const Vec3d& center, const CloudOptions& options) {
    std::mt19937 random(options.seed);
    PointCloud cloud{"torus", {}, {}};
    const double spacing = 2 * kPi * std::sqrt(majorRadius * minorRadius / double(count));
    while (cloud.points.size() < count) {
        const double u = kPi * uniform(random), v = kPi * uniform(random);
        const double axis = majorRadius + minorRadius * std::cos(v);
        if ((uniform(random) + 1) / 2 * (majorRadius + minorRadius) > axis) continue;
        const Vec3d n{std::cos(u) * std::cos(v), std::sin(u) * std::cos(v), std::sin(v)};
        const Vec3d p{axis * std::cos(u), axis * std::sin(u), minorRadius * std::sin(v)};
        add(cloud, center + p, n, options, spacing, random);
    }
    return cloud;
}

PointCloud squareCloud(int n, double spacing, const CloudOptions& options) {
    std::mt19937 random(options.seed);
    PointCloud cloud{"square", {}, {}};
    for (int x = 0; x <= n; ++x)
        for (int y = 0; y <= n; ++y) {
            Vec3d p(x, y, 0);
            if (x > 0 && x < n) p.x += 0.3 * uniform(random);
            if (y > 0 && y < n) p.y += 0.3 * uniform(random);
            add(cloud, spacing * p, {0, 0, 1}, options, spacing, random);
        }
    return cloud;
}

PointCloud movedCloud(PointCloud cloud, const std::function<Vec3d(const Vec3d&)>& map) {
    for (Vec3d& p : cloud.points) p = map(p);
    for (Vec3f& n : cloud.normals) n = Vec3f(normalized(map(Vec3d(n)) - map({})));
    return cloud;
}

PointCloud shuffledCloud(const PointCloud& cloud, unsigned seed) {
    std::mt19937 random(seed);
    std::vector<std::size_t> order(cloud.points.size());
    std::iota(order.begin(), order.end(), std::size_t(0));
    for (std::size_t i = order.size(); i > 1; --i) std::swap(order[i - 1], order[random() % i]);
    PointCloud out{cloud.file, {}, {}};
    for (const std::size_t i : order) {
        out.points.push_back(cloud.points[i]);
        if (!cloud.normals.empty()) out.normals.push_back(cloud.normals[i]);
    }
    return out;
}

PointCloud joinedClouds(PointCloud a, const PointCloud& b) {
    a.points.insert(a.points.end(), b.points.begin(), b.points.end());
    a.normals.insert(a.normals.end(), b.normals.begin(), b.normals.end());
    return a;
}

}  // namespace igeo::test
