// Unions of level sets, psi = min(a, b), over the hollow edge in which two bodies meet: against
// great circles to the points of the edge.
#include <igeo/geodesic_solver.h>
#include <support/catch.h>
#include <support/errors.h>
#include <support/openvdb.h>
#include <support/random_surface.h>
#include <support/shapes.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <vector>

namespace igeo::test {
namespace {

using openvdb::Vec3d;

/// Two balls with centers on the z axis whose spheres meet in a circle about the origin.
struct TwoBalls {
    static constexpr double kRadius = 21;
    double neck;  ///< radius of the circle
    double toCenter() const { return std::sqrt(kRadius * kRadius - neck * neck); }
    Vec3d center(int ball) const { return Vec3d(0, 0, ball == 0 ? -toCenter() : toCenter()); }

    Shape shape() const {
        Shape shape;
        shape.sdf = [a = center(0), b = center(1)](const Vec3d& p) {
            return std::min((p - a).length(), (p - b).length()) - kRadius;
        };
        for (const int ball : {0, 1})
            shape.bounds.expand(center(ball) - Vec3d(kRadius)),
                shape.bounds.expand(center(ball) + Vec3d(kRadius));
        return shape;
    }
    /// A point of one ball outside of the other one.
    Vec3d pointOf(int ball, Random& random) const {
        for (;;) {
            const Vec3d p = center(ball) + kRadius * random.direction();
            if ((p - center(1 - ball)).length() > kRadius) return p;
        }
    }
    static constexpr std::size_t kPoints = 720;  ///< of the circle
    /// Distances over one ball to points of the circle: great circles that do not enter the other
    /// ball, and along the circle from there.
    std::vector<double> toCircle(int ball, const Vec3d& p) const {
        const double wide = std::asin(neck / kRadius), step = 2 * M_PI * neck / kPoints;
        const Vec3d axis(0, 0, ball == 0 ? 1 : -1), from = (p - center(ball)) / kRadius;
        // The plane of a great circle that touches the circle is as far from the axis.
        const double polar = std::acos(axis.dot(from)), touching = std::tan(wide) / std::tan(polar),
                     around = std::atan2(from.y(), from.x());
        std::vector<double> to(kPoints, kInfinity);
        for (std::size_t k = 0; k < kPoints; ++k) {
            const double at = 2 * M_PI * double(k) / kPoints;
            if (std::cos(at - around) < touching) continue;
            to[k] = kRadius * std::acos(std::clamp(
                                  std::cos(wide) * axis.dot(from) +
                                      std::sin(wide) * std::sin(polar) * std::cos(at - around),
                                  -1.0, 1.0));
        }
        for (int lap = 0; lap < 2; ++lap)
            for (std::size_t k = 0; k < kPoints; ++k) {
                const std::size_t next = (k + 1) % kPoints, back = kPoints - 1 - k,
                                  beforeBack = (back + kPoints - 1) % kPoints;
                to[next] = std::min(to[next], to[k] + step);
                to[beforeBack] = std::min(to[beforeBack], to[back] + step);
            }
        return to;
    }
};

}  // namespace

TEST_CASE("union edges: fronts go from ball to ball over a narrow neck") {
    struct Case {
        double neck, low, high;
    };
    // Measured -3.70 to 0.74, -2.49 to 0.30, -1.54 to 0.08 and -0.63 to 0.01 voxels. Where psi
    // stays as it is, a fifth of the points behind the two narrowest necks are not reached, others
    // are up to 3.6 voxels too far, and 2.2 behind a neck of 6 voxels.
    for (const auto& [neck, least, most] :
         {Case{2, -5.6, 1.2}, Case{3.6, -3.8, 0.45}, Case{6, -2.4, 0.12}, Case{10, -0.95, 0.02}}) {
        const TwoBalls balls{neck};
        double low = kInfinity, high = -kInfinity, sum = 0;
        std::size_t count = 0, unreached = 0;
        for (unsigned place = 0; place < 5; ++place) {
            Random random(place + 1);
            const auto voxels = rotatedTransform(
                1, random.direction(), place == 0 ? 0 : random.between(0, 360),
                {random.between(0, 1), random.between(0, 1), random.between(0, 1)});
            const Vec3d seed = balls.pointOf(0, random);
            const std::vector<double> fromSeed = balls.toCircle(0, seed);
            const Distance d = GeodesicSolver(Surface(*makeLevelSet(balls.shape(), *voxels, 3)))
                                   .distance({fromVdb(seed)});
            for (int k = 0; k < 100; ++k) {
                const Vec3d target = balls.pointOf(1, random);
                const std::vector<double> fromTarget = balls.toCircle(1, target);
                double exact = kInfinity;
                for (std::size_t j = 0; j < TwoBalls::kPoints; ++j)
                    exact = std::min(exact, fromSeed[j] + fromTarget[j]);
                const double off = d.at(fromVdb(target)) - exact;
                ++count;
                if (!(off < kInfinity)) {
                    ++unreached;
                    continue;
                }
                low = std::min(low, off), high = std::max(high, off), sum += std::abs(off);
            }
        }
        std::printf(
            "balls with a neck of %g voxels: %.2f to %.2f voxels, %.2f in the mean, %zu of "
            "%zu unreached\n",
            neck, low, high, sum / double(count), unreached, count);
        CHECK(unreached == 0);
        CHECK(low > least);
        CHECK(high < most);
    }
}

}  // namespace igeo::test
