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
    constexpr float kSmooth = 0.9f;
    const JetCore& core = *jets.core;
    if (core.nodes[i].obstacleState != Metric::Clear) return false;
    const TangentFrame frame(core.nodes[i].normal, core.band.faceted);
    ThreeFronts fronts;
    std::size_t links = 0;
    bool meet = false, smooth = true;
    forLinks(core, i, [&](NodeIndex j, const Ijk&, const Vec3f& chord, float cosine) {
        ++links;
        smooth &= cosine >= kSmooth;
        if (smooth && jets.accepted(j))
            meet |= fronts.add(
                flattened(frame, chord, core.nodes[j].normal, cosine, jets.gradientOf(j), 0).g);
    });
    return meet && smooth && links >= kAllAround;
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
    if (core.metric.anisotropic()) return;
    struct Meeting {
        NodeIndex node;
        std::optional<Solved> jet;
    };
    std::vector<std::optional<Meeting>> found(nodes.size());
    parallelFor(nodes.size(), 64, [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) {
            const NodeIndex i = nodes[k];
            if (!frontsMeet(jets, i)) continue;
            found[k] = {
                i, solveMeeting(jets, core.localFrame(i), core.footOf(core.nodes[i]), {&i, 1})};
        }
    });
    for (const std::optional<Meeting>& meeting : found) {
        if (!meeting) continue;
        const NodeIndex i = meeting->node;
        jets.meetInLeaf.resize(core.band.leaves.size());
        for (const LeafIndex l : core.band.leaves[core.nodes[i].leaf].neighbor)
            if (l != kNoLeaf) jets.meetInLeaf[l] = 1;
        if (!meeting->jet) continue;
        JetState& state = jets.state[i];
        const double u = jets.seeds.leastStart + double(core.nodes[i].weight) * meeting->jet->u;
        state.rest = float(u - jets.buckets.startOf(state.bucket));
        state.g = meeting->jet->g;
    }
}

}  // namespace igeo
