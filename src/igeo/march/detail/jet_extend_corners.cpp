#include <igeo/march/detail/jet_extend_corners.h>

#include <igeo/base/parallel.h>
#include <igeo/march/detail/jet_extend_lanes.h>

#include <algorithm>
#include <bit>

namespace igeo::jet {

namespace {

/// The corners of the cell around a foot point.
struct NodeCorners {
    std::uint8_t bits, count;  ///< those that count
    std::int16_t cell;         ///< FootLanes::cell
};

/// How many bits of a byte are set.
struct BitCounts {
    std::array<std::uint8_t, 256> of{};
    constexpr BitCounts() {
        for (unsigned k = 1; k < of.size(); ++k) of[k] = std::uint8_t(of[k / 2] + k % 2);
    }
};
constexpr BitCounts kBitCounts;

class LeafSearch {
public:
    LeafSearch(const Band& band, LeafIndex l, const LeafNumbers<2>& numbers)
        : band_(band), leaf_(l), first_(band.leaves[l].band.firstNode), numbers_(numbers) {}

    /// @param nodes  as LeafCorners has them, outside the core
    /// @param to     one per node
    void find(std::span<const std::uint32_t> nodes, NodeCorners* to) {
        const bool fromPsi = band_.foot.empty();
        JetCorners::PerLane<std::uint32_t> bits;
        for (std::size_t begin = 0; begin < nodes.size(); begin += Lanes::kNodes) {
            const std::size_t count = std::min(Lanes::kNodes, nodes.size() - begin);
            for (std::size_t k = 0; k < count; ++k) {
                const NodeIndex i = first_ + (nodes[begin + k] >> 16);
                feet_.offset[k] = nodes[begin + k] & 0xffff;
                if (fromPsi)
                    feet_.psi[k] = band_.psi[i];
                else
                    feet_.setFoot(k, band_.foot[i]);
                points_.setNormal(k, band_.normal[i]);
            }
            findCells(feet_, fromPsi, points_);
            for (std::size_t k = 0; k < count; ++k)
                withCell(nodes[begin + k], feet_.cell[k], [&](const auto& nodeAt) {
                    for (unsigned c = 0; c < JetCorners::kMax; ++c) points_.node[c][k] = nodeAt(c);
                });
            findCornersThatCount(points_, bits);
            for (std::size_t k = 0; k < count; ++k)
                to[begin + k] = {std::uint8_t(bits[k]), kBitCounts.of[bits[k]],
                                 std::int16_t(feet_.cell[k])};
        }
    }
    /// Calls use(nodeAt), where nodeAt(corner) is the core's number at a corner of the cell.
    template <typename Use>
    void withCell(std::uint32_t node, int cell, const Use& use) const {
        if (cell >= 0) {
            const NodeIndex* const low = numbers_.cell(cell);
            return use([low](unsigned c) { return low[LeafNumbers<2>::kCorners[c]]; });
        }
        const Vec3f foot = band_.footOf(first_ + (node >> 16));
        const Ijk low{floorToInt(foot.x), floorToInt(foot.y), floorToInt(foot.z)};
        use([&](unsigned c) {
            const Ijk step{int(c >> 2), int(c >> 1 & 1), int(c & 1)};
            return band_.neighbor(&BandLeaf::core, leaf_, node & 0xffff, low + step);
        });
    }

private:
    const Band& band_;
    const LeafIndex leaf_;
    const NodeIndex first_;
    const LeafNumbers<2>& numbers_;
    FootLanes feet_;
    CellPoints points_;
};

}  // namespace

void findCorners(const Band& band, LeafIndex l, const LeafNumbers<2>& numbers, LeafCorners& to) {
    std::vector<std::uint32_t>& nodes = to.nodes;
    std::vector<CornerSlot>& slots = to.slots;
    // Which nodes are in the core changes from one to the next: no branches.
    const LeafNodes& core = band.leaves[l].core;
    std::array<std::uint32_t, 512> outside;
    std::size_t outsideCount = 0;
    std::uint32_t rank = 0;
    nodes.resize(band.leaves[l].band.count + 1);  // one more is written
    std::size_t coreCount = 0;
    band.forNodes(l, [&](NodeIndex, unsigned at) {
        const std::size_t isCore = core.mask[at >> 6] >> (at & 63) & 1;
        nodes[coreCount] = outside[outsideCount] = rank++ << 16 | at;
        coreCount += isCore, outsideCount += 1 - isCore;
    });
    nodes.pop_back();
    to.coreCount = coreCount;

    std::array<NodeCorners, 512> corners;
    LeafSearch search(band, l, numbers);
    search.find({outside.data(), outsideCount}, corners.data());
    std::array<std::uint16_t, JetCorners::kMax + 2> begin{};  // of the nodes with so many corners
    for (std::size_t k = 0; k < outsideCount; ++k) ++begin[corners[k].count + 1u];
    for (std::size_t c = 1; c < begin.size(); ++c) begin[c] += begin[c - 1];
    std::array<std::uint16_t, 512> order;
    for (std::size_t k = 0; k < outsideCount; ++k)
        order[begin[corners[k].count]++] = std::uint16_t(k);

    to.most.clear(), slots.clear();
    CornerSlot none{};
    none.node.fill(kNoNode);
    for (std::size_t k = 0; k < outsideCount; k += Lanes::kNodes) {
        const std::size_t end = std::min(k + Lanes::kNodes, outsideCount), first = slots.size();
        to.most.push_back(corners[order[end - 1]].count);
        slots.resize(first + to.most.back(), none);
        for (std::size_t n = k; n < end; ++n) {
            const std::uint32_t node = nodes[coreCount + n] = outside[order[n]];
            const NodeCorners& of = corners[order[n]];
            search.withCell(node, of.cell, [&](const auto& nodeAt) {
                CornerSlot* slot = slots.data() + first;
                for (unsigned bits = of.bits; bits; bits &= bits - 1, ++slot) {
                    const auto c = unsigned(std::countr_zero(bits));
                    slot->node[n - k] = nodeAt(c), slot->corner[n - k] = std::uint8_t(c);
                }
            });
        }
    }
}

std::vector<LeafCorners> cornersOfLeaves(const Band& band) {
    std::vector<LeafCorners> all(band.leaves.size());
    parallelFor(all.size(), 16, [&](std::size_t begin, std::size_t end) {
        LeafNumbers<2> numbers;
        LeafCorners here;  // grows once; what is kept is a copy of the size that it takes
        for (std::size_t l = begin; l < end; ++l) {
            numbers.fill(band, LeafIndex(l));
            findCorners(band, LeafIndex(l), numbers, here);
            all[l] = here;
        }
    });
    return all;
}

}  // namespace igeo::jet
