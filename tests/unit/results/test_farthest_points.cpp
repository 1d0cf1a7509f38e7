// Farthest-point sampling, compared with the greedy choice with exact distances.
#include <igeo/base/parallel.h>
#include <igeo/march/jet.h>
#include <igeo/results/farthest_points.h>
#include <support/analytic_band.h>
#include <support/catch.h>
#include <support/expect_error.h>

#include <algorithm>
#include <set>

namespace igeo::test {
namespace {

const Vec3d kBallCenter{0.3, -0.2, 0.1};
constexpr double kBallRadius = 20;

double onSphere(const Vec3d& p, const Vec3d& q) {
    const Vec3d a = p - kBallCenter, b = q - kBallCenter;
    return kBallRadius * std::atan2(length(cross(a, b)), dot(a, b));
}

std::vector<Vec3d> coreFeet(const Band& band) {
    std::vector<Vec3d> feet;
    for (NodeIndex i = 0; i < band.size(); ++i)
        if (band.inCore(i)) feet.push_back(band.footPoint(i));
    return feet;
}

std::vector<Vec3d> positions(const std::vector<SurfacePoint>& points) {
    std::vector<Vec3d> p;
    for (const SurfacePoint& s : points) p.push_back(s.pIndex);
    return p;
}

/// Farthest-point sampling by its definition.
std::vector<Vec3d> exactGreedy(const std::vector<Vec3d>& feet, const Vec3d& start,
                               std::size_t count) {
    std::vector<Vec3d> points{start};
    std::vector<double> nearest(feet.size(), kInfinity);
    while (points.size() < count) {
        for (std::size_t k = 0; k < feet.size(); ++k)
            nearest[k] = std::min(nearest[k], onSphere(feet[k], points.back()));
        points.push_back(
            feet[std::size_t(std::max_element(nearest.begin(), nearest.end()) - nearest.begin())]);
    }
    return points;
}

/// The least distance between any two of the first k points.
double spacing(const std::vector<Vec3d>& points, std::size_t k) {
    double least = kInfinity;
    for (std::size_t i = 0; i < k; ++i)
        for (std::size_t j = 0; j < i; ++j) least = std::min(least, onSphere(points[i], points[j]));
    return least;
}

/// A ball that no path may enter.
struct BallObstacle : Obstacles {
    Vec3d center{};
    double radius = 0;
    bool block(const Vec3d& a, const Vec3d& b, const Vec3d&) const override {
        const Vec3d way = b - a;
        const double l2 = dot(way, way);
        const double t = l2 > 0 ? std::clamp(dot(center - a, way) / l2, 0.0, 1.0) : 0;
        return length(a + t * way - center) < radius;
    }
    bool mayBeNear(const Vec3d& p, double r) const override {
        return length(p - center) < radius + r;
    }
};

}  // namespace

TEST_CASE("farthestPoints on the sphere: as far apart as the greedy choice with exact distances") {
    const Band band = sphereBand(kBallCenter, kBallRadius, 2);
    constexpr std::size_t kCount = 60;
    const auto points = positions(farthestPoints(band, {}, {}, kCount));
    REQUIRE(points.size() == kCount);
    const auto feet = coreFeet(band);
    const auto exact = exactGreedy(feet, points[0], kCount);
    for (std::size_t k = 2; k <= kCount; ++k) {
        INFO(k << " points: " << spacing(points, k) << ", exact " << spacing(exact, k));
        CHECK(spacing(points, k) > 0.95 * spacing(exact, k));
    }
    // Whatever was chosen before, each choice is the farthest there is, but for the errors of two
    // distances (0.1 % of the largest, docs/accuracy.md) and the snap to psi = 0, 1 / (4 R).
    const double tolerance = 2 * 0.001 * M_PI * kBallRadius + 0.25 / kBallRadius;
    std::vector<double> nearest(feet.size(), kInfinity);
    for (std::size_t k = 1; k < kCount; ++k) {
        double farthest = 0, chosen = kInfinity;
        for (std::size_t f = 0; f < feet.size(); ++f) {
            nearest[f] = std::min(nearest[f], onSphere(feet[f], points[k - 1]));
            farthest = std::max(farthest, nearest[f]);
        }
        for (std::size_t j = 0; j < k; ++j)
            chosen = std::min(chosen, onSphere(points[k], points[j]));
        INFO("point " << k);
        CHECK(chosen > farthest - tolerance);
    }
}

TEST_CASE("farthestPoints: pieces without a point come first, by node number") {
    // Two planes, eight voxels apart.
    const auto psi = [](const Vec3d& p) { return std::abs(p.z - 0.1) < 4 ? p.z - 0.1 : p.z - 8.1; };
    const Band band = analyticBand(
        psi,
        [](const Vec3d&) {
            return Vec3d{0, 0, 1};
        },
        {-10, -8, -3}, {10, 8, 11}, 2);
    const auto points = farthestPoints(band, {}, {}, 3);
    NodeIndex first = 0;
    while (!band.inCore(first)) ++first;
    CHECK(points[0].node == first);
    CHECK(std::abs(points[0].pIndex.z - points[1].pIndex.z) == Approx(8));
    // Then the far corner of either plane, 20 and 16 voxels on.
    CHECK(std::abs(points[2].pIndex.x - points[points[2].pIndex.z > 4 ? 1 : 0].pIndex.x) ==
          Approx(20).margin(1e-3));

    const auto second = farthestPoints(band, {}, {points[0], points[1]}, 1);
    CHECK(second[0].node == points[2].node);
    const auto other = farthestPoints(band, {}, {points[1]}, 1);
    CHECK(std::abs(other[0].pIndex.z - points[1].pIndex.z) == Approx(8));
}

TEST_CASE("farthestPoints on a plane: the opposite corner, then the sides") {
    const Band band = planeBand({0, 0, 1}, 0.2, {0, 0, -2}, {20, 30, 3}, 2);
    const SurfacePoint start = nearestSurfacePoint(band, {0, 0, 0.2});
    const auto points = positions(farthestPoints(band, {}, {start}, 3));
    CHECK(length(points[0] - Vec3d{20, 30, 0.2}) < 4.5e-09);  // measured 3e-09
    // On the side x = 20, the lesser of |(20, y)| and 30 - y is largest at y = 8: 21.5; by symmetry
    // at (0, 22) as well.
    const Vec3d a{20, 8, 0.2}, b{0, 22, 0.2};
    CHECK(std::min(length(points[1] - a), length(points[1] - b)) < 4.5e-09);  // measured 3e-09
    CHECK(length(points[1] + points[2] - a - b) < 9e-09);                     // measured 6e-09
}

TEST_CASE("farthestPoints: any beginning is a sampling, on any number of threads") {
    const Band band = sphereBand(kBallCenter, 12, 2);
    const auto nodes = [&](std::size_t count, int threads) {
        const ThreadLimit limit(threads);
        std::vector<NodeIndex> n;
        for (const SurfacePoint& p : farthestPoints(band, {}, {}, count)) n.push_back(p.node);
        return n;
    };
    const auto all = nodes(40, 1);
    CHECK(nodes(40, 2) == all);
    CHECK(nodes(40, 5) == all);
    CHECK(nodes(7, 2) == std::vector<NodeIndex>(all.begin(), all.begin() + 7));
}

TEST_CASE("farthestPoints: a constant weight changes nothing, obstacles are kept free") {
    const Band band = sphereBand(kBallCenter, 12, 2);
    const auto twice = std::make_shared<Metric>();
    twice->weight.assign(band.size(), 2.0f);
    const auto plain = farthestPoints(band, {}, {}, 20),
               heavy = farthestPoints(band, twice, {}, 20);
    for (std::size_t k = 0; k < 20; ++k) CHECK(plain[k].node == heavy[k].node);

    const auto ball = std::make_shared<BallObstacle>();
    ball->center = kBallCenter + Vec3d{12, 0, 0}, ball->radius = 6;
    const auto metric = std::make_shared<Metric>();
    metric->setObstacles(band, ball);
    for (const SurfacePoint& p : farthestPoints(band, metric, {}, 60))
        CHECK(length(band.footPoint(p.node) - ball->center) >= 6);
}

TEST_CASE("farthestPoints: every foot point once, and no more") {
    const Band band = planeBand({0.1, 0.2, 1}, 0, {-3, -3, -4}, {3, 3, 4}, 2);
    std::set<NodeIndex> nodes;
    for (const SurfacePoint& p : farthestPoints(band, {}, {}, band.coreSize())) {
        CHECK(band.inCore(p.node));
        nodes.insert(p.node);
    }
    CHECK(nodes.size() == band.coreSize());
    const auto ask = [&](std::size_t count) {
        return [&band, count] { farthestPoints(band, {}, {}, count); };
    };
    expectError(Error::Kind::InvalidArgument, {"0 points", std::to_string(band.coreSize())},
                ask(0));
    expectError(Error::Kind::InvalidArgument,
                {std::to_string(band.coreSize() + 1) + " points are to be spread",
                 "at most " + std::to_string(band.coreSize()) + " are allowed", "fewer", "smaller"},
                ask(band.coreSize() + 1));
    struct Stop : Progress {
        bool cancelled() const override { return true; }
    } stop;
    expectError(Error::Kind::Cancelled, {}, [&] { farthestPoints(band, {}, {}, 2, stop); });
}

TEST_CASE("JetOptions::below: only the cell is marched, and as ever") {
    const Band band = sphereBand(kBallCenter, kBallRadius, 2);
    const SurfacePoint a = nearestSurfacePoint(band, kBallCenter + Vec3d{3, 5, kBallRadius});
    const SurfacePoint b = nearestSurfacePoint(band, kBallCenter + Vec3d{kBallRadius, 2, 8});
    const Field first = marchJet(band, {}, {a}), second = marchJet(band, {}, {b});
    JetOptions options;
    options.below = &first.distance;
    const Field cell = marchJet(band, {}, {b}, options);
    double worst = 0;
    for (NodeIndex i = 0; i < band.size(); ++i) {
        if (second.distance[i] < first.distance[i])
            worst = std::max(worst, std::abs(cell.distance[i] - second.distance[i]));
        // The margin of three voxels, and a node of the band outside the core.
        if (second.distance[i] > first.distance[i] + 6) REQUIRE(cell.distance[i] == kInfinity);
    }
    // At its edge a node may miss neighbors, as at the edge of any march.
    CHECK(worst < 0.0023);  // measured 0.0015, where fronts meet
    CHECK(cell.solved < 0.65 * double(second.solved));
    CHECK(cell.stoppedEarly);
    const std::vector<double> few(3, 1.0);
    options.below = &few;
    expectError(Error::Kind::InvalidArgument, {"below", "3"},
                [&] { marchJet(band, {}, {b}, options); });
}

}  // namespace igeo::test
