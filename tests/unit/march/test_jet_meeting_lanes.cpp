// Fronts that meet across nodes, side by side, against the same node by node.
#include <igeo/base/detail/registers.h>
#include <igeo/march/detail/jet_meeting_lanes.h>
#include <support/analytic_band.h>
#include <support/catch.h>

#include <cmath>
#include <cstring>
#include <random>

namespace igeo::test {
namespace {

/// Jets of two plane fronts, at random; a few nodes have none.
CoreJets randomJets(const std::shared_ptr<JetCore>& core) {
    std::mt19937 random(4);
    std::uniform_real_distribution<float> one(-1, 1);
    CoreJets jets;
    jets.core = core;
    jets.seeds.leastStart = 0;
    jets.buckets = {0, 0.5};
    jets.state.resize(core->nodes.size());
    for (JetState& state : jets.state) {
        const float angle = (random() % 2 ? 0.4f : 1.1f) + 0.05f * one(random);
        state.bucket = 900 + random() % 4;
        state.g = {std::cos(angle), std::sin(angle)};
        if (random() % 20) state.rest = 0.25f + 0.2f * one(random);
    }
    return jets;
}

}  // namespace

TEST_CASE("Fronts meet side by side where they meet node by node") {
    const Band band = planeBand({1, 2, 4}, 0.37, {-9, -9, -9}, {9, 9, 9}, 1.8);
    const std::shared_ptr<JetCore> core = buildJetCore(band, nullptr);
    buildLinks(*core);
    const CoreJets jets = randomJets(core);
    const bool eight = eightAtATime();
    std::size_t meetings = 0, differ = 0;
    for (NodeIndex first = 0; first + 7 <= core->nodes.size(); first += 7) {
        LinkedNodes nodes;
        for (NodeIndex i = first; i < first + 7; ++i)
            if (jets.accepted(i)) nodes.add(i, core->links.row(i));
        LinkedFronts fronts, byFour;
        findFronts(jets, nodes, fronts);
        eightAtATime() = false;
        findFronts(jets, nodes, byFour);
        eightAtATime() = eight;
        differ += fronts.meet != byFour.meet;
        for (std::size_t lane = 0; lane < nodes.size; ++lane) {
            const NodeIndex i = nodes.node[lane];
            FrontsMeet expected(jets.state[i].g);
            double least = kInfinity;
            const auto row = core->links.row(i);
            for (std::size_t k = 0; k < row.size(); ++k) {
                const NodeIndex j = row[k].node();
                const bool toward = fronts.toward[k] >> lane & 1;
                differ += (byFour.toward[k] >> lane & 1) != toward;
                if (!jets.accepted(j)) {
                    differ += toward;
                    continue;
                }
                const double u = jets.valueOf(j) - jets.buckets.startOf(jets.state[i].bucket);
                least = std::min(least, u);
                const Vec2f a = row[k].a(), g = row[k].turned(jets.state[j].g);
                differ += (expected.add({a, g, u}) > 0.1f) != toward;
                const Arrivals::Neighbor& n = fronts.arrivals.neighbor[k];
                const double arrival = u + double(dot(a, g));
                differ += dot(a, g) > 0 ? std::abs(double(n.u[lane]) - arrival) > 1e-5
                                        : n.u[lane] != JetFronts::kNoValue;
                differ += n.u[lane] != byFour.arrivals.neighbor[k].u[lane];
            }
            const bool meet = fronts.meet >> lane & 1;
            differ += meet != expected.meet();
            differ += least < kInfinity && std::abs(double(fronts.least[lane]) - least) > 1e-5;
            meetings += meet;
        }
        differ += fronts.meet >> nodes.size != 0;
    }
    CHECK(differ == 0);
    CHECK(meetings > 100);
}

TEST_CASE("Rows of links that are made alone are those of the whole block") {
    const Band band = planeBand({1, 2, 4}, 0.37, {-9, -9, -9}, {9, 9, 9}, 1.8);
    const std::shared_ptr<JetCore> core = buildJetCore(band, nullptr);
    const std::size_t size = core->nodes.size();
    JetLinks whole(size), parts(size);
    std::mt19937_64 random(6);
    std::size_t made = 0, differ = 0;
    for (NodeIndex first = 0; first < size; first += JetLinks::kBlock) {
        const std::uint64_t rows = random() & random();
        whole.make(*core, first);
        parts.makeRows(*core, first, rows);
        for (NodeIndex i = first; i < size && i < first + JetLinks::kBlock; ++i) {
            const auto row = whole.row(i), part = parts.row(i);
            if (rows >> (i - first) & 1)
                ++made, differ += part.size() != row.size() ||
                                  std::memcmp(part.data(), row.data(), row.size_bytes()) != 0;
            else
                differ += !part.empty();
        }
    }
    CHECK(differ == 0);
    CHECK(made > size / 8);
}

}  // namespace igeo::test
