#include <igeo/march/detail/jet_meeting.h>

#include <igeo/base/parallel.h>
#include <igeo/march/detail/circular_front.h>

#include <algorithm>

namespace igeo {

namespace {

/// Whether three fronts or more meet at a node, or beside it, as at a focus, where S is smooth and
/// goes on all around. Two fronts are fitted well enough by the march.
bool frontsMeet(const CoreJets& jets, NodeIndex i) {
    constexpr std::size_t kAllAround = 7;  // as in the march
    const JetCore& core = *jets.core;
    const auto row = core.links.row(i);
    if (core.nodes[i].obstacleState != Metric::Clear || row.size() < kAllAround) return false;
    ThreeFronts fronts;
    bool meet = false;
    for (const JetLink& link : row) {
        if (link.overCrease()) return false;
        const JetState& other = jets.state[link.node()];
        if (other.accepted()) meet |= fronts.add(link.turned(other.g));
    }
    return meet;
}

/// The nodes of a list and of their links, in their order.
std::vector<NodeIndex> withLinks(const JetCore& core, std::span<const NodeIndex> nodes) {
    std::vector<NodeIndex> all(nodes.begin(), nodes.end());
    for (const NodeIndex k : nodes)
        forLinks(core, k, [&](NodeIndex j, const Ijk&, const Vec3f&, float) { all.push_back(j); });
    std::sort(all.begin(), all.end());
    all.erase(std::unique(all.begin(), all.end()), all.end());
    return all;
}

}  // namespace

std::optional<Solved> solveMeeting(const CoreJets& jets, const LocalFrame& local, const Vec3d& foot,
                                   std::span<const NodeIndex> around) {
    constexpr float kReach2 = 9.0f;
    const JetCore& core = *jets.core;
    if (core.metric.anisotropic() || around.empty()) return {};
    const std::uint32_t label = jets.labelOf(around.front());
    std::vector<JetNeighbor> neighbors;
    for (const NodeIndex k : withLinks(core, around)) {
        const JetNode& node = core.nodes[k];
        const float cosine = dot(local.frame.normal(), node.normal);
        const Vec3f chord(foot - core.footOf(node));
        if (!jets.accepted(k) || cosine < Band::kOtherSheet || dot(chord, chord) > kReach2)
            continue;
        if (jets.labelOf(k) != label) return {};
        neighbors.push_back(flattened(
            local.frame, meanWeight(node.weight, float(local.weight)) * chord, node.normal, cosine,
            jets.gradientOf(k), (jets.valueOf(k) - jets.seeds.leastStart) / local.weight));
    }
    const auto jet = fitCircularFront(neighbors);
    if (!jet) return {};
    return Solved{jet->u, jet->g, label};
}

void solveMeetings(CoreJets& jets, const std::vector<NodeIndex>& nodes) {
    const JetCore& core = *jets.core;
    std::vector<NodeIndex> meetings;
    for (const NodeIndex i : nodes)
        if (frontsMeet(jets, i)) meetings.push_back(i);
    if (meetings.empty()) return;
    std::vector<std::optional<Solved>> found(meetings.size());
    parallelFor(meetings.size(), 16, [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) {
            const NodeIndex i = meetings[k];
            found[k] = solveMeeting(jets, core.localFrame(i), core.footOf(core.nodes[i]), {&i, 1});
        }
    });
    jets.meetInLeaf.resize(core.band.leaves.size());
    for (std::size_t k = 0; k < meetings.size(); ++k) {
        const NodeIndex i = meetings[k];
        for (const LeafIndex l : core.band.leaves[core.nodes[i].leaf].neighbor)
            if (l != kNoLeaf) jets.meetInLeaf[l] = 1;
        if (!found[k]) continue;
        JetState& state = jets.state[i];
        const double u = jets.seeds.leastStart + double(core.nodes[i].weight) * found[k]->u;
        state.rest = float(u - jets.buckets.startOf(state.bucket));
        state.g = found[k]->g;
    }
}

}  // namespace igeo
