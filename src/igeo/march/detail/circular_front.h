/// Where fronts meet: the local solve of scheme `jet` for a point that all its neighbors have jets
/// around, too few of them of one front for a fit (jet_fit.h). No grid, no states, no surface.
///
/// Beside a point where fronts come in from all sides, neighbors of one front have directions up to
/// 90 degrees apart. So their front is a circle here, with its curvature k for a third unknown.
/// From a point of it with value u and direction g, the front has at the distance a
///
///     value      u + (2 p + k |a|^2) / (1 + r),      p = g . a
///     direction  (g + k a) / r,                      r^2 = 1 + 2 k p + k^2 |a|^2
///
/// exactly for fronts that spread (k > 0), narrow (k < 0) or are straight. Gauss-Newton steps fit
/// u, g and k to the values and directions of the neighbors, each at its own place.
#pragma once

#include <igeo/march/detail/jet_neighbors.h>

#include <optional>
#include <span>

namespace igeo {

/// The jet at the origin by the front that arrives there first.
/// @param neighbors  of one source, in the chart of the origin, as far as three voxels off
/// @return none where less than three neighbors of that front lie behind the origin, or they do not
///         agree within 0.02 voxels
/// Some microseconds.
std::optional<Jet> fitCircularFront(std::span<const JetNeighbor> neighbors);

}  // namespace igeo
