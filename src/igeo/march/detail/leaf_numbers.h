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

    void fill(const Band& band, LeafIndex l) {
        number_.fill(kNoNode);
        for (int dx = -1; dx <= 1; ++dx)
            for (int dy = -1; dy <= 1; ++dy)
                for (int dz = -1; dz <= 1; ++dz) {
                    const LeafIndex m = dx || dy || dz ? band.leafBeside(l, dx, dy, dz) : l;
                    if (m != kNoLeaf) add(band.leaves[m].core, {8 * dx, 8 * dy, 8 * dz});
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

    /// Calls visit(j, step) for the nodes around the voxel at an offset of the leaf, in the order
    /// of the steps.
    template <typename Visit>
    void forNeighbors(unsigned offset, const Visit& visit) const {
        // Which there are changes from node to node: first a set without branches, by rows of
        // three.
        const int middle = indexOf(voxelOf(offset));
        typedef int Row __attribute__((vector_size(16)));
        Row there{};
        for (unsigned k = 0; k < 27; k += 3) {
            Row row;
            std::memcpy(&row, &number_[std::size_t(middle + kSteps.index[k])], sizeof row);
            there |= (row != int(kNoNode)) & (Row{1, 2, 4, 0} << int(k));
        }
        constexpr unsigned kMiddle = 1u << 13;
        for (unsigned found = unsigned(there[0] | there[1] | there[2]) & ~kMiddle; found;
             found &= found - 1) {
            const auto k = unsigned(std::countr_zero(found));
            visit(at(middle + kSteps.index[k]), kSteps.step[k]);
        }
    }

    /// Whether forBox reaches all of a box.
    bool holdsBox(unsigned offset, const Ijk& middle, int reach) const {
        const Ijk v = voxelOf(offset) + middle;
        return std::min({v.x, v.y, v.z}) - reach >= -Margin &&
               std::max({v.x, v.y, v.z}) + reach <= 7 + Margin;
    }
    /// As Band::forBox has it for the core: calls visit(k, step) for the nodes within `reach` of
    /// the voxel at an offset of the leaf plus `middle`, in the order of the steps.
    template <typename Visit>
    void forBox(unsigned offset, const Ijk& middle, int reach, const Visit& visit) const {
        const int first = indexOf(voxelOf(offset) + middle);
        for (int x = -reach; x <= reach; ++x)
            for (int y = -reach; y <= reach; ++y)
                for (int z = -reach; z <= reach; ++z) {
                    const Ijk step{x, y, z};
                    const NodeIndex k = at(first + indexOfStep(step));
                    if (k != kNoNode) visit(k, middle + step);
                }
    }

private:
    static constexpr Ijk voxelOf(unsigned offset) {
        return {int(offset >> 6), int(offset >> 3 & 7), int(offset & 7)};
    }
    static constexpr int kEdge = 8 + 2 * Margin;

    /// The steps to a voxel and to all around it.
    struct Steps {
        std::array<Ijk, 27> step{};
        std::array<int, 27> index{};
        constexpr Steps() {
            for (int k = 0; k < 27; ++k) {
                const Ijk s{k / 9 - 1, k / 3 % 3 - 1, k % 3 - 1};
                step[std::size_t(k)] = s;
                index[std::size_t(k)] = (s.x * kEdge + s.y) * kEdge + s.z;
            }
        }
    };
    static constexpr Steps kSteps{};

    /// Bits 0 to 7: positions along an axis within reach, in a leaf at a shift.
    static constexpr unsigned reach(int shift) {
        return shift < 0 ? (0xff00u >> Margin) & 0xff : shift > 0 ? 0xffu >> (8 - Margin) : 0xff;
    }
    void add(const LeafNodes& nodes, const Ijk& shift) {
        std::uint64_t seen = 0;
        for (int y = 0; y < 8; ++y)
            if (reach(shift.y) >> y & 1) seen |= std::uint64_t(reach(shift.z)) << 8 * y;
        for (int x = 0; x < 8; ++x) {
            if (!(reach(shift.x) >> x & 1)) continue;
            for (std::uint64_t bits = nodes.mask[std::size_t(x)] & seen; bits; bits &= bits - 1) {
                const int bit = std::countr_zero(bits);
                const Ijk voxel = shift + Ijk{x, bit >> 3, bit & 7};
                number_[std::size_t(indexOf(voxel))] = nodes.numberOf(unsigned(x << 6 | bit));
            }
        }
    }
    std::array<NodeIndex, std::size_t(kEdge* kEdge* kEdge) + 1> number_;  ///< and one more to read
};

}  // namespace igeo
