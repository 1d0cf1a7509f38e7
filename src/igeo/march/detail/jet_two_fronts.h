/// Where two fronts meet at a small angle: each is carried on by itself. Internal.
///
/// Along a cut locus beside which fronts spread, the angle between them falls. The march fits
/// fronts less than 45 degrees apart together, and below 20 degrees rays (jet_rays.h) end between
/// both. So once a march is over, the nodes beside such a locus are solved again, in the order of
/// the distance, each twice: from neighbors that the first front has reached, and from those of the
/// second. The lesser value counts. The other one is that of a front which has crossed the locus;
/// nodes further on need it.
///
/// The front of a neighbor that was not solved again is that of its side of the locus. The
/// difference of both values at the node before shows the side. Directions do not: each front
/// spreads by degrees from voxel to voxel.
#pragma once

#include <igeo/march/detail/jet_state.h>

#include <vector>

namespace igeo {

/// Solves the core beside cut loci along which the angle between two fronts falls below 20 degrees
/// from 36 or more. A locus that begins with small angles, at a cusp, is left: the angle grows
/// there, and the march errs no more than elsewhere. In one thread; time O(nodes beside them).
/// @param own       where the core has no links: those of the march, made again here
/// @param meetings  ascending; those that are solved here lose their fronts
/// @param near      marks as those of Meetings
/// @return both fronts at nodes within kWidth, ascending
std::vector<TwoFronts> carryTwoFronts(CoreJets& jets, JetLinks& own,
                                      std::vector<Meetings::Meeting>& meetings,
                                      std::vector<std::uint8_t>& near);

}  // namespace igeo
