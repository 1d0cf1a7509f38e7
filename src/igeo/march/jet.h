/// Scheme `jet`: marching value and gradient on the foot points of the band.
#pragma once

#include <igeo/band/band.h>
#include <igeo/band/surface_point.h>
#include <igeo/base/progress.h>
#include <igeo/march/field.h>
#include <igeo/march/jet_options.h>
#include <igeo/metric/metric.h>

#include <memory>
#include <vector>

namespace igeo {

/// The data that marches on a band in a metric share: the core and its links, laid flat.
struct JetCore;
using JetCorePtr = std::shared_ptr<const JetCore>;

/// Makes the core, once for all marches. It points to the band.
/// @param metric weights or tensors, obstacles, or null
/// @throws Error  InvalidArgument for a metric out of range (tensors: ratio of costs in a tangent
///         plane above 20), or a band narrower than sqrt(3)/2 voxels
/// Time O(n), in parallel, about as long as a march; 60 bytes per node of the band, and 21 more
/// once a march has filled it.
JetCorePtr jetCore(const Band& band, MetricPtr metric);

/// The nodes of the core around points of S, sorted: where they are known, so is the distance at
/// the points.
std::vector<NodeIndex> coreAround(const Band& band, const std::vector<SurfacePoint>& points);

/// Marches the jet of the distance (value and gradient along S) outward from `seeds`.
///
/// Every band node has the jet of its foot point y_i on S, so the band need not contain paths (h =
/// sqrt(3) voxels is enough) and no neighbor is outside. The nodes of the core (Band) pass through
/// buckets of equal width in the distance; all nodes of a bucket are solved (detail/jet_update.h)
/// from nodes of earlier buckets only and accepted together. So the work is linear in the number of
/// nodes, every bucket is a parallel loop, and the result has the same bits for any number of
/// threads. The other nodes take their jets from the core around their foot points.
///
/// The equation is |grad_S d| = g (M&S (7)), or G^-1[grad_S d, grad_S d] = 1 where the metric is a
/// tensor G (M&S 5.1). With tensors each solve uses coordinates in which the metric of its tangent
/// plane is Euclidean. Where these stretch the plane by more than 2, nodes use, besides their 26
/// neighbors, those of Selling's reduction (detail/selling_reduction.h). A start disc contains the
/// foot points whose cost is at most that of `startRadius` voxels in the most expensive direction.
/// @param core   the field points to its band
/// @param seeds  at least one; a seed may start at a distance > 0. With several, Field::label is
///               the source of a node (on ties the earlier one), and fronts of different seeds are
///               never fitted together
/// @return distances in voxels times weight, +infinity where no front arrives: second order in dx
///         where S is smooth, first order at creases. Field::gradient is set. Field::fallbackCount
///         is the number of core nodes solved by the fallback, which is at least first order
/// @throws Error  InvalidArgument for options out of range, start values 1e9 voxels apart, or
///         distances beyond 2e9 voxels of the least weight; Cancelled through `progress`
/// Time O(n), in parallel; 14 bytes per node of the band for the core, 20 for a field on all of it.
/// Error: docs/accuracy.md.
Field marchJet(const JetCorePtr& core, const std::vector<SurfacePoint>& seeds,
               const JetOptions& options = {}, Progress& progress = Progress::none());

/// The same for a single march: the core is freed before the field is filled.
Field marchJet(const Band& band, MetricPtr metric, const std::vector<SurfacePoint>& seeds,
               const JetOptions& options = {}, Progress& progress = Progress::none());

}  // namespace igeo
