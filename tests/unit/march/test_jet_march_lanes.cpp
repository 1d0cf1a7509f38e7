#include <igeo/march/detail/jet_march_lanes.h>

#include <cmath>
#include <random>

#include <support/catch.h>

namespace igeo::test {
namespace {

constexpr std::uint32_t kNext = 0x80000005;  // registers compare buckets with signs

std::vector<JetState> randomStates(std::mt19937& random, std::size_t count) {
    std::uniform_int_distribution<std::uint32_t> kind(0, 5), near(kNext - 3, kNext + 3);
    std::vector<JetState> states(count);
    for (JetState& state : states) {
        const std::uint32_t of = kind(random);
        state.bucket = of == 0 ? 0 : of == 1 ? kNoBucket : near(random);
        if (of > 3) state.rest = 0.25f;
    }
    return states;
}

}  // namespace

TEST_CASE("split sorts the links of a node as a loop over them does") {
    std::mt19937 random(3);
    constexpr std::size_t kStates = 50;
    std::uniform_int_distribution<std::size_t> size(0, JetLinks::kMax), node(0, kStates - 1);
    for (int trial = 0; trial < 200; ++trial) {
        const std::vector<JetState> states = randomStates(random, kStates);
        std::vector<JetLink> links(size(random) + JetLinks::kBehind);
        for (JetLink& link : links) {
            link.key = JetLink::keyOf(NodeIndex(node(random)));
            if (node(random) == 0) link.key |= JetLink::kCrease;
        }
        const std::span<const JetLink> row(links.data(), links.size() - JetLinks::kBehind);
        for (const bool isotropic : {true, false}) {
            std::vector<std::size_t> known, waiting;
            for (std::size_t k = 0; k < row.size(); ++k) {
                const JetState& state = states[row[k].node()];
                if (state.accepted())
                    known.push_back(k);
                else if (mayPut(state.bucket, kNext, isotropic))
                    waiting.push_back(k);
            }
            JetRows::Row sorted;
            sorted.links = row;
            split({&sorted, 1}, states.data(), kNext, isotropic);
            CHECK(std::vector<std::size_t>(sorted.known.begin(),
                                           sorted.known.begin() + sorted.knownCount) == known);
            CHECK(std::vector<std::size_t>(sorted.waiting.begin(),
                                           sorted.waiting.begin() + sorted.waitingCount) ==
                  waiting);
        }
    }
}

TEST_CASE("carry finds the buckets of a circular front, near and far") {
    std::mt19937 random(4);
    std::uniform_real_distribution<float> at(-1.5f, 1.5f), angle(0, 6.2831853f);
    for (const float radius : {2.0f, 50.0f})
        for (int trial = 0; trial < 100; ++trial) {
            const float a = angle(random), width = 0.01f;
            std::array<JetLink, 5> links{};
            JetRows::Row row;
            row.links = links, row.waitingCount = links.size(), row.waiting.fill(0);
            for (std::size_t k = 0; k < links.size(); ++k) {
                row.waiting[k] = std::uint8_t(k);
                links[k].ax = at(random), links[k].ay = at(random);
            }
            JetsOnLinks jets;
            const Vec2f g{std::cos(a), std::sin(a)};
            jets.add(0, -1.0f * g, radius, 1, row);  // lanes do not mix
            jets.add(0.3f, g, radius, 1, row);
            carry({7, width}, jets);
            for (std::size_t k = 0; k < links.size(); ++k) {
                const double x = -double(links[k].ax), y = -double(links[k].ay),
                             along = double(g.x) * x + double(g.y) * y,
                             far = std::hypot(double(radius * g.x) + x, double(radius * g.y) + y),
                             step = along > 0 ? far - double(radius) : std::hypot(x, y);
                CHECK(std::abs(double(jets.bucket[k][1]) - 7 - (0.3 + step) / double(width)) <
                      1.01);
            }
        }
}

TEST_CASE("carry stays within the buckets that there are") {
    std::array<JetLink, 1> links{};
    links[0].ax = -1e9f;
    JetRows::Row row;
    row.links = links, row.waitingCount = 1, row.waiting.fill(0);
    JetsOnLinks jets;
    jets.add(0, {1, 0}, 1e9f, 1, row);
    for (const std::uint32_t first : {1u, 0x80000000u, kNoBucket - 1000}) {
        carry({first, 0.1f}, jets);
        CHECK(jets.bucket[0][0] >= first);
        CHECK(jets.bucket[0][0] < kNoBucket);
    }
}

}  // namespace igeo::test
