// The same bits for any number of threads, and for a march that is stopped early.
#include <igeo/parallel.h>
#include <igeo/trace.h>
#include <support/catch.h>
#include <support/march_cases.h>
#include <support/openvdb.h>

namespace igeo::test {
namespace {

constexpr double kH = 2.5;

struct Everything {
    Band band;
    Field field;
    std::vector<Vec3f> gradient;
    std::vector<Path> paths;

    explicit Everything(int threads, int order) {
        const ThreadLimit limit(threads);
        CHECK(ThreadLimit::current() == threads);
        band = bandOf(torusGrid(), kH);
        field = march(band, {torusPoints()[0]}, order);
        gradient = surfaceGradient(band, field);
        std::vector<SurfacePoint> targets;
        for (const Vec3d& p : torusPoints()) targets.push_back(nearestSurfacePoint(band, p));
        // Far away: the search over all nodes.
        targets.push_back(nearestSurfacePoint(band, {500, -200, 300}));
        paths = tracePaths(band, field, gradient, targets);
    }
};

}  // namespace

TEST_CASE("one thread and several give the same bits") {
    for (const int order : {kJet, 1, 2}) {
        const Everything one(1, order);
        for (const int threads : {2, 3, 8}) {
            const Everything many(threads, order);
            CHECK(many.band.psi == one.band.psi);
            CHECK(many.band.foot == one.band.foot);
            CHECK(many.band.normal == one.band.normal);
            CHECK(many.band.facing == one.band.facing);
            CHECK(many.band.offset == one.band.offset);
            CHECK(many.field.distance == one.field.distance);
            CHECK(many.gradient == one.gradient);
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
        const auto fullGradient = surfaceGradient(band, full);
        for (const Vec3d& p : {torusPoints()[1], torusPoints()[2]}) {
            const SurfacePoint target = nearestSurfacePoint(band, p);
            options.stopAt = {target};
            const Field part = marchGodunov(band, {}, {seed}, options);
            CHECK(part.stoppedEarly);
            CHECK(part.reached < full.reached);
            for (std::size_t k = 0; k < band.size(); ++k)
                if (part.distance[k] < kInfinity) REQUIRE(part.distance[k] == full.distance[k]);
            // The path is that of the full march, bit by bit.
            const Path a = tracePath(band, full, fullGradient, target);
            const Path b = tracePath(band, part, surfaceGradient(band, part), target);
            CHECK(a.distance == b.distance);
            CHECK(a.length == b.length);
            CHECK(a.vertices.size() == b.vertices.size());
        }
        // A target on the seed stops at once.
        options.stopAt = {seed};
        CHECK(marchGodunov(band, {}, {seed}, options).maxDistance < 6);
    }
}

}  // namespace igeo::test
