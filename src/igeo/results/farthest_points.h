/// Points spread evenly over the surface.
#pragma once

#include <igeo/band/surface_point.h>
#include <igeo/base/progress.h>
#include <igeo/metric/metric.h>

#include <cstddef>
#include <vector>

namespace igeo {

/// Farthest-point sampling: `count` points, each at the foot point of the core that is farthest
/// from `start` and the points before it; on ties the lowest node number.
///
/// Components of the surface without a point are infinitely far, so they come first. All points are
/// at least as far from each other as the last one is from all others, and no foot point is farther
/// than that from all points (Gonzalez, Theor. Comput. Sci. 38, 1985): within a factor of two of
/// the best possible spread.
/// @param metric weights, obstacles, or null; no point is put inside an obstacle
/// @param start  existing points, not part of the result; may be empty
/// @return in the order of choice, so that the first k points are a sampling too
/// @throws Error  InvalidArgument for a count of 0 or of more than there are foot points; as
///         marchJet; Cancelled
/// Distances are those of marchJet. Each march visits only nodes that are nearer to its point than
/// to all before (JetOptions::below): k points take about as long as log k marches of the whole
/// surface, plus a pass over the band's arrays each, a twentieth of a march.
std::vector<SurfacePoint> farthestPoints(const Band& band, const MetricPtr& metric,
                                         const std::vector<SurfacePoint>& start, std::size_t count,
                                         Progress& progress = Progress::none());

}  // namespace igeo
