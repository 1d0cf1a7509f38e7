/// Core numbers around a leaf, gathered once for fast access to neighbors.
#pragma once

#include <igeo/band/band.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>

namespace igeo {

/// Core numbers of the voxels of a leaf and up to `Margin` voxels beyond.
template <int Margin>
class LeafNumbers {
public:
    static_assert(Margin >= 1 && Margin <= 8);
    static constexpr int kEdge = 8 + 2 * Margin;

    /// @param low, high  slices of the leaf: beyond their margins nothing is set
    void fill(const Band& band, LeafIndex l, int low = 0, int high = 7) {
        static_assert(kNoNode == ~NodeIndex(0));
        constexpr int kSlice = kEdge * kEdge;
        std::memset(&number_[std::size_t(low * kSlice)], 0xff,
                    std::size_t((high - low + 1 + 2 * Margin) * kSlice) * sizeof number_[0]);
        number_.back() = kNoNode;
        for (int dx = -1; dx <= 1; ++dx) {
            const Range slices{std::max(low - Margin - 8 * dx, 0),
                               std::min(high + Margin - 8 * dx, 7)};
            if (slices.first > slices.last) continue;
            for (int dy = -1; dy <= 1; ++dy)
                for (int dz = -1; dz <= 1; ++dz) {
                    const LeafIndex m = dx || dy || dz ? band.leafBeside(l, dx, dy, dz) : l;
                    if (m != kNoLeaf && band.leaves[m].core.count)
                        add(band.leaves[m].core, dx, dy, dz, slices);
                }
        }
    }
    /// Index of a voxel relative to the leaf, -Margin to 7 + Margin along each axis.
    static constexpr int indexOf(const Ijk& v) {
        return indexOfStep(v + Ijk{Margin, Margin, Margin});
    }
    /// The index difference of a step.
    static constexpr int indexOfStep(const Ijk& v) { return (v.x * kEdge + v.y) * kEdge + v.z; }
    /// The core's number there, or kNoNode.
    NodeIndex at(int index) const { return number_[std::size_t(index)]; }

    /// The number at an index, and those of the other corners of a cell at kCorners from it.
    const NodeIndex* cell(int index) const { return &number_[std::size_t(index)]; }
    /// Corner (a, b, c) at 4 a + 2 b + c.
    static constexpr std::array<int, 8> kCorners = {0,
                                                    1,
                                                    kEdge,
                                                    kEdge + 1,
                                                    kEdge* kEdge,
                                                    kEdge* kEdge + 1,
                                                    kEdge* kEdge + kEdge,
                                                    kEdge* kEdge + kEdge + 1};

    /// A step to one of the 26 voxels around, in bits: (x + 1) 16 + (y + 1) 4 + z + 1.
    using StepCode = std::uint32_t;
    /// Calls visit(k, step) for the nodes around the voxel at an offset of the leaf, 26 at most, in
    /// the order of the steps.
    /// @param severed  bits of SeveredLinks: steps to leave out
    template <typename Visit>
    void forNeighbors(unsigned offset, std::uint32_t severed, const Visit& visit) const {
        const int middle = indexOf(voxelOf(offset));
        constexpr unsigned kMiddle = 1u << 13;
        for (unsigned found = nodesAround(middle) & ~(kMiddle | severed); found;
             found &= found - 1) {
            const auto k = unsigned(std::countr_zero(found));
            visit(at(middle + kSteps.index[k]), kSteps.code[k]);
        }
    }

    /// Whether nodesOfBox reaches all of a box.
    bool holdsBox(unsigned offset, const Ijk& middle, int reach) const {
        const Ijk v = voxelOf(offset) + middle;
        return std::min({v.x, v.y, v.z}) - reach >= -Margin &&
               std::max({v.x, v.y, v.z}) + reach <= 7 + Margin;
    }
    /// A step of up to two voxels along each axis, in bits: (x + 2) 64 + (y + 2) 8 + z + 2.
    static constexpr StepCode boxStep(const Ijk& step) {
        return StepCode((step.x + 2) << 6 | (step.y + 2) << 3 | (step.z + 2));
    }
    /// The nodes that Band::forBox visits in the core, in the same order, and their steps from
    /// `middle`.
    /// @param node, step  as many as voxels
    /// @return how many there are
    std::size_t nodesOfBox(unsigned offset, const Ijk& middle, int reach, NodeIndex* node,
                           StepCode* step) const {
        const int first = indexOf(voxelOf(offset) + middle);
        std::size_t count = 0;
        if (reach == 1) {
            for (unsigned found = nodesAround(first); found; found &= found - 1) {
                const auto k = unsigned(std::countr_zero(found));
                node[count] = at(first + kSteps.index[k]), step[count++] = kSteps.boxStep[k];
            }
            return count;
        }
        for (int x = -reach; x <= reach; ++x)
            for (int y = -reach; y <= reach; ++y)
                for (int z = -reach; z <= reach; ++z) {
                    node[count] = at(first + indexOfStep({x, y, z}));
                    step[count] = boxStep({x, y, z});
                    count += node[count] != kNoNode;
                }
        return count;
    }

private:
    static constexpr Ijk voxelOf(unsigned offset) {
        return {int(offset >> 6), int(offset >> 3 & 7), int(offset & 7)};
    }
    /// Bits: the voxels at and around an index that have a number, in the order of the steps.
    unsigned nodesAround(int middle) const {
        // Which there are changes from node to node: without branches, by rows of three.
        typedef int Row __attribute__((vector_size(16)));
        Row there{};
        for (unsigned k = 0; k < 27; k += 3) {
            Row row;
            std::memcpy(&row, &number_[std::size_t(middle + kSteps.index[k])], sizeof row);
            there |= (row != int(kNoNode)) & (Row{1, 2, 4, 0} << int(k));
        }
        return unsigned(there[0] | there[1] | there[2]);
    }
    /// The steps to a voxel and to all around it.
    struct Steps {
        std::array<int, 27> index{};
        std::array<StepCode, 27> code{}, boxStep{};
        constexpr Steps() {
            for (int k = 0; k < 27; ++k) {
                const int x = k / 9, y = k / 3 % 3, z = k % 3;
                index[std::size_t(k)] = indexOfStep({x - 1, y - 1, z - 1});
                code[std::size_t(k)] = StepCode(x << 4 | y << 2 | z);
                boxStep[std::size_t(k)] = LeafNumbers::boxStep({x - 1, y - 1, z - 1});
            }
        }
    };
    static constexpr Steps kSteps{};

    /// Bits: the voxels of a slice within reach in the leaf at a shift, by 3 (y + 1) + z + 1.
    struct Slices {
        std::array<std::uint64_t, 9> seen{};
        constexpr Slices() {
            for (int k = 0; k < 9; ++k)
                for (int y = 0; y < 8; ++y)
                    if (reach(k / 3 - 1) >> y & 1)
                        seen[std::size_t(k)] |= std::uint64_t(reach(k % 3 - 1)) << 8 * y;
        }
        /// Bits 0 to 7: positions along an axis within reach.
        static constexpr unsigned reach(int shift) {
            return shift < 0   ? (0xff00u >> Margin) & 0xff
                   : shift > 0 ? 0xffu >> (8 - Margin)
                               : 0xff;
        }
    };
    static constexpr Slices kSlices{};

    struct Range {
        int first, last;
    };
    void add(const LeafNodes& nodes, int dx, int dy, int dz, const Range& slices) {
        const std::uint64_t seen = kSlices.seen[std::size_t(3 * dy + dz + 4)];
        for (int x = slices.first; x <= slices.last; ++x) {
            const std::uint64_t mask = nodes.mask[std::size_t(x)];
            std::uint64_t bits = mask & seen;
            if (!bits) continue;
            const NodeIndex first = nodes.firstNode + nodes.before[std::size_t(x)];
            const auto countBefore = [&] {
                return first + LeafNodes::bitCount(mask & ((bits & -bits) - 1));
            };
            const int slice = indexOf({8 * dx + x, 8 * dy, 8 * dz});
            const auto set = [&](NodeIndex number) {
                number_[std::size_t(slice + kPlaces.of[std::size_t(std::countr_zero(bits))])] =
                    number;
                bits &= bits - 1;
            };
            // Whole rows have consecutive numbers.
            if (dz == 0) {
                NodeIndex number = countBefore();
                while (bits) set(number++);
            } else {
                while (bits) set(countBefore());
            }
        }
    }
    /// Of a bit of a slice: its index from that of bit 0.
    struct Places {
        std::array<std::int16_t, 64> of{};
        constexpr Places() {
            for (int bit = 0; bit < 64; ++bit)
                of[std::size_t(bit)] = std::int16_t((bit >> 3) * kEdge + (bit & 7));
        }
    };
    static constexpr Places kPlaces{};

    std::array<NodeIndex, std::size_t(kEdge* kEdge* kEdge) + 1> number_;  ///< and one more to read
};

}  // namespace igeo
