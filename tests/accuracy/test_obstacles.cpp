// Distances and paths around an obstacle, against tangents and arcs.
#include <igeo/geodesic_solver.h>
#include <igeo/metric/obstacles.h>
#include <support/catch.h>
#include <support/errors.h>
#include <support/openvdb.h>
#include <support/shapes.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <vector>

namespace igeo::test {
namespace {

using openvdb::Vec3d;

double angleBetween(const Vec3d& a, const Vec3d& b) {
    return std::atan2(a.cross(b).length(), a.dot(b));
}

/// Shortest path in a plane around a disc.
double aroundDisc(const Vec3d& c, double r, const Vec3d& p, const Vec3d& q) {
    const Vec3d a = p - c, b = q - c;
    const double la = a.length(), lb = b.length();
    // What the tangents leave of the angle is walked along the rim.
    const double rim = angleBetween(a, b) - std::acos(r / la) - std::acos(r / lb);
    if (rim <= 0) return (p - q).length();
    return std::sqrt(la * la - r * r) + std::sqrt(lb * lb - r * r) + r * rim;
}

/// Shortest path on a unit sphere around a cap of angular radius alpha, by Napier's rules for the
/// right-angled triangle of center, point and point of tangency.
double aroundCap(const Vec3d& c, double alpha, const Vec3d& p, const Vec3d& q) {
    const double bp = angleBetween(c, p), bq = angleBetween(c, q);
    const Vec3d tp = (p - c.dot(p) * c).unit(), tq = (q - c.dot(q) * c).unit();
    auto turn = [&](double beta) {
        return std::acos(std::clamp(std::tan(alpha) / std::tan(beta), -1.0, 1.0));
    };
    auto tangent = [&](double beta) {
        return std::acos(std::clamp(std::cos(beta) / std::cos(alpha), -1.0, 1.0));
    };
    const double rim = angleBetween(tp, tq) - turn(bp) - turn(bq);
    if (rim <= 0) return angleBetween(p, q);
    return tangent(bp) + tangent(bq) + std::sin(alpha) * rim;
}

/// A surface with a ball before the seed's fronts, and the exact distance.
struct Scene {
    const char* name;
    Surface surface;
    Vec3d ball;
    double ballRadius;
    Vec3d seed, target;  ///< the target is in the ball's shadow
    std::function<double(const Vec3d& from, const Vec3d& to)> exact;

    GeodesicSolver solver(Scheme scheme) const {
        auto obstacles = std::make_shared<ObstacleSet>(surface.transform());
        obstacles->addSphere(fromVdb(ball), ballRadius);
        SolverOptions options;
        options.scheme = scheme;
        options.bandVoxels = std::sqrt(3.0);
        options.metric.obstacles = obstacles;
        return GeodesicSolver(surface, options);
    }
    bool inBall(const Vec3d& pWorld, double slack = 0) const {
        return (pWorld - ball).length() < ballRadius - slack;
    }
};

Scene onPlane(int n, double ballRadius = 0.15, double shift = 0) {
    const Vec3d normal = Vec3d(1, -2, 3).unit(), x = normal.cross(Vec3d(0.3, 1, 0.2)).unit(),
                y = normal.cross(x), ball = kCenter + (0.013 + shift) * x - 0.021 * y;
    auto exact = [=](const Vec3d& from, const Vec3d& p) {
        const bool inPatch = std::abs((p - kCenter).dot(x)) < 0.38 &&
                             std::abs((p - kCenter).dot(y)) < 0.38 &&
                             (p - ball).length() > ballRadius;
        return inPatch ? aroundDisc(ball, ballRadius, from, p) : std::nan("");
    };
    return {"plane",
            Surface(*makeLevelSet(planePatch(kCenter, normal, 0.8), 1.0 / n, 3)),
            ball,
            ballRadius,
            kCenter - 0.3 * x + 0.017 * y,
            kCenter + 0.31 * x - 0.04 * y,
            exact};
}

Scene onSphere(int n) {
    constexpr double kRadius = 0.4, kAlpha = 0.5;
    const Vec3d axis = genericDirection(), side = axis.cross(genericDirection(2)).unit();
    auto at = [&](double angle) {
        return kCenter + kRadius * (std::cos(angle) * axis + std::sin(angle) * side);
    };
    auto exact = [=](const Vec3d& from, const Vec3d& p) {
        const Vec3d to = (p - kCenter).unit();
        return angleBetween(axis, to) > kAlpha
                   ? kRadius * aroundCap(axis, kAlpha, (from - kCenter).unit(), to)
                   : std::nan("");
    };
    return {"sphere",
            Surface(*makeLevelSet(sphere(kCenter, kRadius), 1.0 / n, 3)),
            kCenter + kRadius * axis,
            2 * kRadius * std::sin(kAlpha / 2),
            at(1.1),
            at(-1.3),
            exact};
}

}  // namespace

TEST_CASE("obstacles: fronts go around balls of a few voxels") {
    constexpr int kN = 64;
    struct Case {
        double radius;  // voxels
        // 1.5 times what was measured: 0.101, 0.314; 0.060, 0.191; 0.056, 0.152; 0.035, 0.099;
        // 0.029, 0.086. Balls of 2 voxels have 0.086, 0.250 where nodes just outside stay where
        // they are.
        double mean, p95;
    };
    for (const Case& c : {Case{1, 0.152, 0.471},
                          {1.5, 0.09, 0.287},
                          {2, 0.085, 0.228},
                          {3, 0.053, 0.149},
                          {5, 0.043, 0.129}}) {
        std::vector<double> errors;
        for (int k = 0; k < 8; ++k) {
            const Scene s = onPlane(kN, c.radius / kN, k / (8.0 * kN));
            const Distance d = s.solver(Scheme::Jet).distance({fromVdb(s.seed)});
            const Band& band = d.band();
            const Vec3d from = seedOf(d);
            for (NodeIndex i = 0; i < band.size(); ++i) {
                const Vec3d p = worldOf(band, band.footPoint(i));
                const double exact = s.exact(from, p);
                const bool inShadow = exact > (p - from).length() + 1e-9;
                if (inShadow && d.field().distance[i] < kInfinity &&
                    (p - s.ball).length() < s.ballRadius + 12.0 / kN)
                    errors.push_back(d.field().distance[i] - exact * kN);
            }
        }
        std::sort(errors.begin(), errors.end());
        double mean = 0;
        for (const double e : errors) mean += std::abs(e) / double(errors.size());
        const double p95 = errors[errors.size() * 95 / 100];
        std::printf("behind a ball of %g voxels: mean %.4f, p95 %.4f, max %.3f, min %.3f voxels\n",
                    c.radius, mean, p95, errors.back(), errors.front());
        INFO("radius " << c.radius);
        CHECK(mean < c.mean);
        CHECK(p95 < c.p95);
    }
}

TEST_CASE("obstacles: fronts turn around the corners of boxes and the ends of screens") {
    constexpr int kN = 64;
    const Vec3d normal = Vec3d(1, -2, 3).unit(), x = normal.cross(Vec3d(0.3, 1, 0.2)).unit(),
                y = normal.cross(x);
    const Surface surface(*makeLevelSet(planePatch(kCenter, normal, 0.8), 1.0 / kN, 3));
    struct Case {
        const char* name;
        Vec3d size;  // of the box, from its lower corner; beyond the patch or 0
        // 1.5 times what was measured: 0.0259, 0.052, 0.164; 0.0864, 0.278, 1.247. Before nodes
        // moved to corners: 0.179, 0.478, 0.773; 0.222, 0.571, 1.279.
        double mean, p95, max;
    };
    for (const Case& c : {Case{"block", {2, 2, 4}, 0.039, 0.078, 0.247},
                          {"screen", {0, 2, 4}, 0.13, 0.417, 1.88}}) {
        std::vector<double> errors;
        for (int k = 0; k < 24; ++k) {
            const Vec3d corner = kCenter + (0.04 * std::cos(2.0 * k) - 0.05) * x +
                                 0.04 * std::sin(3.0 * k) * y,
                        low = corner - Vec3d(0, 0, 2);
            auto obstacles = std::make_shared<ObstacleSet>(surface.transform());
            obstacles->addBox(fromVdb(low), fromVdb(low + c.size));
            SolverOptions options;
            options.metric.obstacles = obstacles;
            const Vec3d toSeed =
                (corner - kCenter) - 0.3 * (std::cos(0.1 * k) * x - std::sin(0.1 * k) * y);
            const Distance d =
                GeodesicSolver(surface, options).distance({fromVdb(kCenter + toSeed)});
            const Vec3d from = seedOf(d);
            const Band& band = d.band();
            for (NodeIndex i = 0; i < band.size(); ++i) {
                const igeo::Vec3d foot = band.footPoint(i);
                const Vec3d p = worldOf(band, foot);
                if (std::abs((p - kCenter).dot(x)) > 0.37 ||
                    std::abs((p - kCenter).dot(y)) > 0.37 || !(d.field().distance[i] < kInfinity) ||
                    !obstacles->block(surface.transform().indexFromWorld(fromVdb(from)), foot,
                                      {0, 0, 1}))
                    continue;
                errors.push_back(d.field().distance[i] -
                                 ((from - corner).length() + (p - corner).length()) * kN);
            }
        }
        std::sort(errors.begin(), errors.end());
        double mean = 0;
        for (const double e : errors) mean += std::abs(e) / double(errors.size());
        const double p95 = errors[errors.size() * 95 / 100];
        std::printf(
            "behind the corner of a %s: mean %.4f, p95 %.4f, max %.3f, min %.3f voxels of %zu\n",
            c.name, mean, p95, errors.back(), errors.front(), errors.size());
        INFO(c.name);
        CHECK(mean < c.mean);
        CHECK(p95 < c.p95);
        CHECK(errors.back() < c.max);
        CHECK(errors.front() > -0.75);  // one voxel off S, beside a corner: -0.497
    }
}

TEST_CASE("obstacles: distances and paths lead around a ball") {
    for (const Scene& s : {onPlane(200), onSphere(200)}) {
        for (const Scheme scheme : {Scheme::Jet, Scheme::Godunov}) {
            const GeodesicSolver solver = s.solver(scheme);
            REQUIRE(solver.wholeMetric()->insideCount() > 1000);
            const Distance d = solver.distance({fromVdb(s.seed)}, {.targets = {fromVdb(s.target)}});
            const Vec3d from = seedOf(d);
            const std::string& computedBy = d.field().scheme;
            INFO(s.name << ", " << computedBy);
            const Errors e = errorsOnSurface(d, [&](const Vec3d& p) { return s.exact(from, p); });
            std::printf("obstacle on a %s, %s: mean %.4f %%, max %.3f %%\n", s.name,
                        computedBy.c_str(), e.mean, e.max);
            CHECK(e.unreached == 0);
            if (scheme == Scheme::Jet) CHECK(e.max < 0.084);  // measured 0.056
            const Band& band = d.band();
            for (NodeIndex i = 0; i < band.size(); ++i)
                if (s.inBall(worldOf(band, band.footPoint(i))))
                    REQUIRE(d.field().distance[i] == kInfinity);

            const igeo::Vec3d target = fromVdb(s.target);
            const Polyline traced = d.path(target), path = d.path(target, /*straighten=*/true);
            REQUIRE(traced.status == PathStatus::Reached);
            const double exact = s.exact(from, worldOf(band, d.targets()[0].pIndex));
            std::printf("  path: distance %+.3f %%, traced %+.3f %%, straightened %+.3f %%\n",
                        100 * (d.at(target) / exact - 1), 100 * (traced.weightedLength / exact - 1),
                        100 * (path.weightedLength / exact - 1));
            CHECK(path.weightedLength <= traced.weightedLength);
            const double off = scheme == Scheme::Jet ? 3.1e-4 : 0.0181;  // measured 2.0e-4, 0.0121
            CHECK(std::abs(traced.weightedLength / exact - 1) < off);
            CHECK(std::abs(path.weightedLength / exact - 1) < 5.6e-4);  // measured 3.7e-4
            CHECK(path.weightedLength == Approx(path.length));
            // Chords of a voxel between points on the rim dip by 1 / (8 r), r = 30 voxels here.
            auto inBall = [&](const igeo::Vec3d& p) { return s.inBall({p.x, p.y, p.z}, 1e-6); };
            for (const igeo::Vec3d& p : path.points) REQUIRE(!inBall(p));
            for (std::size_t k = 1; k < path.points.size(); ++k)
                REQUIRE(!inBall(0.5 * (path.points[k - 1] + path.points[k])));
        }
    }
}

TEST_CASE("around a hole in an open sheet the path is as long as around a disc") {
    constexpr int kN = 200;
    constexpr double kHole = 0.15;
    const Vec3d normal = Vec3d(1, -2, 3).unit(), x = normal.cross(Vec3d(0.3, 1, 0.2)).unit(),
                y = normal.cross(x), hole = kCenter + 0.013 * x - 0.021 * y;
    Shape shape = planePatch(kCenter, normal, 0.8);
    const SignedDistance square = shape.domain;
    shape.domain = [=](const Vec3d& p) {
        const Vec3d inPlane = p - hole - (p - hole).dot(normal) * normal;
        return std::max(square(p), kHole - inPlane.length());
    };
    const GeodesicSolver solver(Surface(*makeLevelSet(shape, 1.0 / kN, 3)));
    const Distance d = solver.distance({fromVdb(kCenter - 0.3 * x + 0.017 * y)});
    const Vec3d from = seedOf(d);
    const Band& band = d.band();
    double least = 0, most = 0;
    for (NodeIndex i = 0; i < band.size(); ++i) {
        const Vec3d p = worldOf(band, band.footPoint(i));
        if (std::abs((p - kCenter).dot(x)) > 0.37 || std::abs((p - kCenter).dot(y)) > 0.37 ||
            (p - hole).length() < kHole + 1.0 / kN)
            continue;
        const double error = d.field().distance[i] - aroundDisc(hole, kHole, from, p) * kN;
        least = std::min(least, error), most = std::max(most, error);
    }
    std::printf("around a hole of 30 voxels: %+.2g to %+.2f voxels\n", least, most);
    // The last voxels are up to a voxel off the rim, and the path turns by pi at most.
    CHECK(most < 3.2);      // measured 1.67
    CHECK(least > -1e-12);  // measured -5.7e-14
}

}  // namespace igeo::test
