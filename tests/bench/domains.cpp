#include "domains.h"

#include <algorithm>
#include <numeric>
#include <set>
#include <tuple>

namespace igeo::test {
namespace {

using Leaves = std::vector<LeafIndex>;

/// Puts leaves into the order of halving.
void halve(const Band& band, Leaves::iterator begin, Leaves::iterator end) {
    if (end - begin < 2) return;
    const Ijk first = band.leaves[*begin].origin;
    Ijk low = first, high = first;
    std::uint64_t nodes = 0;
    for (auto at = begin; at != end; ++at) {
        const BandLeaf& leaf = band.leaves[*at];
        nodes += leaf.core.count;
        for (int a = 0; a < 3; ++a) {
            low[a] = std::min(low[a], leaf.origin[a]);
            high[a] = std::max(high[a], leaf.origin[a]);
        }
    }
    const Ijk side = high - low;
    const int axis = side.x >= side.y && side.x >= side.z ? 0 : side.y >= side.z ? 1 : 2;
    std::sort(begin, end, [&](LeafIndex a, LeafIndex b) {
        const int x = band.leaves[a].origin[axis], y = band.leaves[b].origin[axis];
        return x != y ? x < y : a < b;
    });
    auto middle = begin;
    for (std::uint64_t before = 0; middle != end && 2 * before < nodes; ++middle)
        before += band.leaves[*middle].core.count;
    middle = std::clamp(middle, begin + 1, end - 1);
    halve(band, begin, middle);
    halve(band, middle, end);
}

/// The domains that hold copies of the nodes of a leaf if whole leaves are copied.
std::set<std::uint32_t> ownersAround(const Band& band, const Domains& domains, LeafIndex l) {
    std::set<std::uint32_t> owners;
    for (const LeafIndex m : band.leaves[l].neighbor)
        if (m != kNoLeaf) owners.insert(domains.owner[m]);
    owners.erase(domains.owner[l]);
    return owners;
}

/// The domains that own a core node within a voxel of this one.
std::set<std::uint32_t> ownersBeside(const Band& band, const Domains& domains, LeafIndex l,
                                     unsigned offset) {
    std::set<std::uint32_t> owners;
    const Ijk here{int(offset >> 6), int(offset >> 3 & 7), int(offset & 7)};
    band.forNeighbors(&BandLeaf::core, l, offset, [&](NodeIndex, int dx, int dy, int dz) {
        const LeafIndex m =
            band.leafBeside(l, (here.x + dx) >> 3, (here.y + dy) >> 3, (here.z + dz) >> 3);
        owners.insert(domains.owner[m]);
    });
    owners.erase(domains.owner[l]);
    return owners;
}

/// Records by superstep, sender and receiver.
class Ledger {
public:
    explicit Ledger(std::size_t domains) : copies_(domains) {}
    void add(std::uint32_t step, std::uint32_t from, const std::set<std::uint32_t>& to) {
        for (const std::uint32_t t : to) {
            records_.push_back({step, from, t});
            ++copies_[t];
        }
    }
    Traffic sum() {
        std::sort(records_.begin(), records_.end());
        Traffic traffic;
        traffic.records = records_.size();
        traffic.mostCopies = *std::max_element(copies_.begin(), copies_.end());
        for (auto at = records_.begin(); at != records_.end();) at = superstep(at, traffic);
        return traffic;
    }

private:
    struct Record {
        std::uint32_t step, from, to;
        bool operator<(const Record& b) const {
            return std::tie(step, from, to) < std::tie(b.step, b.from, b.to);
        }
        bool operator==(const Record& b) const { return !(*this < b) && !(b < *this); }
    };
    using Iterator = std::vector<Record>::iterator;

    /// Adds the records of one superstep.
    /// @return where those of the next begin
    Iterator superstep(Iterator begin, Traffic& traffic) {
        struct Load {
            std::uint64_t records = 0, messages = 0;
        };
        std::vector<Load> sent(copies_.size()), received(copies_.size());
        auto at = begin;
        while (at != records_.end() && at->step == begin->step) {
            const auto next =
                std::find_if(at, records_.end(), [&](const Record& r) { return !(r == *at); });
            for (Load* load : {&sent[at->from], &received[at->to]}) {
                load->records += std::uint64_t(next - at);
                ++load->messages;
            }
            ++traffic.messages;
            at = next;
        }
        Load most;
        for (const auto* loads : {&sent, &received})
            for (const Load& load : *loads) {
                most.records = std::max(most.records, load.records);
                most.messages = std::max(most.messages, load.messages);
            }
        traffic.mostRecords += most.records;
        traffic.mostMessages += most.messages;
        return at;
    }

    std::vector<Record> records_;
    std::vector<std::uint64_t> copies_;
};

/// Calls visit(leaf, offset, core node) for all nodes of the core.
template <typename Visit>
void forCore(const Band& band, const Visit& visit) {
    for (LeafIndex l = 0; l < band.leaves.size(); ++l)
        for (unsigned offset = 0; offset < 512; ++offset)
            if (const NodeIndex k = band.leaves[l].core.node(offset); k != kNoNode)
                visit(l, offset, k);
}

}  // namespace

Domains domainsOf(const Band& band, std::size_t count, std::size_t pieces) {
    Leaves order(band.leaves.size());
    std::iota(order.begin(), order.end(), LeafIndex(0));
    halve(band, order.begin(), order.end());
    Domains domains{count, std::vector<std::uint32_t>(order.size())};
    const std::uint64_t runs = count * pieces;
    std::uint64_t before = 0;
    for (const LeafIndex l : order) {
        // By the middle of the leaf.
        const std::uint64_t nodes = band.leaves[l].core.count,
                            run = (2 * before + nodes) * runs / (2 * band.coreSize() + 1);
        domains.owner[l] = std::uint32_t(run % count);
        before += nodes;
    }
    return domains;
}

Schedule scheduleOf(const Field& field, double bucketWidth) {
    const Band& band = *field.band;
    Schedule schedule;
    schedule.step.assign(band.coreSize(), Schedule::kNever);
    std::vector<std::uint32_t> stepOf;  // per bucket
    forCore(band, [&](LeafIndex l, unsigned offset, NodeIndex k) {
        const double u = field.distance[band.leaves[l].band.node(offset)];
        if (!(u < kInfinity)) return;
        const auto bucket = std::size_t(u / bucketWidth);
        schedule.step[k] = std::uint32_t(bucket);
        if (bucket >= stepOf.size()) stepOf.resize(bucket + 1, 0);
        stepOf[bucket] = 1;
    });
    for (std::uint32_t& step : stepOf) step = step ? std::uint32_t(schedule.steps++) : 0;
    for (std::uint32_t& step : schedule.step)
        if (step != Schedule::kNever) step = stepOf[step];
    return schedule;
}

Replay replay(const Band& band, const Schedule& schedule, const Domains& domains) {
    Replay result;
    std::vector<std::uint64_t> share(domains.count);
    std::vector<std::uint32_t> work(schedule.steps * domains.count);
    Ledger links(domains.count), leaves(domains.count);
    std::set<std::uint32_t> around;
    LeafIndex last = kNoLeaf;
    forCore(band, [&](LeafIndex l, unsigned offset, NodeIndex k) {
        const std::uint32_t step = schedule.step[k], owner = domains.owner[l];
        if (step == Schedule::kNever) return;
        ++result.nodes, ++share[owner], ++work[step * domains.count + owner];
        if (l != last) around = ownersAround(band, domains, last = l);
        if (around.empty()) return;
        leaves.add(step, owner, around);
        links.add(step, owner, ownersBeside(band, domains, l, offset));
    });
    result.largestShare = *std::max_element(share.begin(), share.end());
    for (auto at = work.begin(); at != work.end(); at += std::ptrdiff_t(domains.count)) {
        const auto end = at + std::ptrdiff_t(domains.count);
        result.mostWork += *std::max_element(at, end);
        result.busy += std::uint64_t(std::count_if(at, end, [](std::uint32_t w) { return w > 0; }));
    }
    result.links = links.sum();
    result.leaves = leaves.sum();
    return result;
}

}  // namespace igeo::test
