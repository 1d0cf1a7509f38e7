#include <igeo/march/detail/jet_meeting.h>

#include <igeo/base/parallel.h>
#include <igeo/march/detail/circular_front.h>

#include <algorithm>
#include <tuple>

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

/// The nodes of a list and of their links, in the order of their voxels, which does not depend on
/// where the grid begins.
std::vector<NodeIndex> withLinks(const JetCore& core, std::span<const NodeIndex> nodes) {
    std::vector<NodeIndex> all(nodes.begin(), nodes.end());
    for (const NodeIndex k : nodes)
        forLinks(core, k, [&](NodeIndex j, const Ijk&, const Vec3f&, float) { all.push_back(j); });
    auto isBefore = [&](NodeIndex a, NodeIndex b) {
        const Ijk v = core.voxelOf(core.nodes[a]), w = core.voxelOf(core.nodes[b]);
        return std::tuple(v.x, v.y, v.z) < std::tuple(w.x, w.y, w.z);
    };
    std::sort(all.begin(), all.end(), isBefore);
    all.erase(std::unique(all.begin(), all.end()), all.end());
    return all;
}

}  // namespace

std::optional<Solved> solveMeeting(const CoreJets& jets, const LocalFrame& local, const Ijk& voxel,
                                   const Vec3f& foot, std::span<const NodeIndex> around,
                                   double before) {
    constexpr float kReach2 = 9;
    constexpr double kFallbackError = 0.25;  // voxels
    const JetCore& core = *jets.core;
    if (core.costsVary || core.metric.anisotropic() || around.empty()) return {};
    const std::uint32_t label = jets.labelOf(around.front());
    std::vector<JetNeighbor> neighbors;
    for (const NodeIndex k : withLinks(core, around)) {
        const JetNode& node = core.nodes[k];
        const float cosine = dot(local.frame.normal(), node.normal);
        const Vec3f chord = foot - node.foot - Vec3f(core.voxelOf(node) - voxel);
        if (!jets.accepted(k) || cosine < Band::kOtherSheet || dot(chord, chord) > kReach2)
            continue;
        if (jets.labelOf(k) != label) return {};
        neighbors.push_back(flattened(local.frame, chord, node.normal, cosine, jets.gradientOf(k),
                                      (jets.valueOf(k) - jets.seeds.leastStart) / local.weight));
    }
    const auto jet = fitCircularFront(neighbors);
    const double old = (before - jets.seeds.leastStart) / local.weight;
    if (!jet || !(std::abs(jet->u - old) < kFallbackError)) return {};
    return Solved{jet->u, jet->g, label};
}

void solveMeetings(CoreJets& jets, const std::vector<NodeIndex>& nodes) {
    const JetCore& core = *jets.core;
    if (core.costsVary || core.metric.anisotropic()) return;
    struct Meeting {
        NodeIndex node;
        std::optional<Solved> jet;
    };
    std::vector<std::optional<Meeting>> found(nodes.size());
    parallelFor(nodes.size(), 64, [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) {
            const NodeIndex i = nodes[k];
            if (!frontsMeet(jets, i)) continue;
            const JetNode& node = core.nodes[i];
            found[k] = {i, solveMeeting(jets, core.localFrame(i), core.voxelOf(node), node.foot,
                                        {&i, 1}, jets.valueOf(i))};
        }
    });
    for (const std::optional<Meeting>& meeting : found) {
        if (!meeting) continue;
        const NodeIndex i = meeting->node;
        jets.meetings.resize(core.nodes.size());
        jets.meetings[i] = true;
        forLinks(core, i,
                 [&](NodeIndex j, const Ijk&, const Vec3f&, float) { jets.meetings[j] = true; });
        if (!meeting->jet) continue;
        JetState& state = jets.state[i];
        const double u = jets.seeds.leastStart + double(core.nodes[i].weight) * meeting->jet->u;
        state.rest = float(u - jets.buckets.startOf(state.bucket));
        state.g = meeting->jet->g;
    }
}

}  // namespace igeo
