/// The nodes of a band, from psi around each leaf. Internal.
#pragma once

#include <igeo/band/band.h>
#include <igeo/surface/detail/edge_fans.h>
#include <igeo/surface/detail/leaf_block.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace igeo {

/// Nodes that are looked at again, per leaf.
struct Marks {
    explicit Marks(std::size_t leaves)
        : kinks(leaves), meetings(leaves), rims(leaves), fans(leaves) {}
    std::vector<std::vector<NodeIndex>> kinks;     ///< where psi has a kink
    std::vector<std::vector<NodeIndex>> meetings;  ///< where sheets may meet
    std::vector<std::vector<NodeIndex>> rims;      ///< around sharp bends
    std::vector<std::vector<FanNode>> fans;        ///< may join the faces of a sharp edge
};

/// Sets psi and normal of the nodes of some leaves of a band.
/// @param first, count  of the leaves
void fillLeaves(const openvdb::FloatTree& psi, LeafIndex first, std::size_t count, Band& band,
                Marks& marks);

/// The voxels of a leaf with |value| < limit: a bit each.
void markWithin(const float* values, double limit, std::array<std::uint64_t, 8>& slices);

}  // namespace igeo
