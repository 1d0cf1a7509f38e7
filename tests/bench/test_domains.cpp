// What igeo_bench domains counts, against counting by hand.
#include <igeo/march/jet.h>
#include <support/catch.h>
#include <support/march_cases.h>
#include <support/openvdb.h>
#include <support/pinned.h>
#include <support/shapes.h>

#include <algorithm>
#include <map>
#include <set>
#include <tuple>

#include "domains.h"

namespace igeo::test {
namespace {

constexpr double kBucket = 0.5;  // voxels, JetOptions::bucketWidth

struct Marched : Pinned {
    Band band;
    Field field;
    Schedule schedule;

    explicit Marched(const Shape& shape, std::size_t seeds = 1)
        : band(bandOf(makeLevelSet(shape, 1, 3), std::sqrt(3.0))) {
        std::vector<SurfacePoint> from;
        for (std::size_t k = 0; k < seeds; ++k)
            from.push_back(nearestSurfacePoint(
                band, band.footPoint(NodeIndex((2 * k + 1) * band.size() / (2 * seeds)))));
        field = marchJet(band, {}, from);
        schedule = scheduleOf(field, kBucket);
    }
};

/// The sum over supersteps of the most that one domain has.
using PerDomain = std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint64_t>;
std::uint64_t sumOfMost(const PerDomain& load, const PerDomain& other = {}) {
    std::map<std::uint32_t, std::uint64_t> most;
    for (const PerDomain* loads : {&load, &other})
        for (const auto& [at, value] : *loads) most[at.first] = std::max(most[at.first], value);
    std::uint64_t sum = 0;
    for (const auto& [step, value] : most) sum += value;
    return sum;
}

/// Every node with every other: who has to be sent it.
template <typename Needed>
Traffic byHand(const Marched& m, const Domains& domains, const Needed& needed) {
    std::map<std::tuple<std::uint32_t, std::uint32_t, std::uint32_t>, std::uint64_t> pairs;
    std::map<std::uint32_t, std::uint64_t> copies;
    const Band& band = m.band;
    for (NodeIndex i = 0; i < band.size(); ++i) {
        if (!band.inCore(i)) continue;
        const std::uint32_t from = domains.owner[band.leafOf(i)];
        std::set<std::uint32_t> to;
        for (NodeIndex j = 0; j < band.size(); ++j)
            if (domains.owner[band.leafOf(j)] != from && needed(i, j))
                to.insert(domains.owner[band.leafOf(j)]);
        for (const std::uint32_t t : to) {
            ++pairs[{m.schedule.step[band.coreNode(i)], from, t}];
            ++copies[t];
        }
    }
    Traffic traffic;
    PerDomain sent, received, messagesOut, messagesIn;
    for (const auto& [key, records] : pairs) {
        const auto [step, from, to] = key;
        traffic.records += records;
        ++traffic.messages;
        sent[{step, from}] += records, received[{step, to}] += records;
        ++messagesOut[{step, from}], ++messagesIn[{step, to}];
    }
    traffic.mostRecords = sumOfMost(sent, received);
    traffic.mostMessages = sumOfMost(messagesOut, messagesIn);
    for (const auto& [domain, count] : copies)
        traffic.mostCopies = std::max(traffic.mostCopies, count);
    return traffic;
}

void checkSame(const Traffic& a, const Traffic& b) {
    CHECK(a.records == b.records);
    CHECK(a.messages == b.messages);
    CHECK(a.mostRecords == b.mostRecords);
    CHECK(a.mostMessages == b.mostMessages);
    CHECK(a.mostCopies == b.mostCopies);
}

int farthest(const Ijk& d) { return std::max({std::abs(d.x), std::abs(d.y), std::abs(d.z)}); }

}  // namespace

TEST_CASE("messages and records of domains are those counted by hand") {
    const Marched m(sphere({0.3, 0.1, 0.2}, 9), 2);
    const Band& band = m.band;
    for (const std::size_t parts : {2, 5})
        for (const std::size_t pieces : {1, 3}) {
            INFO(parts << " domains of " << pieces << " pieces");
            const Domains domains = domainsOf(band, parts, pieces);
            const Replay r = replay(band, m.schedule, domains);
            checkSame(r.links, byHand(m, domains, [&](NodeIndex i, NodeIndex j) {
                          return band.inCore(j) && farthest(band.ijk(i) - band.ijk(j)) <= 1;
                      }));
            checkSame(r.leaves, byHand(m, domains, [&](NodeIndex i, NodeIndex j) {
                          return farthest(band.leaves[band.leafOf(i)].origin -
                                          band.leaves[band.leafOf(j)].origin) <= 8;
                      }));
            PerDomain work;
            for (NodeIndex i = 0; i < band.size(); ++i)
                if (band.inCore(i))
                    ++work[{m.schedule.step[band.coreNode(i)], domains.owner[band.leafOf(i)]}];
            CHECK(r.busy == work.size());
            CHECK(r.mostWork == sumOfMost(work));
        }
}

TEST_CASE("domains share the core out, and one domain sends nothing") {
    const Marched m(torus({0.3, 0.1, 0.2}, 30, 12));
    const Band& band = m.band;
    std::uint32_t fullest = 0;  // of the leaves
    for (const BandLeaf& leaf : band.leaves) fullest = std::max(fullest, leaf.core.count);
    for (const std::size_t parts : {1, 2, 7, 32}) {
        std::uint64_t ofPatches = 0;  // records
        for (const std::size_t pieces : {1, 4}) {
            INFO(parts << " domains of " << pieces << " pieces");
            const Domains domains = domainsOf(band, parts, pieces);
            std::vector<std::uint64_t> share(parts);
            for (std::size_t l = 0; l < band.leaves.size(); ++l)
                share.at(domains.owner[l]) += band.leaves[l].core.count;
            std::uint64_t sum = 0;
            for (const std::uint64_t s : share) {
                sum += s;
                // Either end of a piece is off by half a leaf at most.
                CHECK(std::abs(double(s) - double(band.coreSize()) / double(parts)) <=
                      double(pieces * fullest));
            }
            CHECK(sum == band.coreSize());

            const Replay r = replay(band, m.schedule, domains);
            CHECK(r.nodes == m.field.solved);
            CHECK(r.largestShare == *std::max_element(share.begin(), share.end()));
            CHECK(r.links.records <= r.leaves.records);
            CHECK(r.links.messages <= r.leaves.messages);
            CHECK((r.links.records > 0) == (parts > 1));
            // Pieces of one domain lie apart.
            if (pieces == 1) ofPatches = r.links.records;
            CHECK((r.links.records > ofPatches) == (parts > 1 && pieces > 1));
            if (parts > 1) continue;
            CHECK(r.leaves.messages == 0);
            CHECK(r.mostWork == r.nodes);
            CHECK(r.busy == m.schedule.steps);
        }
    }
}

TEST_CASE("supersteps follow the values, and none is empty") {
    const Marched m(torus({0.3, 0.1, 0.2}, 30, 12), 3);
    std::vector<double> low(m.schedule.steps, kInfinity), high(m.schedule.steps, -1);
    for (NodeIndex i = 0; i < m.band.size(); ++i) {
        if (!m.band.inCore(i)) continue;
        const std::size_t step = m.schedule.step[m.band.coreNode(i)];
        low.at(step) = std::min(low[step], m.field.distance[i]);
        high[step] = std::max(high[step], m.field.distance[i]);
    }
    for (std::size_t s = 0; s < low.size(); ++s) {
        REQUIRE(high[s] >= low[s]);
        CHECK(high[s] - low[s] < kBucket);
        if (s > 0) CHECK(low[s] > high[s - 1]);
    }
}

}  // namespace igeo::test
