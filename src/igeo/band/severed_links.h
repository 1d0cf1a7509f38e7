/// Severed links: pairs of neighbors that the surface does not join, though normals and chords
/// suggest it.
#pragma once

#include <igeo/base/types.h>

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace igeo {

/// Two neighbors: voxels at most one step apart in every axis.
using Link = std::pair<NodeIndex, NodeIndex>;

/// A link between nodes of the core that are not neighbors, or that the surface joins by a detour.
struct Bridge {
    NodeIndex from = 0, to = 0;
    /// Length of the path along the surface, divided by that of the chord laid flat
    float stretch = 1;
    /// The front starts again at the other end: across a gap, or where S turns back
    bool jump = false;

    friend bool operator==(const Bridge&, const Bridge&) = default;
};

/// A link of the core whose length along S is not what the tangent planes at its ends say, as seen
/// from one end: on a mesh the triangles between may bend several times.
struct StretchedLink {
    NodeIndex from = 0;
    std::uint16_t bit = 0;    ///< number of the bit of its step (SeveredLinks)
    std::uint16_t parts = 0;  ///< the stretch, in parts of 1 / kOne

    static constexpr double kOne = 32768, kLeast = 0.8, kMost = 1.9;
    /// @param stretch  length along S, divided by that of the chord laid flat; kLeast to kMost
    StretchedLink(NodeIndex node, int dx, int dy, int dz, double stretch)
        : from(node),
          bit(std::uint16_t(9 * dx + 3 * dy + dz + 13)),
          parts(std::uint16_t(stretch * kOne + 0.5)) {}
    float stretch() const { return float(parts) / float(kOne); }

    friend bool operator==(const StretchedLink&, const StretchedLink&) = default;
};

/// Pairs of neighbors between which no front passes, because the surface joins their foot points by
/// a detour or not at all. Only the few nodes with such pairs are stored, sorted: 8 bytes each.
class SeveredLinks {
public:
    /// Bit of the step (dx, dy, dz) to a neighbor.
    static constexpr std::uint32_t bit(int dx, int dy, int dz) {
        return std::uint32_t(1) << (9 * dx + 3 * dy + dz + 13);
    }
    /// Bits of the steps from node i along severed links. O(log n).
    std::uint32_t stepsFrom(NodeIndex i) const;
    /// Adds steps of nodes, in any order; a node may occur several times. Time O(n log n).
    void add(const std::vector<std::pair<NodeIndex, std::uint32_t>>& steps);

    std::size_t memUsage() const { return ofNode_.capacity() * sizeof(ofNode_[0]); }
    friend bool operator==(const SeveredLinks& a, const SeveredLinks& b) {
        return a.ofNode_ == b.ofNode_;
    }

private:
    std::vector<std::pair<NodeIndex, std::uint32_t>> ofNode_;
};

}  // namespace igeo
