/// Nodes where fronts meet, once a march is over. Internal.
#pragma once

#include <igeo/march/detail/jet_state.h>

#include <optional>
#include <span>
#include <vector>

namespace igeo {

/// The jet at a foot point by the front that arrives there first (fitCircularFront).
/// @param local   its chart
/// @param around  nodes of the core; those at their links count as well
/// @return relative to the least start, over the weight there; none with tensors, where fronts of
///         several sources meet, and where no front can be fitted
std::optional<Solved> solveMeeting(const CoreJets& jets, const LocalFrame& local, const Vec3d& foot,
                                   std::span<const NodeIndex> around);

/// Solves the nodes of a march that took the fallback once more, where S is smooth and fronts meet:
/// they have all their neighbors now, and no other value depends on theirs.
/// @param nodes  of the core
/// In parallel, the same bits for any number of threads.
void solveMeetings(CoreJets& jets, const std::vector<NodeIndex>& nodes);

}  // namespace igeo
