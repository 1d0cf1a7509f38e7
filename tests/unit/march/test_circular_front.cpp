// The fit of fronts that meet against fronts known in closed form.
#include <igeo/march/detail/circular_front.h>
#include <support/catch.h>

#include <cmath>
#include <cstdio>
#include <random>
#include <vector>

namespace igeo {
namespace {

/// A lattice around the origin as far as two voxels off, jittered as foot points are.
template <typename JetAt>
std::vector<JetNeighbor> lattice(std::mt19937& random, const JetAt& at) {
    std::uniform_real_distribution<float> place(-0.5f, 0.5f), jitter(-0.1f, 0.1f);
    const Vec2f low{place(random), place(random)};
    std::vector<JetNeighbor> all;
    for (int x = -2; x <= 2; ++x)
        for (int y = -2; y <= 2; ++y) {
            const Vec2f p = low + Vec2f{float(x) + jitter(random), float(y) + jitter(random)};
            if (length(p) < 2.1f) all.push_back(at(p));
        }
    return all;
}

/// At `p` the front that spreads from a source (sign 1), or narrows to a focus (-1).
JetNeighbor aroundMiddle(Vec2f p, Vec2f middle, float sign) {
    const Vec2f r = p - middle;
    return {-1.0f * p, (sign / length(r)) * r, double(sign * length(r))};
}

}  // namespace

TEST_CASE("fitCircularFront is exact for circular fronts, at a focus and beside it") {
    std::mt19937 random(4);
    std::uniform_real_distribution<float> angle(0, 6.2831853f);
    for (const float sign : {-1.0f, 1.0f})
        for (const float distance : {0.0f, 0.05f, 0.2f, 0.5f, 1.0f, 1.5f, 3.0f, 20.0f, 1000.0f}) {
            if (sign > 0 && distance < 2.5f) continue;  // start discs
            double worst = 0, turned = 0;
            int missing = 0;
            for (int trial = 0; trial < 300; ++trial) {
                const float a = angle(random);
                const Vec2f middle{distance * std::cos(a), distance * std::sin(a)};
                const auto jet = fitCircularFront(
                    lattice(random, [&](Vec2f p) { return aroundMiddle(p, middle, sign); }));
                if (!jet) {
                    ++missing;
                    continue;
                }
                worst = std::max(worst, std::abs(jet->u - double(sign * distance)));
                const Vec2f g{-sign * std::cos(a), -sign * std::sin(a)};
                if (distance > 0) turned = std::max(turned, double(length(jet->g - g)));
            }
            std::printf("%s at %6.1f: value %.2g, direction %.2g off; %d without\n",
                        sign < 0 ? "focus" : "source", double(distance), worst, turned, missing);
            // At a focus itself neighbors do not say where their fronts come from: 20 without.
            CHECK(missing <= (distance > 0 ? 0 : 30));
            CHECK(worst < 1.4e-7 * (20 + double(distance)));  // measured 0.5 to 0.9e-7 of that
            CHECK(turned < 7e-5);                             // 4.3e-5
        }
}

TEST_CASE("fitCircularFront takes the least of two plane fronts, at whatever angle they meet") {
    std::mt19937 random(3);
    std::uniform_real_distribution<float> offset(-0.4f, 0.4f);
    for (const double degrees : {5.0, 10.0, 20.0, 30.0, 45.0, 60.0, 80.0, 90.0}) {
        const auto c = float(std::cos(degrees * M_PI / 180)),
                   s = float(std::sin(degrees * M_PI / 180));
        double low = 0, high = 0, squares = 0;
        int count = 0;
        for (int trial = 0; trial < 500; ++trial) {
            const float ridge = offset(random);  // at y = ridge
            const auto jet = fitCircularFront(lattice(random, [&](Vec2f p) {
                const Vec2f g{c, p.y < ridge ? s : -s};
                return JetNeighbor{-1.0f * p, g, double(c * p.x - s * std::abs(p.y - ridge))};
            }));
            if (!jet) continue;
            const double error = jet->u + double(s * std::abs(ridge));
            low = std::min(low, error), high = std::max(high, error);
            squares += error * error, ++count;
        }
        std::printf(
            "plane fronts %2.0f degrees from the ridge: %.4f to %.4f off, rms %.4f; %d of "
            "500\n",
            degrees, low, high, std::sqrt(squares / std::max(count, 1)), count);
        CHECK(count == 500);
        CHECK(high < 0.026);  // measured 0.0168, at 10 degrees
        CHECK(low > -0.003);  // -0.0019, at 5 degrees
    }
}

TEST_CASE("fitCircularFront: nothing where neighbors are few, ahead of the point, or at odds") {
    const auto at = [](float x, float y) { return aroundMiddle({x, y}, {9, 1}, -1); };
    CHECK(!fitCircularFront({}));
    CHECK(!fitCircularFront(std::vector{at(-1, 0), at(-1, 1)}));
    const auto plane = [](float x, float y) { return JetNeighbor{{-x, -y}, {1, 0}, double(x)}; };
    CHECK(!fitCircularFront(std::vector{plane(-1, 0), plane(-1, 1)}));
    CHECK(fitCircularFront(std::vector{at(-1, 0), at(-1, 1), at(-1, -1)}));
    CHECK(!fitCircularFront(std::vector{at(1, 0), at(1, 1), at(1, -1)}));
    std::vector<JetNeighbor> odd{at(-1, 0), at(-1, 1), at(-1, -1), at(-2, 0)};
    for (std::size_t k = 0; k < odd.size(); ++k) odd[k].u += k % 2 == 0 ? 0.2 : -0.2;
    CHECK(!fitCircularFront(odd));
}

}  // namespace igeo
