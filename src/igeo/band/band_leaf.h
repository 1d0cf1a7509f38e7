/// The leaves of a band: which voxels of 8^3 are nodes, and their numbers.
#pragma once

#include <igeo/base/types.h>

#include <array>
#include <cstdint>
#include <limits>

namespace igeo {

using LeafIndex = std::uint32_t;
constexpr LeafIndex kNoLeaf = std::numeric_limits<LeafIndex>::max();

/// Numbers for some voxels of a leaf. The layout is that of OpenVDB's leaves: voxel (x, y, z) has
/// offset 64 x + 8 y + z, so mask word x holds the slice at x, and byte y of it the row at (x, y).
struct LeafNodes {
    std::array<std::uint64_t, 8> mask{};    ///< which voxels have a number
    std::array<std::uint16_t, 8> before{};  ///< numbered voxels before slice x
    NodeIndex firstNode = 0;                ///< number of its first voxel
    NodeIndex count = 0;

    void insert(unsigned offset) { mask[offset >> 6] |= std::uint64_t(1) << (offset & 63); }
    /// Numbers the voxels of the mask from `start` on, in the order of their offsets.
    void number(NodeIndex start);

    /// The number of the voxel at an offset, or kNoNode.
    NodeIndex node(unsigned offset) const {
        return mask[offset >> 6] >> (offset & 63) & 1 ? numberOf(offset) : kNoNode;
    }
    /// The same, without the test, for a voxel in the mask.
    NodeIndex numberOf(unsigned offset) const {
        const std::uint64_t lower = (std::uint64_t(1) << (offset & 63)) - 1;
        return firstNode + before[offset >> 6] + bitCount(mask[offset >> 6] & lower);
    }
    /// The numbers of the voxel at an offset and of those beside it along z, y and both, all in the
    /// leaf; kNoNode where there is none.
    void square(unsigned offset, NodeIndex* of) const {
        static_assert(kNoNode == ~NodeIndex(0));
        const unsigned x = offset >> 6, at = offset & 63;
        const std::uint64_t bits = mask[x], below = (std::uint64_t(1) << at) - 1;
        const auto there = [&](unsigned bit) { return NodeIndex(bits >> at >> bit & 1); };
        const NodeIndex slice = firstNode + before[x], first = slice + bitCount(bits & below),
                        second = slice + bitCount(bits & (below << 8 | 0xff));
        of[0] = first | (there(0) - 1), of[1] = (first + there(0)) | (there(1) - 1);
        of[2] = second | (there(8) - 1), of[3] = (second + there(8)) | (there(9) - 1);
    }
    /// Counts bits by hand: baseline x86-64 has no instruction for it.
    static unsigned bitCount(std::uint64_t bits) {
        bits -= bits >> 1 & 0x5555555555555555;
        bits = (bits & 0x3333333333333333) + (bits >> 2 & 0x3333333333333333);
        bits = (bits + (bits >> 4)) & 0x0f0f0f0f0f0f0f0f;
        return unsigned(bits * 0x0101010101010101ull >> 56);
    }
};

/// A block of 8^3 voxels of the band.
struct BandLeaf {
    Ijk origin;      ///< smallest voxel, a multiple of 8
    LeafNodes band;  ///< the leaf's nodes
    LeafNodes core;  ///< those of the core (Band::numberCore), with numbers of their own
    std::array<LeafIndex, 27> neighbor{};  ///< leaf at step (dx,dy,dz): 9(dx+1)+3(dy+1)+dz+1
};

}  // namespace igeo
