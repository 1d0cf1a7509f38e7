/// Where fronts meet: the local solve of scheme `jet` for a point whose neighbors all have jets,
/// but too few of one front for the fit of jet_fit.h. No grid, no states, no surface.
///
/// Beside a point where fronts arrive from all sides, neighbors of one front have directions up to
/// 90 degrees apart. So the front is modeled as a circle, with its curvature k as a third unknown.
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
/// @param atFocus  whether the front may narrow to a focus here; in brackets: where it may not
/// @return none where fewer than 3 (2) neighbors of that front lie behind the origin, where they
///         differ by more than 0.02 voxels (0.004, or 0.01 if five agree; outliers left out if half
///         of them and four agree), and where the value is more than 0.2 (0.03) below all plane
///         fronts
/// Time: some microseconds.
std::optional<Jet> fitCircularFront(std::span<const JetNeighbor> neighbors, bool atFocus = true);

}  // namespace igeo
