// Paths on fields known in closed form, so that only the tracer errs.
#include <igeo/march/jet.h>
#include <igeo/path/trace.h>
#include <support/analytic_band.h>
#include <support/catch.h>
#include <support/expect_error.h>
#include <support/pinned.h>

#include <random>

namespace igeo::test {
namespace {

const Vec3d kBallCenter{0.3, -0.2, 0.1};
constexpr double kBallRadius = 20, kStartRadius = 3.5;

/// Exact distances on the sphere from `seed`.
struct Sphere : Pinned {
    Band band = sphereBand(kBallCenter, kBallRadius, 2);
    Field field;

    explicit Sphere(const Vec3d& direction, double start = 0) {
        SurfacePoint seed = at(direction);
        seed.start = start;
        field.band = &band;
        field.seeds = {seed};
        field.startRadius = kStartRadius;
        for (std::size_t k = 0; k < band.size(); ++k)
            field.distance.push_back(start + geodesic(seed.pIndex, band.footPoint(NodeIndex(k))));
        field.summarize();
        field.gradient = surfaceGradient(field);
    }
    SurfacePoint at(const Vec3d& direction) const {
        return nearestSurfacePoint(band, kBallCenter + kBallRadius * normalized(direction));
    }
    static double geodesic(const Vec3d& p, const Vec3d& q) {
        const Vec3d a = p - kBallCenter, b = q - kBallCenter;
        return kBallRadius * std::atan2(length(cross(a, b)), dot(a, b));
    }
    Path trace(const SurfacePoint& target) const { return tracePath(field, target); }
};

/// What every path promises.
void checkConsistent(const Sphere& s, const Path& path) {
    REQUIRE(!path.vertices.empty());
    CHECK(path.vertices.front().pIndex == path.target.pIndex);
    CHECK(path.vertices.front().arcLength == 0);
    CHECK(path.vertices.front().distance == path.distance);
    CHECK(path.vertices.back().arcLength == path.weightedLength);
    for (std::size_t k = 1; k < path.vertices.size(); ++k) {
        const PathVertex &a = path.vertices[k - 1], &b = path.vertices[k];
        const double step = length(b.pIndex - a.pIndex);
        REQUIRE(std::abs(b.arcLength - a.arcLength - step) < 1e-12 * (1 + b.arcLength));
        // maxStep, a projection back to the surface, or a step between neighboring nodes.
        REQUIRE(step < 2.5);
        REQUIRE(std::abs(samplePsi(s.band, b.pIndex).psi) < 1.5e-06);  // measured 9.8e-07
    }
    if (path.status == PathStatus::Reached) {
        REQUIRE(path.seed < s.field.seeds.size());
        CHECK(path.vertices.back().pIndex == s.field.seeds[path.seed].pIndex);
        CHECK(path.vertices.back().distance == s.field.seeds[path.seed].start);
    }
}

}  // namespace

TEST_CASE("tracePath: great circles on the sphere") {
    const Sphere s({1, 2, 3});
    const Vec3d toSeed = s.field.seeds[0].pIndex - kBallCenter;
    std::mt19937 random(1);
    std::normal_distribution<double> normal;
    for (int trial = 0; trial < 100; ++trial) {
        const SurfacePoint target = s.at({normal(random), normal(random), normal(random)});
        const double exact = Sphere::geodesic(target.pIndex, s.field.seeds[0].pIndex);
        // The antipode and the start disc have tests of their own.
        if (exact < kStartRadius || exact > 0.9 * kBallRadius * M_PI) continue;
        const Path path = s.trace(target);
        INFO("trial " << trial << ", distance " << exact);
        REQUIRE(path.status == PathStatus::Reached);
        checkConsistent(s, path);

        // Differences and interpolation of a cone of radius r turn its gradient by at most about
        // 1 / r^2 (central: 1 / (6 r^2) per axis; trilinear: 1 / 8 of the second derivatives of the
        // gradient, 2 / r^2 each, twice). A path that is pulled to its seed drifts by the integral
        // of that times r / r' from its start at L: r (1/r^2 - 1/L^2) / 2 < 1 / (2 r), so at most
        // 1 / 7 at the start disc, where it goes straight to the seed. The sphere's curvature
        // adds the same with R for r over the whole length: 2.7 R / R^2 = 0.14.
        const Vec3d n = normalized(cross(toSeed, target.pIndex - kBallCenter));
        double deviation = 0;
        for (const PathVertex& v : path.vertices)
            deviation = std::max(deviation, std::abs(dot(n, v.pIndex - kBallCenter)));
        CHECK(deviation < 0.083);  // measured 0.055

        // Length: half the square of those angles; chords of 1 voxel are short by 1 / (24 R^2) of
        // it; the interpolant's zero lies up to 1 / (4 R) off the sphere, which stretches the
        // path by that over R. Together below 1.1e-3 of the length, and 1e-2 at the start disc.
        CHECK(std::abs(path.weightedLength - exact) <
              6.8e-4 * exact + 0.0061);  // measured 1 / 1.5 of it
        // Trilinear sampling of d: 1 / 8 of second derivatives of at most 1 / r + 1 / R per axis.
        CHECK(std::abs(path.distance - exact) < 0.07 * (1 / kStartRadius + 1 / kBallRadius));
    }
}

TEST_CASE("tracePath: targets within the start disc go straight") {
    const Sphere s({1, 2, 3}, 4);
    const Vec3d seed = s.field.seeds[0].pIndex;
    const SurfacePoint near = nearestSurfacePoint(s.band, seed + Vec3d{2, -1, 0});
    const Path path = s.trace(near);
    CHECK(path.status == PathStatus::Reached);
    checkConsistent(s, path);
    const double chord = length(near.pIndex - seed);
    CHECK(path.distance == 4 + chord);
    // On the surface: longer than the chord, by c^3 / (24 R^2) and the interpolant's 1 / (4 R) ups
    // and downs over each of the 3 pieces.
    CHECK(path.weightedLength >= chord);
    CHECK(path.weightedLength < chord + 3 * (0.25 / kBallRadius) * (0.25 / kBallRadius) + 0.01);
}

TEST_CASE("tracePath: a target at the seed is a path of length 0") {
    const Sphere s({-1, 2, 0.5}, 1.5);
    const Path path = s.trace(s.field.seeds[0]);
    CHECK(path.status == PathStatus::Reached);
    CHECK(path.weightedLength == 0);
    CHECK(path.distance == 1.5);
    checkConsistent(s, path);
}

TEST_CASE("tracePath: from the antipode some shortest path") {
    const Sphere s({1, 2, 3});
    const SurfacePoint antipode = s.at({-1, -2, -3});
    const Path path = s.trace(antipode);
    CHECK(path.status == PathStatus::Reached);
    checkConsistent(s, path);
    const double exact = kBallRadius * M_PI;
    CHECK(path.weightedLength > exact * (1 - 1e-3) - 0.2);
    // Until the gradient is of use, some 3 voxels from the antipode, steps lead from node to node:
    // at most sqrt(3) of them per voxel of descent.
    CHECK(path.weightedLength < exact * (1 + 1e-3) + 3 * (std::sqrt(3.0) - 1) + 1);
}

TEST_CASE("tracePath: from node to node where the gradient is of no use") {
    Sphere s({1, 2, 3});
    std::fill(s.field.gradient.begin(), s.field.gradient.end(), Vec3f{});
    for (const Vec3d& direction : {Vec3d{-1, 0, 0}, Vec3d{0, 1, 0.3}, Vec3d{2, 0.1, -1}}) {
        const SurfacePoint target = s.at(direction);
        const Path path = s.trace(target);
        const double exact = Sphere::geodesic(target.pIndex, s.field.seeds[0].pIndex);
        INFO("length " << path.weightedLength << ", exact " << exact);
        CHECK(path.status == PathStatus::Reached);
        checkConsistent(s, path);
        CHECK(path.weightedLength > exact * (1 - 1.1e-3) - 0.01);
        // Paths along the 26 neighbors of a lattice are longer than straight ones by at most
        // sqrt(1 + (sqrt 2 - 1)^2 + (sqrt 3 - sqrt 2)^2) = 1.128, and a voxel at each end; foot
        // points of voxels within 1 of the surface are spread by at most R / (R - 1).
        CHECK(path.weightedLength < 1.128 * kBallRadius / (kBallRadius - 1) * exact + 2);
    }
}

TEST_CASE("tracePath: the nearest of several seeds, by number") {
    Sphere s({0, 0, 1});
    const SurfacePoint second = s.at({0, 1, 0});
    s.field.seeds.push_back(second);
    for (std::size_t k = 0; k < s.band.size(); ++k)
        s.field.distance[k] = std::min(
            s.field.distance[k], Sphere::geodesic(second.pIndex, s.band.footPoint(NodeIndex(k))));
    s.field.summarize();
    s.field.gradient = surfaceGradient(s.field);
    for (const auto& [direction, seed] :
         {std::pair<Vec3d, std::size_t>{{0.2, 0.3, 1}, 0}, {{0.2, 1, 0.3}, 1}}) {
        const Path path = s.trace(s.at(direction));
        CHECK(path.status == PathStatus::Reached);
        CHECK(path.seed == seed);
        checkConsistent(s, path);
    }
    // On the line between them both are right.
    CHECK(s.trace(s.at({1, 1, 1})).status == PathStatus::Reached);
}

TEST_CASE("tracePath: past a seed that another front has overrun") {
    const Band band = planeBand({0, 0, 1}, 0, {-24, -24, -3}, {24, 24, 3}, 2);
    const SurfacePoint first = nearestSurfacePoint(band, {-7.7, -0.4, 0});
    SurfacePoint late = nearestSurfacePoint(band, {2.3, 0.2, 0});
    late.start = 12;
    const Field field = marchJet(band, {}, {late, first});
    for (const Vec3d& to : {Vec3d{2.3, 0.2, 0}, {3.4, 0.9, 0}, {1.1, 0.3, 0}, {9.9, 1.2, 0}}) {
        const Path path = tracePath(field, nearestSurfacePoint(band, to));
        REQUIRE(path.status == PathStatus::Reached);
        CHECK(path.seed == 1);
        CHECK(path.distance == Approx(length(to - first.pIndex)).margin(1e-6));  // measured 2.9e-07
        CHECK(path.length == Approx(length(to - first.pIndex)).margin(4e-6));    // measured 2.6e-06
    }
}

TEST_CASE("tracePath: an unreached target has no path") {
    Sphere s({1, 2, 3});
    std::fill(s.field.distance.begin(), s.field.distance.end(), kInfinity);
    const Path path = s.trace(s.at({-1, 0, 0}));
    CHECK(path.status == PathStatus::Unreachable);
    CHECK(path.vertices.empty());
    CHECK(path.weightedLength == 0);
    CHECK(path.distance == kInfinity);
    CHECK(std::string(toString(path.status)) == "unreachable");
}

TEST_CASE("tracePath: a field without a descent stalls") {
    Sphere s({1, 2, 3});
    std::fill(s.field.distance.begin(), s.field.distance.end(), 30.0);
    s.field.gradient = surfaceGradient(s.field);
    const Path flat = s.trace(s.at({-1, 0, 0}));
    CHECK(flat.status == PathStatus::Stalled);
    CHECK(flat.vertices.size() <= 2);  // its target, and the node next to it
    CHECK(std::abs(flat.distance - 30) < 1e-13);
    CHECK(std::string(toString(flat.status)) == "stalled");

    // A pit away from any seed: the path ends at its bottom.
    const Vec3d pit = s.at({0, -1, 0}).pIndex;
    for (std::size_t k = 0; k < s.band.size(); ++k)
        s.field.distance[k] = 30 + Sphere::geodesic(pit, s.band.footPoint(NodeIndex(k)));
    s.field.gradient = surfaceGradient(s.field);
    const Path path = s.trace(s.at({0.3, -1, 0.2}));
    CHECK(path.status == PathStatus::Stalled);
    CHECK(path.vertices.size() > 3);
    CHECK(length(path.vertices.back().pIndex - pit) < 2);
    CHECK(std::string(toString(PathStatus::Reached)) == "reached");
}

TEST_CASE("tracePaths: the paths of tracePath, in order") {
    const Sphere s({1, 2, 3});
    const std::vector<SurfacePoint> targets{s.at({-1, 0, 0}), s.at({0, 1, 0}), s.at({0, 0, -1})};
    const auto paths = tracePaths(s.field, targets);
    REQUIRE(paths.size() == 3);
    for (std::size_t k = 0; k < 3; ++k) {
        CHECK(paths[k].target.pIndex == targets[k].pIndex);
        CHECK(paths[k].weightedLength == s.trace(targets[k]).weightedLength);
    }
    CHECK(tracePaths(s.field, {}).empty());
    struct Stop : Progress {
        bool cancelled() const override { return true; }
    } stop;
    expectError(Error::Kind::Cancelled, {}, [&] { tracePaths(s.field, targets, {}, stop); });
}

}  // namespace igeo::test
