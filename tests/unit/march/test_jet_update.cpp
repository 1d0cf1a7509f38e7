// The local solve of jet against fronts known in closed form.
#include <igeo/band/tangent_frame.h>
#include <igeo/march/detail/fermat_update.h>
#include <igeo/march/detail/jet_blend.h>
#include <igeo/march/detail/jet_update.h>
#include <support/catch.h>

#include <cmath>
#include <cstdio>
#include <random>
#include <vector>

namespace igeo {
namespace {

/// A neighbor at `p`, seen from a node at the origin, on the circular front about `source`.
JetNeighbor onCircle(Vec2f p, Vec2f source, double start = 0) {
    const Vec2f r = p - source;
    return {-1.0f * p, (1 / length(r)) * r, start + double(length(r))};
}

/// Single precision: values to some 1e-7 of the few voxels between node and neighbors, and
/// distances to sources to 1e-7 of themselves.
float rounding(float distance) { return 4e-7f * (4 + distance); }

}  // namespace

TEST_CASE("jetUpdate is exact for circular fronts, near and far") {
    std::mt19937 random(7);
    std::uniform_real_distribution<float> angle(0, 6.2831853f), jitter(-0.4f, 0.4f);
    for (const float distance : {4.0f, 10.0f, 100.0f, 3000.0f}) {
        const float a = angle(random);
        const Vec2f source{distance * std::cos(a), distance * std::sin(a)};
        JetNeighbors all;
        for (int x = -1; x <= 1; ++x)
            for (int y = -1; y <= 1; ++y) {
                const Vec2f p{float(x) + jitter(random), float(y) + jitter(random)};
                // Accepted before the node: nearer to the source.
                if (length(p - source) < distance - 0.3f) all.add(onCircle(p, source));
            }
        REQUIRE(all.count() >= 2);
        const Jet jet = jetUpdate(all);
        INFO("source at " << distance << ", " << all.count() << " neighbors");
        CHECK(!jet.usedFallback);
        // The direction is predicted exactly for such fronts, so only roundings are left.
        CHECK(std::abs(jet.u - double(distance)) < double(rounding(distance)));
        CHECK(length(jet.g + (1 / distance) * source) < 1e-3f);
    }
}

TEST_CASE("jetUpdate from two neighbors of a front that narrows to a focus") {
    // The values say that the source lies 480 voxels behind.
    constexpr float kFocus = 15;
    constexpr double kValue = 480;
    double value = 0, direction = 0;
    for (const float turn : {0.0f, 0.9f, 2.5f, 4.1f}) {
        const Vec2f g{std::cos(turn), std::sin(turn)};
        JetNeighbors all;
        for (const Vec2f a : {Vec2f{1.69f, -0.35f}, Vec2f{0.65f, 0.49f}}) {
            const Vec2f back{g.x * a.x - g.y * a.y, g.y * a.x + g.x * a.y};
            const Vec2f toFocus = kFocus * g + back;
            const float far = length(toFocus);
            all.add({back, (1 / far) * toFocus, kValue + double(kFocus - far)});
        }
        const Jet jet = jetUpdate(all);
        CHECK(!jet.usedFallback);
        value = std::max(value, std::abs(jet.u - kValue));
        direction = std::max(direction, double(length(jet.g - g)));
    }
    std::printf("jetUpdate toward a focus: off by %.5f voxels, %.4f radians\n", value, direction);
    // Measured 0.00052 and 0.0040; 0.00149 and 0.0115 where the directions spread as from a source.
    CHECK(value < 0.00078);
    CHECK(direction < 0.006);
}

TEST_CASE("jetUpdate takes the lesser of two fronts") {
    JetNeighbors all;
    const Vec2f left{-9, 0}, right{9.3f, 0};
    for (const float y : {-1.0f, 0.0f, 1.0f}) all.add(onCircle({-1, y}, left));
    for (const float y : {-1.0f, 0.0f, 1.0f}) all.add(onCircle({1, y}, right));
    const Jet jet = jetUpdate(all);
    CHECK(std::abs(jet.u - 9) < double(rounding(9)));
    CHECK(jet.g.x > 0.999f);
}

TEST_CASE("jetUpdate with one neighbor goes straight on, with none nowhere") {
    JetNeighbors all;
    CHECK(jetUpdate(all).u == kInfinity);
    all.add({{0.6f, 0.8f}, {0.6f, 0.8f}, 5});
    const Jet jet = jetUpdate(all);
    CHECK(std::abs(jet.u - 6) < 1e-6);
    CHECK(jet.usedFallback);
    CHECK(length(jet.g - Vec2f{0.6f, 0.8f}) < 1e-6f);
}

TEST_CASE(
    "fermatUpdate is never below the values it starts from, and never above a straight line") {
    std::mt19937 random(11);
    std::uniform_real_distribution<float> at(-1.7f, 1.7f), angle(0, 6.2831853f);
    for (int k = 0; k < 1000; ++k) {
        JetNeighbors all;
        double least = kInfinity, bound = kInfinity;
        for (int n = 0; n < 6; ++n) {
            const float a = angle(random);
            const Vec2f p{at(random), at(random)};
            const double u = 20 + double(at(random));
            all.add({p, {std::cos(a), std::sin(a)}, u});
            least = std::min(least, u);
            bound = std::min(bound, u + double(length(p)));
        }
        const Jet jet = fermatUpdate(all);
        INFO("case " << k);
        REQUIRE(jet.u <= bound + 1e-5);
        // Hermite values may undershoot their ends: by 4/27 of a segment's length and slope at
        // most.
        REQUIRE(jet.u > least - 2 * 4.0 / 27 * 1.6);
        REQUIRE(std::abs(length(jet.g) - 1) < 1e-5f);
    }
}

TEST_CASE("boundFallbacks: the fallback lies between, and closely so on one front") {
    std::mt19937 random(12);
    std::uniform_real_distribution<float> at(-1.5f, 1.5f), angle(0, 6.2831853f), one(-1, 1);
    float widest = 0;
    for (int k = 0; k < 2000; ++k) {
        // Values and directions of one front that are off by a little, or by a lot.
        const float off = k % 2 ? 0.5f : 0.003f, from = angle(random);
        const Vec2f source{-30 * std::cos(from), -30 * std::sin(from)};
        JetNeighbors all;
        JetLanes lanes;
        const auto node = std::size_t(k % 8), count = std::size_t(2 + k % 7);
        lanes.base = {};
        for (std::size_t n = 0; n < count; ++n) {
            JetNeighbor next = onCircle({at(random), at(random)}, source);
            const float turn = off * one(random), c = std::cos(turn), s = std::sin(turn);
            next.g = {c * next.g.x - s * next.g.y, s * next.g.x + c * next.g.y};
            next.u += double(off * one(random));
            all.add(next);
            JetLanes::Neighbor& to = lanes.neighbor[n];
            to.ax[node] = next.a.x, to.ay[node] = next.a.y;
            to.gx[node] = next.g.x, to.gy[node] = next.g.y, to.u[node] = float(next.u);
        }
        lanes.count[node] = std::uint32_t(count);
        lanes.pad();
        Lanes longest2{};
        longest2[node] = all.longest2;
        FermatBounds bounds;
        boundFallbacks(lanes, longest2, bounds);
        const auto u = float(fermatUpdate(all).u);
        INFO("case " << k);
        REQUIRE(bounds.least[node] < u + 2e-5f);
        // The search misses the least by a little.
        REQUIRE(bounds.most[node] > u - 2e-3f);
        if (k % 2 == 0) REQUIRE(u < bounds.most[node] + 1e-4f);
        if (k % 2 == 0) widest = std::max(widest, bounds.most[node] - bounds.least[node]);
    }
    std::printf("bounds of fallbacks: up to %.1e apart\n", double(widest));
    CHECK(widest < 0.017f);  // measured 0.011
}

TEST_CASE("blendJets interpolates a circular front exactly and keeps two fronts apart") {
    JetNeighbors around;
    std::array<float, JetNeighbors::kMax> weight{};
    const Vec2f source{-7, 3};
    for (const Vec2f p : {Vec2f{-0.5f, -0.5f}, {0.5f, -0.5f}, {-0.5f, 0.5f}, {0.5f, 0.5f}}) {
        weight[std::size_t(around.count())] = 0.25f;
        around.add(onCircle(p, source));
    }
    const Jet jet = blendJets(around, weight);
    // The blended direction is off by a share of the spread squared, (0.7 / 7.6)^2 / 8, times half
    // a voxel; across the front only.
    CHECK(std::abs(jet.u - double(length(source))) < 1e-6);  // measured 4.5e-08

    JetNeighbors both;
    both.add(onCircle({-0.5f, 0}, {-8, 0}));
    both.add(onCircle({0.5f, 0}, {8.5f, 0}));
    CHECK(std::abs(blendJets(both, weight).u - 8) < double(rounding(8)));
}

namespace {

/// The corners of a cell around the origin, jittered as foot points are, with the jets of `at`.
template <typename JetAt>
JetNeighbors cornersOfCell(std::mt19937& random, const JetAt& at,
                           std::array<float, JetNeighbors::kMax>& weight) {
    std::uniform_real_distribution<float> place(0.05f, 0.95f), jitter(-0.1f, 0.1f);
    const Vec2f low{place(random) - 1, place(random) - 1};
    JetNeighbors all;
    for (int k = 0; k < 8; ++k) {
        const auto x = float(k & 1), y = float(k >> 1 & 1);
        weight[std::size_t(k)] = (x > 0 ? -low.x : 1 + low.x) * (y > 0 ? -low.y : 1 + low.y) / 2;
        all.add(at(low + Vec2f{x + jitter(random), y + jitter(random)}));
    }
    return all;
}

}  // namespace

TEST_CASE("blendJets takes the least of two plane fronts, at whatever angle they meet") {
    std::mt19937 random(3);
    std::uniform_real_distribution<float> offset(-0.4f, 0.4f);
    std::array<float, JetNeighbors::kMax> weight{};
    for (const double degrees : {10.0, 20.0, 30.0, 45.0, 60.0, 80.0, 90.0}) {
        const auto c = float(std::cos(degrees * M_PI / 180)),
                   s = float(std::sin(degrees * M_PI / 180));
        for (int trial = 0; trial < 100; ++trial) {
            const float ridge = offset(random);  // at y = ridge
            auto at = [&](Vec2f p) {
                const Vec2f g{c, p.y < ridge ? s : -s};
                return JetNeighbor{-1.0f * p, g, double(c * p.x - s * std::abs(p.y - ridge))};
            };
            const Jet jet = blendJets(cornersOfCell(random, at, weight), weight);
            INFO(degrees << " degrees, ridge at " << ridge);
            REQUIRE(std::abs(jet.u + double(s * std::abs(ridge))) < 1e-5);
        }
    }
}

TEST_CASE("blendJets: at a focus, and toward it, and away from a source") {
    std::mt19937 random(4);
    std::uniform_real_distribution<float> angle(0, 6.2831853f);
    std::array<float, JetNeighbors::kMax> weight{};
    const struct {
        float distance, sign;  // -1: a focus
        double most;
    } cases[] = {{0, -1, 1e-5},      // exact: a focus is where all plane fronts arrive
                 {0.5f, -1, 0.19},   // measured 0.128
                 {1.5f, -1, 0.09},   // 0.059
                 {3, -1, 0.0024},    // 0.0016
                 {20, -1, 0.0003},   // 0.0002
                 {3.5f, 1, 0.0014},  // 0.0009
                 {20, 1, 0.0002}};   // 0.0001
    for (const auto& [distance, side, most] : cases) {
        const float sign = side;  // a lambda captures no binding in clang 14
        double worst = 0;
        for (int trial = 0; trial < 200; ++trial) {
            const float a = angle(random);
            const Vec2f middle{distance * std::cos(a), distance * std::sin(a)};
            auto at = [&](Vec2f p) {
                JetNeighbor n = onCircle(p, middle);
                return JetNeighbor{n.a, sign * n.g, double(sign) * n.u};
            };
            const Jet jet = blendJets(cornersOfCell(random, at, weight), weight);
            worst = std::max(worst, std::abs(jet.u - double(sign * distance)));
        }
        std::printf("blendJets, %s at %.1f: at most %.4f off\n", sign < 0 ? "focus" : "source",
                    double(distance), worst);
        CHECK(worst < most);
    }
}

TEST_CASE(
    "blendJets: a front with little weight comes from somewhere, and not before the others allow") {
    // Corners on one face with a plane front, which is 20 here, and one with little weight.
    const auto withOne = [](const JetNeighbor& one, bool besideSeed, float itsWeight = 0.04f) {
        JetNeighbors all;
        std::array<float, JetNeighbors::kMax> weight{};
        for (const Vec2f p : {Vec2f{-0.5f, -0.5f}, {0.5f, -0.5f}, {-0.5f, 0.5f}, {0.5f, 0.5f}}) {
            weight[std::size_t(all.count())] = 0.24f;
            all.add({-1.0f * p, {1, 0}, 20 + double(p.x)});
        }
        weight[std::size_t(all.count())] = itsWeight;
        all.add(one);
        return blendJets(all, weight, besideSeed).u;
    };
    // Over an edge, beyond the point: its front would be at 18.6 here, and no corner says from
    // where.
    const JetNeighbor beyond{{2.3f, 0}, {-0.6f, 0.8f}, 20};
    CHECK(std::abs(withOne(beyond, false) - 20) < 1e-5);
    // Of the other side of a wall: at 15.5 here, where the corners allow 19.8 by the least.
    const JetNeighbor wall{{1, 0.5f}, {0.6f, 0.8f}, 14.5};
    CHECK(std::abs(withOne(wall, false) - 20) < 1e-5);
    CHECK(std::abs(withOne(wall, false, 0.5f) - 20) < 1e-5);
    // Beside a seed the corners may be wrong, unless they have more than twice its weight.
    CHECK(std::abs(withOne(wall, true, 0.5f) - 15.5) < 1e-5);
    CHECK(std::abs(withOne(wall, true, 0.4f) - 20) < 1e-5);
    CHECK(std::abs(withOne(wall, true) - 20) < 1e-5);
    // A front that meets theirs, and comes a little earlier here.
    const JetNeighbor meets{{-0.7f, 0}, {-1, 0}, 19.2};
    CHECK(std::abs(withOne(meets, false) - 19.9) < 1e-5);
}

TEST_CASE("JetGroup: a node has the same bits in any lane and any company") {
    std::mt19937 random(5);
    std::uniform_real_distribution<float> at(-1.7f, 1.7f), angle(0, 6.2831853f);
    std::uniform_int_distribution<int> count(0, 9), sourceOf(0, 5);
    struct Case {
        std::vector<JetNeighbor> neighbors;
        std::vector<std::uint32_t> sources;
        bool rim, crease;
    };
    auto randomCase = [&] {
        Case c;
        // Circular fronts with noise: fits, second fronts, fallbacks and several sources.
        const float a = angle(random), noise = sourceOf(random) == 0 ? 0.1f : 1e-4f;
        const Vec2f source{9 * std::cos(a), 9 * std::sin(a)}, other{-8 * std::cos(a), 7};
        const bool fronts = sourceOf(random) == 0, labels = sourceOf(random) == 0;
        for (int k = count(random); k > 0; --k) {
            const bool second = (fronts || labels) && sourceOf(random) < 2;
            JetNeighbor n = onCircle({at(random), at(random)}, second ? other : source, -9);
            n.u += double(noise * at(random));
            c.neighbors.push_back(n);
            c.sources.push_back(labels && second ? 1 : 0);
        }
        c.rim = sourceOf(random) == 0, c.crease = sourceOf(random) == 0;
        return c;
    };
    auto add = [](const Case& c, JetGroup& group) {
        group.begin(9);
        for (std::size_t k = 0; k < c.neighbors.size(); ++k) {
            const JetNeighbor& n = c.neighbors[k];
            group.add(n.a, n.g, float(n.u), c.sources[k], c.crease);
        }
    };
    std::size_t fallbacks = 0, seconds = 0;
    for (int trial = 0; trial < 500; ++trial) {
        std::vector<Case> cases;
        for (std::size_t k = 0; k < Lanes::kNodes; ++k) cases.push_back(randomCase());
        JetGroup together;
        together.clear();
        for (const Case& c : cases) add(c, together);
        const JetGroup::Solutions all = together.solve();
        for (std::size_t k = 0; k < cases.size(); ++k) {
            JetGroup alone;
            alone.clear();
            add(cases[k], alone);
            const JetGroup::Solution a = cases[k].rim ? together.solveAtRim(k) : all[k],
                                     b = cases[k].rim ? alone.solveAtRim(0) : alone.solve()[0];
            REQUIRE(a.u == b.u);
            REQUIRE((a.g.x == b.g.x && a.g.y == b.g.y && a.source == b.source));
            REQUIRE(a.usedFallback == b.usedFallback);
            fallbacks += a.usedFallback, seconds += a.source == 1;
        }
    }
    CHECK(fallbacks > 100);
    CHECK(seconds > 20);
}

TEST_CASE("TangentFrame: a geodesic of a sphere unfolds to its arc") {
    for (const double radius : {5.0, 20.0, 100.0}) {
        const Vec3d n0{0, 0, 1}, n1 = normalized(Vec3d{0.6 / radius, 1.1 / radius, 1});
        const double arc = radius * std::acos(dot(n0, n1));
        const TangentFrame frame{Vec3f(n0)};
        const auto cosine = float(dot(n0, n1));
        const Vec2f a = frame.unfold(Vec3f(radius * (n0 - n1)), Vec3f(n1), cosine);
        INFO("radius " << radius);
        // What the series leaves out is (c / R)^6 of the chord c; chords carry roundings of 1e-7.
        CHECK(std::abs(double(length(a)) - arc) < 2e-6 * arc + arc * std::pow(arc / radius, 6));
    }
}

TEST_CASE("TangentFrame: over a sharp edge both faces unfold") {
    // Faces z = 0 (y < 0) and y = 0 (z < 0) of a box meet along the x axis.
    const Vec3f top{0, 0, 1}, front{0, 1, 0};
    const Vec3f onTop{0.2f, -0.7f, 0}, onFront{1.1f, 0, -0.4f};
    const TangentFrame frame(front);
    const Vec2f a = frame.unfold(onFront - onTop, top, 0);
    CHECK(std::abs(length(a) - std::hypot(0.9f, 1.1f)) < 1e-6f);
    // A gradient that goes straight over the edge still goes away from it behind.
    const JetNeighbor n = flattened(frame, onFront - onTop, top, 0, Vec3f{0, 1, 0}, 3);
    const Vec3f turned = frame.lift(n.g);
    CHECK(length(turned - Vec3f{0, 0, -1}) < 1e-6f);
}

}  // namespace igeo
