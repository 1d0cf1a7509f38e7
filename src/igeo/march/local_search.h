/// Marches near their seeds, for targets at unknown distances.
#pragma once

#include <algorithm>

namespace igeo {

/// Solves on parts of the surface within a reach that doubles until all is found, which costs at
/// most twice the last solve.
/// @param reach  the first reach; voxels times weight, as the other two
/// @param limit  the largest reach; results beyond it are not needed
/// @param whole  from this reach on the whole surface is no more expensive than a part
/// @param solveWithin  bool (double reach): whether all is found
/// @return false: solve on the whole surface
template <typename Solve>
bool searchNear(double reach, double limit, double whole, const Solve& solveWithin) {
    for (; reach <= whole; reach = std::min(limit, 2 * reach))
        if (solveWithin(reach) || reach >= limit) return true;
    return false;
}

}  // namespace igeo
