/// Where S ends or bends beside core nodes. Internal.
#pragma once

#include <igeo/base/types.h>

#include <atomic>
#include <vector>

namespace igeo {

struct Band;
struct JetCore;

/// Answers for the nodes of a core, each found when it is first asked for: no seed changes them.
/// Several threads may ask at a time. A byte per node.
class JetRims {
public:
    void resize(std::size_t nodes) { facts_ = std::vector<std::atomic<std::uint8_t>>(nodes); }
    /// Whether S goes on from a node, or from one that is linked to it, in some directions only.
    bool isBesideOpen(const JetCore& core, NodeIndex i) const;
    /// Whether a crease is within two links.
    bool isCreasedBeside(const JetCore& core, NodeIndex i) const;

private:
    /// Each is followed by the bit that says that it is known.
    enum Fact : std::uint8_t { kOpen = 1, kBesideOpen = 4, kBesideCrease = 16 };
    template <typename Find>
    bool known(NodeIndex i, Fact fact, const Find& find) const {
        const std::uint8_t facts = facts_[i].load(std::memory_order_relaxed);
        if (facts & 2 * fact) return facts & fact;
        const bool found = find();
        facts_[i].fetch_or(std::uint8_t(2 * fact | (found ? fact : 0)), std::memory_order_relaxed);
        return found;
    }
    bool isOpen(const JetCore& core, NodeIndex i) const;

    mutable std::vector<std::atomic<std::uint8_t>> facts_;
};

/// Whether a chord between two points leads over a rim of S, farther off than either of them lies:
/// nodes lie up to half a voxel beyond rims.
bool leadsOverRim(const Band& band, const Vec3d& from, const Vec3d& to);

}  // namespace igeo
