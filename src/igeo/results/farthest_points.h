/// Points spread evenly over the surface.
#pragma once

#include <igeo/band/surface_point.h>
#include <igeo/base/progress.h>
#include <igeo/metric/metric.h>

#include <cstddef>
#include <vector>

namespace igeo {

/// Farthest-point sampling: `count` points, each at the foot point of the core that is farthest
/// from `start` and the points before it; of equals, the one with the lower node number.
///
/// Pieces of the surface without a point are infinitely far, so they come first. No two points are
/// nearer to each other than the last one was to all others, and no foot point is farther from all
/// points than that (Gonzalez, Theor. Comput. Sci. 38, 1985): within a factor of two of the best
/// spread there is.
/// @param metric weights, obstacles, or null; nothing is put inside an obstacle
/// @param start  points that are there before, not part of the result; may be empty
/// @return in the order they were found, so that each beginning of the list is a sampling as well
/// @throws Error  InvalidArgument for a count of 0 or of more than there are foot points; as
///         marchJet; Cancelled
/// Distances are those of marchJet. Each point marches only where it is nearer than all before
/// (JetOptions::below): k points take about as long as log k marches of the whole surface, and a
/// pass over the band's arrays each, which is a twentieth of a march.
std::vector<SurfacePoint> farthestPoints(const Band& band, const MetricPtr& metric,
                                         const std::vector<SurfacePoint>& start, std::size_t count,
                                         Progress& progress = Progress::none());

}  // namespace igeo
