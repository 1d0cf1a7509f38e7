#include <igeo/march/detail/jet_meeting.h>

#include <igeo/base/parallel.h>
#include <igeo/march/detail/jet_rays.h>

#include <algorithm>
#include <array>
#include <optional>

namespace igeo {

namespace {

/// Nodes across which fronts meet, where S is smooth and without obstacles.
struct Meetings {
    std::vector<NodeIndex> nodes;
    std::vector<MeetingPoint> points;
    std::vector<NodeIndex> around;       ///< their neighbors
    std::vector<NodeIndex> beside;       ///< nodes at links over which fronts meet, among others
    std::vector<JetNeighbor> neighbors;  ///< of the node in work

    void append(const Meetings& other) {
        nodes.insert(nodes.end(), other.nodes.begin(), other.nodes.end());
        points.insert(points.end(), other.points.begin(), other.points.end());
        around.insert(around.end(), other.around.begin(), other.around.end());
        beside.insert(beside.end(), other.beside.begin(), other.beside.end());
    }
};

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
void visit(const CoreJets& jets, const Links& links, NodeIndex i, Meetings& meetings) {
    constexpr float kToward = 0.1f;
    const JetCore& core = *jets.core;
    const JetNode& node = core.nodes[i];
    if (!jets.accepted(i) || node.obstacleState != Metric::Clear) return;
    const auto [row, creased] = links.rowAt(i);
    const std::uint32_t label = jets.labelOf(i);
    const auto value = [&](NodeIndex k) {
        return (jets.valueOf(k) - jets.seeds.leastStart) / double(node.weight);
    };
    std::vector<JetNeighbor>& neighbors = meetings.neighbors;
    neighbors.clear();
    FrontsMeet fronts(jets.state[i].g);
    bool plain = !creased;
    for (const JetLink& link : row) {
        const NodeIndex j = link.node();
        plain &= jets.labelOf(j) == label;
        if (!jets.accepted(j)) continue;
        neighbors.push_back({link.a(), link.turned(jets.state[j].g), value(j)});
        if (fronts.add(neighbors.back()) > kToward) meetings.beside.push_back(j);
    }
    if (!plain || !fronts.meet()) return;
    meetings.nodes.push_back(i);
    for (const JetLink& link : row) meetings.around.push_back(link.node());
    meetings.points.push_back(
        {node.leaf, node.offset, node.foot, core.localFrame(i), label, value(i)});
    meetings.points.back().findFronts(neighbors);
}

/// Ends of parts of a list that work is divided into.
/// @param mayEnd  whether a part may end before an element
template <typename MayEnd>
std::vector<std::size_t> partsOf(std::size_t size, const MayEnd& mayEnd) {
    constexpr std::size_t kPart = 256;
    std::vector<std::size_t> ends;
    for (std::size_t k = kPart; k < size; ++k)
        if (mayEnd(k)) ends.push_back(k), k += kPart - 1;
    ends.push_back(size);
    return ends;
}

/// Work on parts of a list, in parallel; the results in the order of the list.
template <typename Result, typename Work>
std::vector<Result> byParts(const std::vector<std::size_t>& ends, const Work& work) {
    std::vector<Result> found(ends.size());
    parallelFor(found.size(), 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t p = begin; p < end; ++p) found[p] = work(p ? ends[p - 1] : 0, ends[p]);
    });
    return found;
}

/// @param nodes  ascending: a block of links is made once, and dropped as soon as it was used
Meetings meetingsAmong(const CoreJets& jets, const Links& links, std::span<const NodeIndex> nodes) {
    const auto endsBlock = [&](std::size_t k) {
        return k == nodes.size() || nodes[k - 1] / JetLinks::kBlock != nodes[k] / JetLinks::kBlock;
    };
    const auto look = [&](std::size_t begin, std::size_t end) {
        Meetings found;
        for (std::size_t k = begin; k < end; ++k) {
            visit(jets, links, nodes[k], found);
            if (endsBlock(k + 1)) links.drop(nodes[k]);
        }
        return found;
    };
    Meetings all;
    for (const Meetings& part : byParts<Meetings>(partsOf(nodes.size(), endsBlock), look))
        all.append(part);
    return all;
}

/// Those among the nodes and beside them.
Meetings meetingsAround(const CoreJets& jets, const Links& links, std::vector<NodeIndex> nodes) {
    std::sort(nodes.begin(), nodes.end());
    Meetings found = meetingsAmong(jets, links, nodes);
    std::vector<NodeIndex> beside = std::move(found.beside);
    std::sort(beside.begin(), beside.end());
    beside.erase(std::unique(beside.begin(), beside.end()), beside.end());
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
    using Solutions = std::vector<std::optional<Solved>>;
    const JetCore& core = *jets.core;
    if (core.costsVary || core.metric.anisotropic() || nodes.empty()) return;
    const Links links(core, own);
    const Meetings meetings = meetingsAround(jets, links, nodes);
    if (meetings.points.empty()) return;
    const auto parts = byParts<Solutions>(
        partsOf(meetings.points.size(), [](std::size_t) { return true; }),
        [&](std::size_t begin, std::size_t end) {
            return solveByRays(jets, {}, std::span(meetings.points).subspan(begin, end - begin));
        });
    jets.meetings.resize(core.nodes.size());
    for (const NodeIndex i : meetings.around) jets.meetings[i] = true;
    auto node = meetings.nodes.begin();
    for (const Solutions& part : parts)
        for (const std::optional<Solved>& jet : part) {
            const NodeIndex i = *node++;
            jets.meetings[i] = true;
            if (jet) setJet(jets, i, *jet);
        }
}

}  // namespace igeo
