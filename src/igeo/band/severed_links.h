/// Links that the surface does not have, though normals and chords look as if it did.
#pragma once

#include <igeo/base/types.h>

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace igeo {

/// Two neighbors: voxels at most one step apart in every axis.
using Link = std::pair<NodeIndex, NodeIndex>;

/// A link between nodes of the core that are no neighbors, or are so along another path only.
struct Bridge {
    NodeIndex from = 0, to = 0;
    float stretch = 1;  ///< length of the path along the surface over that of the chord, laid flat
    bool jump =
        false;  ///< a front starts again at the other end: over a gap, or where S turns back

    friend bool operator==(const Bridge&, const Bridge&) = default;
};

/// Pairs of neighbors that no front passes between, as the surface joins their foot points by a
/// detour only, or not at all. Few nodes have any, and those are sorted: 8 bytes per such node.
class SeveredLinks {
public:
    /// Bit of the step (dx, dy, dz) to a neighbor.
    static constexpr std::uint32_t bit(int dx, int dy, int dz) {
        return std::uint32_t(1) << (9 * dx + 3 * dy + dz + 13);
    }
    /// Bits of the steps from node i along severed links. O(log n).
    std::uint32_t stepsFrom(NodeIndex i) const;
    /// Adds to the steps of nodes, which may come in any order and more than once.
    /// Time O(n log n).
    void add(const std::vector<std::pair<NodeIndex, std::uint32_t>>& steps);

    /// Visits the nodes with severed links, in their order.
    template <typename Visit>
    void forNodes(const Visit& visit) const {
        for (const auto& [node, steps] : ofNode_) visit(node);
    }

    std::size_t memUsage() const { return ofNode_.capacity() * sizeof(ofNode_[0]); }
    friend bool operator==(const SeveredLinks& a, const SeveredLinks& b) {
        return a.ofNode_ == b.ofNode_;
    }

private:
    std::vector<std::pair<NodeIndex, std::uint32_t>> ofNode_;
};

}  // namespace igeo
