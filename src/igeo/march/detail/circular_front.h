/// Reading beside a focus: the jet at a point whose neighbors all have jets, but too few of one
/// front for a blend. No grid, no states, no surface.
///
/// Where fronts arrive from all sides, neighbors of one front have directions up to 90 degrees
/// apart. So the front is modeled as a circle, with its curvature k as a third unknown.
/// From a point of it with value u and direction g, the front has at the offset a
///
///     value      u + (2 p + k |a|^2) / (1 + r),      p = g . a
///     direction  (g + k a) / r,                      r^2 = 1 + 2 k p + k^2 |a|^2
///
/// exactly for fronts that spread (k > 0), converge (k < 0) or are straight. Gauss-Newton steps fit
/// u, g and k to the values and directions of the neighbors at their positions.
#pragma once

#include <igeo/march/detail/jet_neighbors.h>

#include <optional>
#include <span>

namespace igeo {

/// The jet at the origin, from the front that arrives there first.
/// @param neighbors  of one source, in the chart of the origin, up to three voxels away
/// @return none where fewer than three neighbors of that front lie behind the origin, where they
///         differ by more than 0.02 voxels (outliers left out if half of them and four agree), and
///         where the value is more than 0.2 voxels below all plane fronts
/// Time: some microseconds.
std::optional<Jet> fitCircularFront(std::span<const JetNeighbor> neighbors);

}  // namespace igeo
