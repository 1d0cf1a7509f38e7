/// Nodes of the core where fronts meet, once a march is over. Internal.
#pragma once

#include <igeo/march/detail/jet_state.h>

#include <vector>

namespace igeo {

/// Finds the nodes of the core across which fronts meet (FrontsMeet): they have all their neighbors
/// now, and no other value depends on theirs. Null where there are none, and where costs vary;
/// nodes where S has creases or obstacles do not count. In parallel, the same bits for any number
/// of threads. Beside loci along which fronts meet at small angles, the jets of the march are
/// solved again (jet_two_fronts.h).
/// @param own    the links of the march where the core has none; rows are made where needed
/// @param nodes  across which the march saw fronts meet (JetGroup::Solution::frontsMeet)
std::shared_ptr<const Meetings> findMeetings(CoreJets& jets, JetLinks& own,
                                             const std::vector<NodeIndex>& nodes);

}  // namespace igeo
