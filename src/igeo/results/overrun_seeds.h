/// Seeds with a late start that another seed's front reaches first.
#pragma once

#include <igeo/march/field.h>

#include <string>
#include <vector>

namespace igeo {

/// A sentence for each source, or part of a curve, whose start value exceeds the distance from the
/// other seeds by more than 0.01 voxels: it has no effect.
/// @param names  of the sources; a missing or empty name is replaced by the number
/// Time O(seeds).
std::vector<std::string> overrunWarnings(const Field& field,
                                         const std::vector<std::string>& names = {});

}  // namespace igeo
