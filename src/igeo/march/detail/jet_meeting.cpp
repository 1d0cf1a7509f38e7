#include <igeo/march/detail/jet_meeting.h>

#include <igeo/base/parallel.h>
#include <igeo/march/detail/jet_rays.h>
#include <igeo/march/detail/jet_two_fronts.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cstring>
#include <optional>
#include <utility>

namespace igeo {

namespace {

/// A mark per node. Several threads may set it, each to the same.
using Marks = std::vector<std::uint8_t>;
void setMark(std::uint8_t& mark, std::uint8_t to) {
    std::atomic_ref(mark).store(to, std::memory_order_relaxed);
}
/// The nodes with a mark, ascending. Few have any.
std::vector<NodeIndex> nodesWith(std::uint8_t mark, const Marks& marks) {
    std::vector<NodeIndex> nodes;
    for (std::size_t first = 0; first < marks.size(); first += 8) {
        const std::size_t end = std::min(first + 8, marks.size());
        std::uint64_t any = 0;
        std::memcpy(&any, &marks[first], end - first);
        for (std::size_t k = first; any && k < end; ++k)
            if (marks[k] == mark) nodes.push_back(NodeIndex(k));
    }
    return nodes;
}

using Meeting = Meetings::Meeting;

bool inOneBlock(NodeIndex a, NodeIndex b) { return a / JetLinks::kBlock == b / JetLinks::kBlock; }

/// The links of the core after a march.
class Links {
public:
    /// @param own  of the march, where the core has none: made again where they are needed, and
    ///             only as long
    Links(const JetCore& core, JetLinks& own) : core_(core), own_(own) {}

    /// Makes the rows of the first of some ascending nodes and of those in its block.
    void make(std::span<const NodeIndex> nodes) const {
        if (!core_.links.empty()) return;
        std::uint64_t rows = 0;
        for (const NodeIndex i : nodes) {
            if (!inOneBlock(i, nodes[0])) break;
            rows |= std::uint64_t(1) << i % JetLinks::kBlock;
        }
        own_.makeRows(core_, nodes[0], rows);
    }
    JetLinks::Row rowAt(NodeIndex i) const {
        return core_.links.empty() ? own_.rowAt(i) : core_.links.rowAt(i);
    }
    /// Drops the block of a node, which no other thread looks at.
    void drop(NodeIndex i) const {
        if (core_.links.empty()) own_.drop(i);
    }

private:
    const JetCore& core_;
    JetLinks& own_;
};

/// Ends of parts of a list of ascending nodes: each block of links belongs to one.
std::vector<std::size_t> partsOf(std::span<const NodeIndex> nodes) {
    constexpr std::size_t kPart = 256;
    std::vector<std::size_t> ends;
    for (std::size_t k = kPart; k < nodes.size(); ++k)
        if (!inOneBlock(nodes[k - 1], nodes[k])) ends.push_back(k), k += kPart - 1;
    ends.push_back(nodes.size());
    return ends;
}

class MeetingSearch {
public:
    /// @param near  gets a mark where fronts meet, and at nodes that are linked to these
    MeetingSearch(const CoreJets& jets, JetLinks& own, Marks& near)
        : jets_(jets), core_(*jets.core), links_(core_, own), near_(near), seen_(near.size()) {}

    /// Those among the nodes, and those beside them; ascending.
    std::vector<Meeting> find(const std::vector<NodeIndex>& nodes) {
        for (const NodeIndex i : nodes) seen_[i] = kFirst;
        const std::vector<Meeting> first = meetingsAmong(nodesWith(kFirst, seen_), kFirst),
                                   beside = meetingsAmong(nodesWith(kBeside, seen_), kBeside);
        std::vector<Meeting> all(first.size() + beside.size());
        std::merge(first.begin(), first.end(), beside.begin(), beside.end(), all.begin(),
                   [](const Meeting& a, const Meeting& b) { return a.node < b.node; });
        return all;
    }

private:
    static constexpr std::uint8_t kFirst = 1, kBeside = 2;
    /// The search in a part of the nodes.
    struct Part {
        std::uint8_t mark;  ///< of its nodes
        std::vector<Meeting> found;
        LinkedNodes group;  ///< in work
        LinkedFronts fronts;
        ArrivingFronts first;
    };

    /// @param mark  of the nodes
    std::vector<Meeting> meetingsAmong(const std::vector<NodeIndex>& nodes, std::uint8_t mark);
    /// Rows of links are made once, and dropped as soon as they were used.
    std::vector<Meeting> meetingsIn(std::span<const NodeIndex> nodes, std::uint8_t mark);
    void lookAt(Part& part);
    void add(NodeIndex i, std::size_t lane, Part& part);

    const CoreJets& jets_;
    const JetCore& core_;
    const Links links_;
    Marks& near_;
    Marks seen_;  ///< kBeside: at a link over which fronts meet
};

std::vector<Meeting> MeetingSearch::meetingsAmong(const std::vector<NodeIndex>& nodes,
                                                  std::uint8_t mark) {
    const std::vector<std::size_t> ends = partsOf(nodes);
    std::vector<std::vector<Meeting>> parts(ends.size());
    parallelFor(parts.size(), 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t p = begin; p < end; ++p) {
            const std::size_t first = p ? ends[p - 1] : 0;
            parts[p] = meetingsIn(std::span(nodes).subspan(first, ends[p] - first), mark);
        }
    });
    std::vector<Meeting> all;
    for (const std::vector<Meeting>& part : parts) all.insert(all.end(), part.begin(), part.end());
    return all;
}

std::vector<Meeting> MeetingSearch::meetingsIn(std::span<const NodeIndex> nodes,
                                               std::uint8_t mark) {
    Part part;
    part.mark = mark;
    for (std::size_t k = 0, kept = 0; k < nodes.size(); ++k) {
        const NodeIndex i = nodes[k];
        const bool isLast = k + 1 == nodes.size();
        if (k == 0 || !inOneBlock(nodes[k - 1], i)) links_.make(nodes.subspan(k));
        const auto [row, creased] = links_.rowAt(i);
        // Where S has a crease fronts do not count, but those beside may.
        if (jets_.accepted(i) && core_.nodes[i].obstacleState == Metric::Clear &&
            !(creased && mark == kBeside))
            part.group.add(i, row);
        if (!part.group.full() && !isLast) continue;
        lookAt(part);
        for (; kept <= k; ++kept)
            if (isLast || !inOneBlock(nodes[kept], nodes[k + 1])) links_.drop(nodes[kept]);
    }
    return std::move(part.found);
}

void MeetingSearch::lookAt(Part& part) {
    if (part.group.size == 0) return;
    findFronts(jets_, part.group, part.fronts);
    for (std::size_t k = 0; k < part.fronts.arrivals.count && part.mark == kFirst; ++k)
        for (unsigned toward = part.fronts.toward[k]; toward; toward &= toward - 1) {
            const JetLink* const row = part.group.link[std::size_t(std::countr_zero(toward))];
            std::uint8_t& seen = seen_[row[k].node()];
            if (!std::atomic_ref(seen).load(std::memory_order_relaxed)) setMark(seen, kBeside);
        }
    if (part.fronts.meet) findFronts(part.fronts.arrivals, part.first);
    for (unsigned meet = part.fronts.meet; meet; meet &= meet - 1) {
        const auto lane = std::size_t(std::countr_zero(meet));
        add(part.group.node[lane], lane, part);
    }
    part.group.clear();
}

void MeetingSearch::add(NodeIndex i, std::size_t lane, Part& part) {
    const auto [row, creased] = links_.rowAt(i);
    const std::uint32_t label = jets_.labelOf(i);
    if (creased || std::any_of(row.begin(), row.end(), [&](const JetLink& link) {
            return jets_.labelOf(link.node()) != label;
        }))
        return;
    setMark(near_[i], 1);
    for (const JetLink& link : row) setMark(near_[link.node()], 1);
    Meeting& to = part.found.emplace_back();
    to.node = i;
    const double start =
        jets_.buckets.beyondLeast(jets_.state[i].bucket) / double(core_.nodes[i].weight);
    if (start + double(part.fronts.least[lane]) >= double(MeetingPoint::kNearSeed))
        to.fronts = part.first.at(lane);
}

MeetingPoint pointOf(const CoreJets& jets, const Meeting& m) {
    const JetNode& node = jets.core->nodes[m.node];
    const JetState& state = jets.state[m.node];
    const double weight = node.weight, start = jets.buckets.beyondLeast(state.bucket) / weight;
    return {node.leaf,
            node.offset,
            node.foot,
            jets.core->localFrame(m.node),
            jets.labelOf(m.node),
            start + double(state.rest) / weight,
            m.fronts};
}

}  // namespace

Meetings::Meetings(const CoreJets& jets, std::vector<Meeting> list, std::vector<std::uint8_t> near,
                   std::vector<TwoFronts> both)
    : list_(std::move(list)), marks_(std::move(near)), both_(std::move(both)) {
    state_.reserve(list_.size()), solved_.reserve(list_.size());
    for (const Meeting& m : list_) {
        marks_[m.node] |= kAt;
        state_.push_back(jets.state[m.node]), solved_.push_back(m.fronts.count == 0);
    }
}

const TwoFronts& Meetings::bothOf(NodeIndex k) const {
    return *std::lower_bound(both_.begin(), both_.end(), k,
                             [](const TwoFronts& b, NodeIndex i) { return b.node < i; });
}

std::size_t Meetings::indexOf(NodeIndex k) const {
    const auto at = std::lower_bound(list_.begin(), list_.end(), k,
                                     [](const Meeting& m, NodeIndex i) { return m.node < i; });
    return std::size_t(at - list_.begin());
}

void Meetings::solve(const CoreJets& jets, std::vector<std::size_t> which) const {
    if (which.empty()) return;
    std::sort(which.begin(), which.end());
    which.erase(std::unique(which.begin(), which.end()), which.end());
    std::vector<MeetingPoint> points;
    points.reserve(which.size());
    for (const std::size_t m : which) points.push_back(pointOf(jets, list_[m]));
    const std::vector<std::optional<Solved>> found = solveByRays(jets, points);
    const std::lock_guard<std::mutex> lock(publishing_);
    for (std::size_t k = 0; k < which.size(); ++k) {
        const std::size_t m = which[k];
        if (isSolved(m)) continue;  // by another thread, to the same bits
        if (const std::optional<Solved>& jet = found[k]) {
            const double weight = jets.core->nodes[list_[m].node].weight;
            JetState& state = state_[m];
            state.rest =
                float(jets.seeds.leastStart + weight * jet->u - jets.buckets.startOf(state.bucket));
            state.g = jet->g;
        }
        std::atomic_ref(solved_[m]).store(1, std::memory_order_release);
    }
}

void Meetings::find(const CoreJets& jets, std::span<const NodeIndex> nodes, JetState* to) const {
    std::vector<std::size_t> open;
    for (std::size_t k = 0; k < nodes.size(); ++k) {
        const std::size_t m = indexOf(nodes[k]);
        if (isSolved(m))
            to[k] = state_[m];
        else
            open.push_back(m);
    }
    if (open.empty()) return;
    solve(jets, std::move(open));
    for (std::size_t k = 0; k < nodes.size(); ++k) to[k] = state_[indexOf(nodes[k])];
}

void Meetings::findAhead(const CoreJets& jets, std::span<const NodeIndex> nodes) const {
    std::vector<std::size_t> open;
    for (const NodeIndex k : nodes)
        if (const std::size_t m = indexOf(k); !isSolved(m)) open.push_back(m);
    solve(jets, std::move(open));
}

void Meetings::solveAll(const CoreJets& jets) const {
    parallelFor(list_.size(), 256, [&](std::size_t begin, std::size_t end) {
        std::vector<std::size_t> open;
        for (std::size_t m = begin; m < end; ++m)
            if (!isSolved(m)) open.push_back(m);
        solve(jets, std::move(open));
    });
}

std::shared_ptr<const Meetings> findMeetings(CoreJets& jets, JetLinks& own,
                                             const std::vector<NodeIndex>& nodes) {
    const JetCore& core = *jets.core;
    if (core.costsVary || core.metric.anisotropic() || nodes.empty()) return nullptr;
    Marks near(core.nodes.size());
    std::vector<Meeting> found = MeetingSearch(jets, own, near).find(nodes);
    if (found.empty()) return nullptr;
    std::vector<TwoFronts> both = carryTwoFronts(jets, own, found, near);
    return std::make_shared<const Meetings>(jets, std::move(found), std::move(near),
                                            std::move(both));
}

}  // namespace igeo
