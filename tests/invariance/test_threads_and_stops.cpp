// The same bits for any number of threads, in vector registers of any width, and for a march that
// is stopped early.
#include <igeo/base/detail/registers.h>
#include <igeo/base/parallel.h>
#include <igeo/march/jet.h>
#include <igeo/path/trace.h>
#include <support/catch.h>
#include <support/errors.h>
#include <support/march_cases.h>
#include <support/openvdb.h>
#include <support/pinned.h>
#include <support/random_surface.h>
#include <support/shapes.h>

#include <algorithm>
#include <cmath>

namespace igeo::test {
namespace {

constexpr double kH = 2.5;

struct Everything : Pinned {
    Band band;
    Field field;
    std::vector<Path> paths;

    explicit Everything(int threads, int order) {
        const ThreadLimit limit(threads);
        CHECK(ThreadLimit::current() == threads);
        band = bandOf(torusGrid(), kH);
        field = march(band, {torusPoints()[0]}, order);
        std::vector<SurfacePoint> targets;
        for (const Vec3d& p : torusPoints()) targets.push_back(nearestSurfacePoint(band, p));
        // Far away: the search over all nodes.
        targets.push_back(nearestSurfacePoint(band, {500, -200, 300}));
        paths = tracePaths(field, targets);
    }
};

/// The same band, its leaves numbered the other way round.
Band renumbered(const Band& band) {
    Band other;
    other.transform = band.transform;
    other.h = band.h;
    for (auto from = band.leaves.rbegin(); from != band.leaves.rend(); ++from) {
        BandLeaf leaf;
        leaf.origin = from->origin;
        leaf.band.mask = from->band.mask;
        other.leaves.push_back(leaf);
    }
    other.buildTopology();
    for (NodeIndex i = 0; i < other.size(); ++i) {
        const NodeIndex from = band.nodeAt(other.ijk(i));
        other.psi[i] = band.psi[from];
        other.foot[i] = band.footOf(from);
        other.normal[i] = band.normal[from];
        other.facing[i] = band.facing[from];
    }
    other.numberCore();
    return other;
}

/// Weights from 1 to `contrast` in waves of different lengths along x and y.
MetricPtr waves(const Band& band, double contrast) {
    auto metric = std::make_shared<Metric>();
    for (NodeIndex i = 0; i < band.size(); ++i) {
        const Vec3d p = band.footPoint(i);
        const double phase = 2 + std::sin(p.x / 2) + std::sin(p.y);
        metric->weight.push_back(float(std::pow(contrast, phase / 4)));
    }
    return metric;
}

}  // namespace

// Threads come to the nodes of a bucket in any order. Here that order is turned round for certain:
// a bucket's nodes follow the numbers of the leaves.
TEST_CASE("the order in which nodes are solved changes no bit of jet") {
    const Band band = bandOf(makeLevelSet(sphere({0.3, 0.1, 0.2}, 40), 1, 3), std::sqrt(3.0));
    const Band other = renumbered(band);
    REQUIRE(other.coreSize() == band.coreSize());
    const std::vector<Vec3d> places{{40, 3, 5}, {-20, 30, 7}, {3, -12, -38}};
    const auto marched = [&](const Band& on, std::size_t seeds, double contrast) {
        std::vector<SurfacePoint> from;
        for (std::size_t k = 0; k < seeds; ++k) from.push_back(nearestSurfacePoint(on, places[k]));
        return marchJet(on, contrast > 1 ? waves(on, contrast) : nullptr, from);
    };
    for (const std::size_t seeds : {1, 3})
        for (const double contrast : {1.0, 4.0, 100.0, 1e6}) {
            INFO(seeds << " seeds, contrast " << contrast);
            const Field a = marched(band, seeds, contrast), b = marched(other, seeds, contrast);
            CHECK(a.solved == band.coreSize());
            std::size_t differ = 0;
            for (NodeIndex i = 0; i < band.size(); ++i) {
                const NodeIndex j = other.nodeAt(band.ijk(i));
                differ += a.distance[i] != b.distance[j] || a.gradient[i] != b.gradient[j] ||
                          (seeds > 1 && a.label[i] != b.label[j]);
            }
            CHECK(differ == 0);
        }
}

TEST_CASE("registers of four and of eight floats give the same bits") {
    bool& eight = eightAtATime();
    const bool hasEight = eight;
    if (!eight) WARN("skipped: this processor has no registers of eight floats");
    const openvdb::math::Transform unit;
    for (const unsigned surface : {3u, 4u, 5u}) {
        // Creases and cut loci, several seeds and weights: all that is solved side by side.
        const auto grid = randomLevelSet(surface, surface == 4 ? 2 : 0, unit);
        const Band band = bandOf(grid, std::sqrt(3.0));
        const LevelSetStats stats = checkedLevelSet(grid).stats;
        eight = false;
        const Band band4 = bandOf(grid, std::sqrt(3.0));
        const LevelSetStats stats4 = checkedLevelSet(grid).stats;
        eight = hasEight;
        CHECK(
            (band4.psi == band.psi && band4.normal == band.normal && band4.facing == band.facing));
        CHECK(band4.coreSize() == band.coreSize());
        CHECK((stats4.nearSurface == stats.nearSurface && stats4.cutVoxels == stats.cutVoxels));
        CHECK(stats4.crossingShare == stats.crossingShare);
        CHECK(stats4.gradientMedian == stats.gradientMedian);
        CHECK(stats4.gradientShare == stats.gradientShare);
        CHECK(stats4.largestCurvature == stats.largestCurvature);
        CHECK(stats4.reach == stats.reach);
        Random random(surface);
        std::vector<SurfacePoint> seeds, targets;
        for (int k = 0; k < 3; ++k) {
            const openvdb::Vec3d way = random.direction();
            seeds.push_back(nearestSurfacePoint(band, 25.0 * Vec3d{way.x(), way.y(), way.z()}));
        }
        std::vector<Vec3d> points;
        std::vector<Vec3f> normals;
        for (NodeIndex i = 0; i < band.size(); i += 7)
            points.push_back(band.footPoint(i)), normals.push_back(band.normal[i]);
        for (const double contrast : {1.0, 3.0})
            for (const std::size_t count : {1, 3}) {
                INFO("surface " << surface << ", " << count << " seeds, contrast " << contrast);
                const std::vector<SurfacePoint> from(seeds.begin(),
                                                     seeds.begin() + std::ptrdiff_t(count));
                const auto core = jetCore(band, contrast > 1 ? waves(band, contrast) : nullptr);
                JetOptions options;
                options.extend = false;
                const Field a = marchJet(core, from), onCore = marchJet(core, from, options);
                const auto read = arrivalsAt(onCore, points, normals);
                eight = false;
                const auto core4 = jetCore(band, contrast > 1 ? waves(band, contrast) : nullptr);
                const Field b = marchJet(core4, from), onCore4 = marchJet(core4, from, options);
                const auto read4 = arrivalsAt(onCore4, points, normals);
                eight = hasEight;
                std::size_t differ = 0;
                for (NodeIndex i = 0; i < band.size(); ++i)
                    differ += a.distance[i] != b.distance[i] || a.gradient[i] != b.gradient[i] ||
                              (count > 1 && a.label[i] != b.label[i]);
                CHECK(differ == 0);
                for (std::size_t k = 0; k < points.size(); ++k)
                    differ +=
                        read[k].distance != read4[k].distance || read[k].source != read4[k].source;
                CHECK(differ == 0);
            }
    }
}

TEST_CASE("registers of four and of eight floats sever the same links") {
    bool& eight = eightAtATime();
    const bool hasEight = eight;
    if (!eight) WARN("skipped: this processor has no registers of eight floats");
    // A rib of two voxels, turned: links through it are severed by what psi is on their chords.
    const Shape part = partOf({{{-12, -12, -6}, {12, 12, 0}}, {{-1, -12, 0}, {1, 12, 7}}});
    const auto grid = makeLevelSet(
        part, *rotatedTransform(1, openvdb::Vec3d(0.3, 0.5, 0.8), 33, openvdb::Vec3d(0.1)), 3);
    const Band band = bandOf(grid, std::sqrt(3.0));
    eight = false;
    const Band band4 = bandOf(grid, std::sqrt(3.0));
    eight = hasEight;
    std::size_t severed = 0, differ = 0;
    for (NodeIndex i = 0; i < band.size(); ++i) {
        severed += band.severedSteps(i) != 0;
        differ += band.severedSteps(i) != band4.severedSteps(i);
    }
    CHECK(severed > 100);
    CHECK(differ == 0);
}

TEST_CASE("one thread and several give the same bits") {
    for (const int order : {kJet, 1, 2}) {
        const Everything one(1, order);
        for (const int threads : {2, 3, 8}) {
            const Everything many(threads, order);
            CHECK(many.band.psi == one.band.psi);
            CHECK(many.band.foot == one.band.foot);
            CHECK(many.band.normal == one.band.normal);
            CHECK(many.band.facing == one.band.facing);
            CHECK(many.field.distance == one.field.distance);
            CHECK(many.field.gradient == one.field.gradient);
            REQUIRE(many.paths.size() == one.paths.size());
            for (std::size_t k = 0; k < one.paths.size(); ++k) {
                const auto &a = one.paths[k].vertices, &b = many.paths[k].vertices;
                CHECK(one.paths[k].status == PathStatus::Reached);
                REQUIRE(a.size() == b.size());
                for (std::size_t v = 0; v < a.size(); ++v) {
                    REQUIRE(a[v].pIndex == b[v].pIndex);
                    REQUIRE(a[v].distance == b[v].distance);
                }
            }
        }
    }
}

TEST_CASE("a largest distance stops the march and changes nothing before") {
    const Band band = bandOf(torusGrid(), kH);
    const SurfacePoint seed = nearestSurfacePoint(band, torusPoints()[0]);
    for (const int order : {1, 2}) {
        GodunovOptions options;
        options.order = order;
        const Field full = marchGodunov(band, {}, {seed}, options);
        for (const double limit : {1.0, 10.0, 25.3, full.maxDistance, 1e9}) {
            options.maxDistance = limit;
            const Field part = marchGodunov(band, {}, {seed}, options);
            INFO("order " << order << ", limit " << limit);
            std::size_t within = 0;
            for (std::size_t k = 0; k < band.size(); ++k) {
                const double d = full.distance[k];
                // The order of nodes is only as fine as the keys (6e-8): some just above or below.
                if (d < limit * (1 - 1e-6)) REQUIRE(part.distance[k] == d);
                if (d > limit * (1 + 1e-6)) REQUIRE(part.distance[k] == kInfinity);
                within += d <= limit;
            }
            CHECK(part.reached == within);
            CHECK(part.stoppedEarly == (within < band.size()));
        }
    }
}

TEST_CASE("a march that stops at its targets agrees with the full one") {
    const Band band = bandOf(torusGrid(), kH);
    const SurfacePoint seed = nearestSurfacePoint(band, torusPoints()[0]);
    for (const int order : {1, 2}) {
        GodunovOptions options;
        options.order = order;
        const Field full = marchGodunov(band, {}, {seed}, options);
        for (const Vec3d& p : {torusPoints()[1], torusPoints()[2]}) {
            const SurfacePoint target = nearestSurfacePoint(band, p);
            options.stopAt = {target};
            const Field part = marchGodunov(band, {}, {seed}, options);
            CHECK(part.stoppedEarly);
            CHECK(part.reached < full.reached);
            for (std::size_t k = 0; k < band.size(); ++k)
                if (part.distance[k] < kInfinity) REQUIRE(part.distance[k] == full.distance[k]);
            // The path is that of the full march, bit by bit.
            const Path a = tracePath(full, target);
            const Path b = tracePath(part, target);
            CHECK(a.distance == b.distance);
            CHECK(a.weightedLength == b.weightedLength);
            CHECK(a.vertices.size() == b.vertices.size());
        }
        // A target on the seed stops at once.
        options.stopAt = {seed};
        CHECK(marchGodunov(band, {}, {seed}, options).maxDistance < 6);
    }
}

}  // namespace igeo::test
