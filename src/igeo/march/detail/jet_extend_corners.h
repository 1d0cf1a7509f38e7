/// Finds LeafCorners, for the extension from the core to the rest of a band. Internal.
#pragma once

#include <igeo/march/detail/leaf_corners.h>
#include <igeo/march/detail/leaf_numbers.h>

namespace igeo::jet {

/// @param numbers  of the leaf
void findCorners(const Band& band, LeafIndex l, const LeafNumbers<2>& numbers, LeafCorners& to);
/// Those of all leaves, in parallel.
std::vector<LeafCorners> cornersOfLeaves(const Band& band);

}  // namespace igeo::jet
