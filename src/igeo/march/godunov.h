/// Scheme `godunov`: Fast Marching in the band, exactly as in the paper.
#pragma once

#include <igeo/band/band.h>
#include <igeo/band/surface_point.h>
#include <igeo/base/progress.h>
#include <igeo/march/field.h>
#include <igeo/metric/metric.h>

#include <vector>

namespace igeo {

struct GodunovOptions {
    int order = 2;                     ///< of the one-sided differences, 1 or 2
    double startRadius = 3.5;          ///< exact distances within this radius of a seed, voxels
    double maxDistance = kInfinity;    ///< stop beyond this distance, voxels times weight
    std::vector<SurfacePoint> stopAt;  ///< stop when d is known around all of these; empty: no stop
};

/// Marches the weighted distance outward from `seeds` until every reachable band voxel is Accepted.
///
/// Solves |grad d| = weight in the band (M&S (8)) by the upwind scheme M&S (13), using only
/// neighbors in the band (section 3 of the paper). Order 2 uses the difference over two upwind
/// voxels where both are Accepted and ordered. All nodes within `startRadius` of a seed start from
/// their straight distance to it.
/// @param band    h must respect M&S (14), see band_bounds.h; the field points to it
/// @param metric  weights or tensors that are diagonal in index axes (M&S (22)), obstacles, or null
/// @param seeds   at least one; a seed may start at a distance > 0
/// @throws Error  InvalidArgument for options or a metric out of range, Cancelled through
///         `progress`
/// Time O(n log n) on one thread, 40 bytes per node. Error: docs/trials.md.
Field marchGodunov(const Band& band, MetricPtr metric, const std::vector<SurfacePoint>& seeds,
                   const GodunovOptions& options = {}, Progress& progress = Progress::none());

}  // namespace igeo
