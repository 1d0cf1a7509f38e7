/// Marches near their seeds, where it is not known how far their targets are.
#pragma once

#include <algorithm>

namespace igeo {

/// Solves on parts of the surface within a reach that doubles until all is found, which costs no
/// more than twice the last of them.
/// @param reach  the first; voxels times weight, as all of these
/// @param limit  no reach is larger, and nothing beyond it counts
/// @param whole  from here on the whole surface costs no more than a part
/// @param solveWithin  bool (double reach): whether all is found
/// @return false: it takes the whole surface
template <typename Solve>
bool searchNear(double reach, double limit, double whole, const Solve& solveWithin) {
    for (; reach <= whole; reach = std::min(limit, 2 * reach))
        if (solveWithin(reach) || reach >= limit) return true;
    return false;
}

}  // namespace igeo
