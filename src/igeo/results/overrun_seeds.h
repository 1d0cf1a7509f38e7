/// Seeds with a late start that the front of another seed comes before.
#pragma once

#include <igeo/march/field.h>

#include <string>
#include <vector>

namespace igeo {

/// A sentence for each source, or part of a curve, whose start value is above the distance there
/// from the other seeds by more than 0.01 voxels: it has no effect.
/// @param names  what to call the sources; where there is none, or an empty one, by the number
/// Time O(seeds).
std::vector<std::string> overrunWarnings(const Field& field,
                                         const std::vector<std::string>& names = {});

}  // namespace igeo
