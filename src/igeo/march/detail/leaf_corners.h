/// The core nodes around the foot points of the nodes of a leaf. Internal.
#pragma once

#include <igeo/march/detail/jet_fit.h>

#include <array>
#include <mutex>
#include <vector>

namespace igeo {

/// The first corner of each of eight points, or the second of each, and so on.
struct CornerSlot {
    std::array<NodeIndex, Lanes::kNodes> node;       ///< of the core; kNoNode: none
    std::array<std::uint8_t, Lanes::kNodes> corner;  ///< of the cell
};

/// The nodes of a leaf, and the corners of the cells around the foot points of those outside the
/// core. No march changes them.
struct LeafCorners {
    /// Offsets, and 2^16 times places among the nodes of the leaf: first those of the core, then
    /// those outside by how many corners they have, so that eight in a row have about as many.
    std::vector<std::uint32_t> nodes;
    std::size_t coreCount = 0;
    std::vector<std::uint8_t> most;  ///< per eight of the nodes outside: slots
    std::vector<CornerSlot> slots;   ///< those of the first eight, then those of the next
};

/// Those of all leaves of a band, found when they are first asked for. Several threads may ask at a
/// time. 21 bytes per node.
class SharedLeafCorners {
public:
    /// @param find()  finds them
    template <typename Find>
    const std::vector<LeafCorners>& get(const Find& find) const {
        std::call_once(found_, [&] { leaves_ = find(); });
        return leaves_;
    }

private:
    mutable std::once_flag found_;
    mutable std::vector<LeafCorners> leaves_;
};

}  // namespace igeo
