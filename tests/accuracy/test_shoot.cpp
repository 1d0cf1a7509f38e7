// The exponential map against exact geodesics: where a walk ends, in % of its length.
#include <igeo/geodesic_solver.h>
#include <support/catch.h>
#include <support/errors.h>
#include <support/openvdb.h>
#include <support/shapes.h>
#include <support/torus_geodesics.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>

namespace igeo::test {
namespace {

using openvdb::Vec3d;

GeodesicSolver solverOn(const Shape& shape, int n) {
    const auto transform = rotatedTransform(1.0 / n, {1, 2, 3}, 20, {0.1, 0.2, 0.3});
    return GeodesicSolver(Surface(*makeLevelSet(shape, *transform, 3)));
}

/// Where a walk should end: start, direction, length; world units.
using Exact = std::function<Vec3d(const Vec3d&, const Vec3d&, double)>;

struct Miss {
    double mean = 0;   ///< % of the length
    double worst = 0;  ///< % of the length, or of the spread of geodesics where that is more

    Miss(const GeodesicSolver& solver, const Vec3d& start, double length, const Exact& exact) {
        constexpr int kWalks = 12;
        auto vdb = [](const igeo::Vec3d& p) { return Vec3d(p.x, p.y, p.z); };
        for (int k = 1; k <= kWalks; ++k) {
            const Vec3d direction = genericDirection(k);
            const Polyline path = solver.shoot(fromVdb(start), fromVdb(direction), length);
            REQUIRE(path.status == PathStatus::Reached);
            const Vec3d at = vdb(path.points.front());
            const Vec3d end = exact(at, direction, length);
            const double off = (vdb(path.points.back()) - end).length();
            // Geodesics that start side by side are this far apart in the end, per angle.
            const Vec3d turned = direction + 1e-5 * genericDirection(k + 100);
            const double spread = (exact(at, turned, length) - end).length() / 1e-5;
            mean += 100 * off / length / kWalks;
            worst = std::max(worst, 100 * off / std::max(length, spread));
        }
    }
};

}  // namespace

TEST_CASE("shoot on the sphere: three turns") {
    const double radius = 0.4, length = 6 * M_PI * radius;
    const auto exact = [&](const Vec3d& p, const Vec3d& direction, double l) {
        const Vec3d out = (p - kCenter).unit();
        const Vec3d along = (direction - direction.dot(out) * out).unit();
        return kCenter + radius * (std::cos(l / radius) * out + std::sin(l / radius) * along);
    };
    std::vector<double> dx, mean;
    for (const int n : {25, 50, 100, 200}) {
        const GeodesicSolver solver = solverOn(sphere(kCenter, radius), n);
        const Miss m(solver, kCenter + radius * genericDirection(), length, exact);
        std::printf("shoot, sphere N = %3d: mean %.5f %%, worst %.5f %%\n", n, m.mean, m.worst);
        CHECK(m.worst < 0.003);  // measured 0.0020
        dx.push_back(1.0 / n), mean.push_back(m.mean);
    }
    CHECK(fittedRate(dx, mean) > 1.8);
}

// Twice around the axis, five times around the tube. Next to the inner circle geodesics part
// exponentially: where a small angle at the start moves the end by more than the length (by up to
// 30 times it here), the miss is compared with that.
TEST_CASE("shoot on the torus: several turns") {
    const double length = 4, tube = 0.12;
    const auto exact = [&](const Vec3d& p, const Vec3d& direction, double l) {
        return walkOnTorus(kCenter, 0.3, tube, p, direction, l);
    };
    std::vector<double> dx, mean;
    for (const int n : {50, 100, 200}) {
        const GeodesicSolver solver = solverOn(torus(kCenter, 0.3, tube), n);
        double sum = 0, worst = 0;
        for (const double k : {1, 2, 3}) {
            const Vec3d out(std::cos(k), std::sin(k), 0), up(0, 0, 1);
            const Vec3d start =
                kCenter + 0.3 * out + tube * (std::cos(2 * k) * out + std::sin(2 * k) * up);
            const Miss m(solver, start, length, exact);
            sum += m.mean / 3, worst = std::max(worst, m.worst);
        }
        std::printf("shoot, torus N = %3d: mean %.5f %%, worst %.5f %%\n", n, sum, worst);
        if (n >= 100) CHECK(worst < 0.057);  // measured 0.037
        dx.push_back(1.0 / n), mean.push_back(sum);
    }
    CHECK(fittedRate(dx, mean) > 1.4);
}

}  // namespace igeo::test
