/// Where a tensor turns faster than the march along S follows.
#pragma once

#include <igeo/metric/metric.h>

namespace igeo {

/// The share of the nodes next to S where distances with a tensor may be off by more than 5 %:
///
///     r^2 (turn / 0.3 + bend / 3) > 1,   r the ratio of the costs along the two axes,
///
/// with the angles per voxel by which the cheap axis turns along S, and the normal. A front of such
/// a metric is a needle r times as long as wide, and directions along it err by these angles. The
/// limits are measured, on cylinders and on polar tensors of planes (docs/trials.md, Tensors).
/// @return 0 without tensors
/// Time O(n), in parallel.
double shareOfTurningTensors(const Band& band, const Metric& metric);

}  // namespace igeo
