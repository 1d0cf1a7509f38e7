/// Nodes where fronts meet, once a march is over. Internal.
#pragma once

#include <igeo/march/detail/jet_state.h>

#include <optional>
#include <span>
#include <vector>

namespace igeo {

/// The jet at a foot point by the front that arrives there first (fitCircularFront).
/// @param local   its chart
/// @param voxel, foot  its voxel, and where it is from there
/// @param around  nodes of the core; those at their links count as well
/// @param before  its value by the march
/// @param atFocus as in fitCircularFront
/// @return relative to the least start; none where costs vary, where fronts of several sources
///         meet, and where no front can be fitted or its value is 0.25 voxels from that before
std::optional<Solved> solveMeeting(const CoreJets& jets, const LocalFrame& local, const Ijk& voxel,
                                   const Vec3f& foot, std::span<const NodeIndex> around,
                                   double before, bool atFocus);

/// A node of the core at which fronts may meet, where S is smooth and goes on all around.
struct MayMeet {
    NodeIndex node;
    bool inDoubt;  ///< it took the fallback
};
/// Finds where fronts meet (CoreJets::meetings), and solves nodes in doubt there again: they have
/// all their neighbors now, and no other value depends on theirs.
/// In parallel, the same bits for any number of threads.
void solveMeetings(CoreJets& jets, const std::vector<MayMeet>& nodes);

}  // namespace igeo
