#include <igeo/march/detail/jet_meeting.h>

#include <igeo/base/parallel.h>
#include <igeo/march/detail/jet_rays.h>

#include <algorithm>
#include <array>
#include <optional>
#include <utility>

namespace igeo {

namespace {

/// Nodes across which fronts meet, where S is smooth and without obstacles.
struct Meetings {
    std::vector<NodeIndex> nodes;
    std::vector<std::optional<Solved>> jets;  ///< theirs, by rays
    std::vector<NodeIndex> around;            ///< their neighbors, ascending
    std::vector<NodeIndex> beside;  ///< nodes at links over which fronts meet, ascending, among
                                    ///< others

    void append(const Meetings& other) {
        nodes.insert(nodes.end(), other.nodes.begin(), other.nodes.end());
        jets.insert(jets.end(), other.jets.begin(), other.jets.end());
        around.insert(around.end(), other.around.begin(), other.around.end());
        beside.insert(beside.end(), other.beside.begin(), other.beside.end());
    }
};

/// The same of a part of the nodes, while it is looked at.
struct MeetingSearch {
    Meetings found;
    std::vector<MeetingPoint> points;    ///< one per found node
    std::vector<JetNeighbor> neighbors;  ///< of the node in work
};

void sortUnique(std::vector<NodeIndex>& nodes) {
    std::sort(nodes.begin(), nodes.end());
    nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
}

/// The links of the core after a march.
class Links {
public:
    /// @param own  of the march, where the core has none: made again where they are needed, and
    ///             only as long
    Links(const JetCore& core, JetLinks& own) : core_(core), own_(own) {}

    JetLinks::Row rowAt(NodeIndex i) const {
        if (!core_.links.empty()) return core_.links.rowAt(i);
        own_.make(core_, i);
        return own_.rowAt(i);
    }
    /// Drops the block of a node, which no other thread looks at.
    void drop(NodeIndex i) const {
        if (core_.links.empty()) own_.drop(i);
    }

private:
    const JetCore& core_;
    JetLinks& own_;
};

/// Adds a node, if fronts meet across it.
void visit(const CoreJets& jets, const Links& links, NodeIndex i, MeetingSearch& search) {
    constexpr float kToward = 0.1f;
    const JetCore& core = *jets.core;
    const JetNode& node = core.nodes[i];
    if (!jets.accepted(i) || node.obstacleState != Metric::Clear) return;
    const auto [row, creased] = links.rowAt(i);
    const std::uint32_t label = jets.labelOf(i);
    const auto value = [&](NodeIndex k) {
        return (jets.valueOf(k) - jets.seeds.leastStart) / double(node.weight);
    };
    std::vector<JetNeighbor>& neighbors = search.neighbors;
    neighbors.clear();
    FrontsMeet fronts(jets.state[i].g);
    bool plain = !creased;
    for (const JetLink& link : row) {
        const NodeIndex j = link.node();
        plain &= jets.labelOf(j) == label;
        if (!jets.accepted(j)) continue;
        neighbors.push_back({link.a(), link.turned(jets.state[j].g), value(j)});
        if (fronts.add(neighbors.back()) > kToward) search.found.beside.push_back(j);
    }
    if (!plain || !fronts.meet()) return;
    search.found.nodes.push_back(i);
    for (const JetLink& link : row) search.found.around.push_back(link.node());
    search.points.push_back(
        {node.leaf, node.offset, node.foot, core.localFrame(i), label, value(i)});
    search.points.back().findFronts(neighbors);
}

bool inOneBlock(NodeIndex a, NodeIndex b) { return a / JetLinks::kBlock == b / JetLinks::kBlock; }

/// Ends of parts of a list of ascending nodes: each block of links belongs to one.
std::vector<std::size_t> partsOf(std::span<const NodeIndex> nodes) {
    constexpr std::size_t kPart = 256;
    std::vector<std::size_t> ends;
    for (std::size_t k = kPart; k < nodes.size(); ++k)
        if (!inOneBlock(nodes[k - 1], nodes[k])) ends.push_back(k), k += kPart - 1;
    ends.push_back(nodes.size());
    return ends;
}

/// Those among a part of the nodes, which is ascending: a block of links is made once, and dropped
/// as soon as it was used.
Meetings meetingsIn(const CoreJets& jets, const Links& links, std::span<const NodeIndex> nodes) {
    MeetingSearch search;
    for (std::size_t k = 0; k < nodes.size(); ++k) {
        visit(jets, links, nodes[k], search);
        if (k + 1 == nodes.size() || !inOneBlock(nodes[k], nodes[k + 1])) links.drop(nodes[k]);
    }
    search.found.jets = solveByRays(jets, {}, search.points);
    sortUnique(search.found.around);
    sortUnique(search.found.beside);
    return std::move(search.found);
}

/// Those among the nodes, in their order.
Meetings meetingsAmong(const CoreJets& jets, const Links& links, std::span<const NodeIndex> nodes) {
    const std::vector<std::size_t> ends = partsOf(nodes);
    std::vector<Meetings> parts(ends.size());
    parallelFor(parts.size(), 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t p = begin; p < end; ++p) {
            const std::size_t first = p ? ends[p - 1] : 0;
            parts[p] = meetingsIn(jets, links, nodes.subspan(first, ends[p] - first));
        }
    });
    Meetings all;
    for (Meetings& part : parts) all.append(std::exchange(part, {}));
    return all;
}

/// Those among the nodes and beside them.
Meetings meetingsAround(const CoreJets& jets, const Links& links, std::vector<NodeIndex> nodes) {
    std::sort(nodes.begin(), nodes.end());
    Meetings found = meetingsAmong(jets, links, nodes);
    std::vector<NodeIndex> beside = std::move(found.beside);
    sortUnique(beside);
    std::erase_if(beside,
                  [&](NodeIndex j) { return std::binary_search(nodes.begin(), nodes.end(), j); });
    found.append(meetingsAmong(jets, links, beside));
    return found;
}

void setJet(CoreJets& jets, NodeIndex i, const Solved& jet) {
    JetState& state = jets.state[i];
    const double u = jets.seeds.leastStart + double(jets.core->nodes[i].weight) * jet.u;
    state.rest = float(u - jets.buckets.startOf(state.bucket));
    state.g = jet.g;
}

}  // namespace

void solveMeetings(CoreJets& jets, JetLinks& own, const std::vector<NodeIndex>& nodes) {
    const JetCore& core = *jets.core;
    if (core.costsVary || core.metric.anisotropic() || nodes.empty()) return;
    // All are solved before one is changed.
    const Meetings meetings = meetingsAround(jets, Links(core, own), nodes);
    if (meetings.nodes.empty()) return;
    jets.meetings.resize(core.nodes.size());
    for (const NodeIndex i : meetings.around) jets.meetings[i] = true;
    for (std::size_t k = 0; k < meetings.nodes.size(); ++k) {
        const NodeIndex i = meetings.nodes[k];
        jets.meetings[i] = true;
        if (meetings.jets[k]) setJet(jets, i, *meetings.jets[k]);
    }
}

}  // namespace igeo
