// Rays back from where fronts meet, with jets known in closed form.
#include <igeo/base/detail/registers.h>
#include <igeo/march/detail/jet_rays.h>
#include <support/analytic_band.h>
#include <support/catch.h>

#include <cmath>
#include <cstdio>
#include <functional>
#include <random>

namespace igeo::test {
namespace {

/// A value and its gradient in space.
struct Front {
    double u;
    Vec3d g;
};
using FrontsAt = std::function<std::vector<Front>(const Vec3d&)>;

const Front& firstOf(const std::vector<Front>& fronts) {
    return *std::min_element(fronts.begin(), fronts.end(),
                             [](const Front& a, const Front& b) { return a.u < b.u; });
}

/// The jets of a march that found the first front at all nodes, but for errors of up to 0.05 voxels
/// and 10 degrees at nodes that are `inDoubt`.
CoreJets jetsOn(const std::shared_ptr<const JetCore>& core, const FrontsAt& fronts,
                const std::function<bool(const Vec3d&)>& inDoubt) {
    std::mt19937 random(5);
    std::uniform_real_distribution<double> one(-1, 1);
    CoreJets jets;
    jets.core = core;
    jets.seeds.leastStart = 0;
    jets.buckets = {0, 0.5};
    jets.state.resize(core->nodes.size());
    for (std::size_t k = 0; k < core->nodes.size(); ++k) {
        const Vec3d foot = core->footOf(core->nodes[k]);
        const std::vector<Front> all = fronts(foot);
        Front f = firstOf(all);
        double turn = 0;
        if (inDoubt(foot)) f.u += 0.05 * one(random), turn = 0.17 * one(random);
        const Vec2f g = TangentFrame(core->nodes[k].normal).flat(Vec3f(f.g));
        const auto c = float(std::cos(turn)), s = float(std::sin(turn));
        JetState& state = jets.state[k];
        state.bucket = jets.buckets.bucketOf(f.u, 1u << 30);
        state.rest = float(f.u - jets.buckets.startOf(state.bucket));
        state.g = (1 / length(g)) * Vec2f{c * g.x - s * g.y, s * g.x + c * g.y};
    }
    return jets;
}

/// A node, with directions up to 10 degrees off those of the fronts.
MeetingPoint pointAt(const JetCore& core, NodeIndex k, const FrontsAt& fronts,
                     std::mt19937& random) {
    std::uniform_real_distribution<float> turn(-0.17f, 0.17f);
    const JetNode& node = core.nodes[k];
    const auto all = fronts(core.footOf(node));
    MeetingPoint point{node.leaf, node.offset, node.foot, core.localFrame(k), 0, firstOf(all).u};
    for (const Front& f : all) {
        const Vec2f g = point.local.frame.flat(Vec3f(f.g));
        const float a = std::atan2(g.y, g.x) + turn(random);
        point.fronts.g[point.fronts.count++] = {std::cos(a), std::sin(a)};
    }
    return point;
}

struct Off {
    double value = 0;
    float direction = 0;
    std::size_t nodes = 0, missing = 0;
};
/// The errors at the nodes at which points are wanted.
Off errorsOf(const Band& band, const FrontsAt& fronts,
             const std::function<bool(const Vec3d&)>& inDoubt,
             const std::function<bool(const Vec3d&)>& isWanted) {
    const std::shared_ptr<const JetCore> core = buildJetCore(band, nullptr);
    const CoreJets jets = jetsOn(core, fronts, inDoubt);
    std::mt19937 random(6);
    std::vector<MeetingPoint> points;
    std::vector<NodeIndex> nodes;
    for (NodeIndex k = 0; k < core->nodes.size(); ++k)
        if (isWanted(core->footOf(core->nodes[k])))
            points.push_back(pointAt(*core, k, fronts, random)), nodes.push_back(k);
    const auto found = solveByRays(jets, points);
    Off off;
    off.nodes = nodes.size();
    for (std::size_t k = 0; k < nodes.size(); ++k) {
        if (!found[k]) {
            ++off.missing;
            continue;
        }
        const JetNode& node = core->nodes[nodes[k]];
        const auto all = fronts(core->footOf(node));
        off.value = std::max(off.value, std::abs(found[k]->u - firstOf(all).u));
        float least = 2;
        for (const Front& f : all)
            least = std::min(least, length(found[k]->g - points[k].local.frame.flat(Vec3f(f.g))));
        off.direction = std::max(off.direction, least);
    }
    // Alone, in registers of four: the same bits.
    const bool eight = eightAtATime();
    eightAtATime() = false;
    std::size_t differ = 0;
    for (std::size_t k = 0; k < nodes.size(); k += 7) {
        const auto alone = solveByRays(jets, {&points[k], 1})[0];
        differ += alone.has_value() != found[k].has_value() ||
                  (alone && (alone->u != found[k]->u || alone->g.x != found[k]->g.x));
    }
    eightAtATime() = eight;
    CHECK(differ == 0);
    return off;
}

}  // namespace

TEST_CASE("solveByRays: two plane fronts, at whatever angle they meet and beside whatever nodes") {
    const Vec3d normal = normalized(Vec3d{0.3, -0.5, 1}), t1 = anyNormalTo(normal),
                t2 = cross(normal, t1);
    const Band band = planeBand(normal, 0.3, {-24, -24, -24}, {24, 24, 24}, 1.8);
    // Fronts less than 14 degrees apart count as one at the ends of rays.
    const struct {
        double degrees, value;
        float direction;
    } figures[] = {{5, 0.048, 0.122f},    // measured 0.032, 0.081
                   {10, 0.0067, 0.085f},  // 0.0045, 0.057
                   {20, 7.8e-7, 6e-7f},   // 5.2e-7, 4.0e-7 at most from here on
                   {45, 7.8e-7, 6e-7f},
                   {80, 7.8e-7, 6e-7f}};
    for (const auto& [degrees, value, direction] : figures) {
        const double c = std::cos(degrees * M_PI / 180), s = std::sin(degrees * M_PI / 180);
        auto fronts = [&](const Vec3d& p) {
            const double x = dot(p, t1), y = dot(p, t2);
            return std::vector<Front>{{100 + c * x + s * y, c * t1 + s * t2},
                                      {100 + c * x - s * y, c * t1 - s * t2}};
        };
        // Where rays of 6 voxels lead away from the nodes in doubt.
        const double wide = std::min(0.8, 4 * s);
        const Off off = errorsOf(
            band, fronts, [&](const Vec3d& p) { return std::abs(dot(p, t2)) < wide; },
            [&](const Vec3d& p) { return std::abs(dot(p, t2)) < wide && length(p) < 14; });
        std::printf("plane fronts at %2.0f degrees: value %.1e, direction %.1e off; %zu nodes\n",
                    degrees, off.value, double(off.direction), off.nodes);
        CHECK(off.nodes > 20);
        CHECK(off.missing == 0);
        CHECK(off.value < value);
        CHECK(off.direction < direction);
    }
}

TEST_CASE("solveByRays: opposite a seed on a sphere, where the front comes from all sides") {
    const double radius = 20;
    const Vec3d center{0.31, -0.17, 0.43}, pole = normalized(Vec3d{1, 2, -0.7});
    const Band band = sphereBand(center, radius, 1.8);
    auto away = [&](const Vec3d& p) {
        return radius * std::atan2(length(cross(pole, p - center)), -dot(pole, p - center));
    };
    auto fronts = [&](const Vec3d& p) {
        const Vec3d n = normalized(p - center);
        return std::vector<Front>{
            {M_PI * radius - away(p), normalized(tangential(-1.0 * pole, n))}};
    };
    const Off off = errorsOf(
        band, fronts, [&](const Vec3d& p) { return away(p) < 2.5; },
        [&](const Vec3d& p) { return away(p) < 2.5; });
    std::printf("opposite a seed: value %.1e off; %zu nodes\n", off.value, off.nodes);
    CHECK(off.nodes > 15);
    CHECK(off.missing == 0);
    CHECK(off.value < 0.0026);  // measured 0.0017
}

TEST_CASE("solveByRays: nothing beside the end of S, and nothing near a seed") {
    const Band band = planeBand({0, 0, 1}, 0.2, {-20, -20, -4}, {0, 20, 4}, 1.8);
    const std::shared_ptr<const JetCore> core = buildJetCore(band, nullptr);
    // Toward -x: rays go to +x, where S ends at x = 0.
    auto fronts = [](const Vec3d& p) { return std::vector<Front>{{100 - p.x, {-1, 0, 0}}}; };
    const CoreJets jets = jetsOn(core, fronts, [](const Vec3d&) { return false; });
    std::mt19937 random(6);
    std::size_t beside = 0, inside = 0, refused = 0, refusedInside = 0;
    for (NodeIndex k = 0; k < core->nodes.size(); ++k) {
        const Vec3d p = core->footOf(core->nodes[k]);
        if (std::abs(p.y) > 10 || p.x < -19) continue;
        const auto found = solveByRays(jets, std::array{pointAt(*core, k, fronts, random)});
        if (p.x > -5.5) ++beside, refused += !found[0];
        if (p.x < -8) ++inside, refusedInside += !found[0];
    }
    CHECK(beside > 50);
    CHECK(refused == beside);
    CHECK(inside > 50);
    CHECK(refusedInside == 0);

    std::vector<MeetingPoint> points(4, {0, 0, {}, {TangentFrame({0, 0, 1}), 1, {}}, 0, 10});
    const auto at = [](double u) { return JetNeighbor{{1, 0}, {1, 0}, u}; };
    FrontsAtPoints arriving;
    arriving.add(0, std::array{at(10.9), at(20)});
    arriving.add(1, std::array{at(20), JetNeighbor{{0, 1}, {0, 1}, 20.1},
                               JetNeighbor{{-1, 0}, {-1, 0}, 20.3}});
    arriving.add(3, std::array{at(30)});
    arriving.finish(points);
    CHECK(points[0].fronts.count == 0);
    CHECK(points[1].fronts.count == 2);  // the last one arrives too late
    CHECK(points[2].fronts.count == 0);
    CHECK(points[3].fronts.count == 1);  // beside points with more neighbors
    arriving.add(2, std::array{at(30), JetNeighbor{{0, 1}, {0, 1}, 30.1}});
    arriving.finish(points);
    CHECK(points[2].fronts.count == 2);
    CHECK(points[3].fronts.count == 1);
}

}  // namespace igeo::test
