#include <igeo/march/detail/jet_meeting.h>

#include <igeo/base/parallel.h>
#include <igeo/march/detail/circular_front.h>

#include <array>
#include <bit>
#include <cstdint>

namespace igeo {

namespace {

/// The fronts at a node and beside it.
FrontsAround frontsAt(const CoreJets& jets, NodeIndex i) {
    const JetCore& core = *jets.core;
    const TangentFrame frame(core.nodes[i].normal, core.band.faceted);
    FrontsAround fronts;
    forLinks(core, i, [&](NodeIndex j, const Ijk&, const Vec3f& chord, float cosine) {
        if (!fronts.three() && jets.accepted(j))
            fronts.add(
                flattened(frame, chord, core.nodes[j].normal, cosine, jets.gradientOf(j), 0).g);
    });
    return fronts;
}

/// Core nodes around a voxel, in the order of their voxels, which does not depend on where the grid
/// begins.
class NodesAround {
public:
    NodesAround(const JetCore& core, const Ijk& middle) : core_(core), middle_(middle) {}

    /// Adds a node once; not if it is more than seven voxels off.
    void add(NodeIndex k) {
        const Ijk v = placeOf(k);
        if (((v.x | v.y | v.z) & ~(kEdge - 1)) != 0) return;
        there_[wordOf(v)] |= bitOf(v);
        node_[std::size_t((v.x << 4 | v.y) << 4 | v.z)] = k;
    }
    bool has(NodeIndex k) const {
        const Ijk v = placeOf(k);
        return ((v.x | v.y | v.z) & ~(kEdge - 1)) == 0 && there_[wordOf(v)] & bitOf(v);
    }
    template <typename Visit>
    void forAll(const Visit& visit) const {
        for (std::size_t word = 0; word < there_.size(); ++word)
            for (std::uint64_t bits = there_[word]; bits; bits &= bits - 1)
                visit(node_[word << 6 | std::size_t(std::countr_zero(bits))]);
    }

private:
    static constexpr int kHalf = 8, kEdge = 2 * kHalf;
    Ijk placeOf(NodeIndex k) const {
        return core_.voxelOf(core_.nodes[k]) - middle_ + Ijk{kHalf, kHalf, kHalf};
    }
    static std::size_t wordOf(const Ijk& v) { return std::size_t(v.x << 2 | v.y >> 2); }
    static std::uint64_t bitOf(const Ijk& v) { return std::uint64_t(1) << ((v.y & 3) << 4 | v.z); }
    const JetCore& core_;
    Ijk middle_;
    std::array<std::uint64_t, 64> there_{};
    std::array<NodeIndex, std::size_t(kEdge* kEdge* kEdge)> node_;  ///< where there is one
};

}  // namespace

std::optional<Solved> solveMeeting(const CoreJets& jets, const LocalFrame& local, const Ijk& voxel,
                                   const Vec3f& foot, std::span<const NodeIndex> around,
                                   double before, bool atFocus) {
    constexpr float kReach2 = 9;
    constexpr double kFallbackError = 0.25;  // voxels
    const JetCore& core = *jets.core;
    if (core.costsVary || core.metric.anisotropic() || around.empty()) return {};
    const std::uint32_t label = jets.labelOf(around.front());
    NodesAround all(core, voxel + roundToIjk(Vec3d(foot)));
    for (const NodeIndex k : around) {
        all.add(k);
        forLinks(
            core, k, [&](NodeIndex j, const Ijk&, const Vec3f&, float) { all.add(j); },
            [&](NodeIndex j) { return !all.has(j); });
    }
    std::vector<JetNeighbor> neighbors;
    bool oneSource = true;
    all.forAll([&](NodeIndex k) {
        const JetNode& node = core.nodes[k];
        const float cosine = dot(local.frame.normal(), node.normal);
        const Vec3f chord = foot - node.foot - Vec3f(core.voxelOf(node) - voxel);
        if (!jets.accepted(k) || cosine < Band::kOtherSheet || dot(chord, chord) > kReach2) return;
        oneSource &= jets.labelOf(k) == label;
        neighbors.push_back(flattened(local.frame, chord, node.normal, cosine, jets.gradientOf(k),
                                      (jets.valueOf(k) - jets.seeds.leastStart) / local.weight));
    });
    if (!oneSource) return {};
    // A focus takes three neighbors of its front.
    auto jet = fitCircularFront(neighbors, atFocus);
    if (!jet && atFocus) jet = fitCircularFront(neighbors, false);
    const double old = (before - jets.seeds.leastStart) / local.weight;
    if (!jet || !(std::abs(jet->u - old) < kFallbackError)) return {};
    return Solved{jet->u, jet->g, label};
}

void solveMeetings(CoreJets& jets, const std::vector<MayMeet>& nodes) {
    const JetCore& core = *jets.core;
    if (core.costsVary || core.metric.anisotropic()) return;
    struct Meeting {
        std::uint8_t fronts = 0;  ///< CoreJets::meetings
        std::optional<Solved> jet;
    };
    std::vector<Meeting> found(nodes.size());
    parallelFor(nodes.size(), 64, [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) {
            const NodeIndex i = nodes[k].node;
            const FrontsAround fronts = frontsAt(jets, i);
            if (!fronts.two() && !fronts.three()) continue;
            found[k].fronts = CoreJets::kTwo | (fronts.three() ? CoreJets::kThree : 0);
            if (!nodes[k].inDoubt) continue;
            const JetNode& node = core.nodes[i];
            found[k].jet = solveMeeting(jets, core.localFrame(i), core.voxelOf(node), node.foot,
                                        {&i, 1}, jets.valueOf(i), fronts.three());
        }
    });
    for (std::size_t k = 0; k < nodes.size(); ++k) {
        const Meeting& meeting = found[k];
        if (!meeting.fronts) continue;
        const NodeIndex i = nodes[k].node;
        jets.meetings.resize(core.nodes.size());
        jets.meetings[i] |= meeting.fronts;
        forLinks(core, i, [&](NodeIndex j, const Ijk&, const Vec3f&, float) {
            jets.meetings[j] |= meeting.fronts;
        });
        if (!meeting.jet) continue;
        JetState& state = jets.state[i];
        const double u = jets.seeds.leastStart + double(core.nodes[i].weight) * meeting.jet->u;
        state.rest = float(u - jets.buckets.startOf(state.bucket));
        state.g = meeting.jet->g;
    }
}

}  // namespace igeo
