/// The side of closed curves and regions that a node lies on.
#pragma once

#include <igeo/base/progress.h>
#include <igeo/march/field.h>
#include <igeo/metric/metric.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace igeo {

/// Turns the distance from a region into the distance outside of it: 0 at nodes inside, whatever
/// the other seeds, and where no front came; not in obstacles.
/// @param inside per node (nodesInside)
/// @param source of the region (Field::source)
void clearInside(const std::vector<std::uint8_t>& inside, std::uint32_t source, Field& field);

/// Turns it into the signed distance from the rim, negative at nodes inside.
void signInside(const std::vector<std::uint8_t>& inside, Field& field);

/// -1 or +1 per node. Nodes on opposite sides of a curve of the field's seeds have opposite signs,
/// and of each connected part of S the smaller share, by nodes of the band, is negative. Of nested
/// curves every other ring is. 0 where the distance is unknown.
///
/// Next to a curve the side is that of its nearest segment, seen along the normal; from there it
/// spreads from neighbor to neighbor.
/// @throws Error  InvalidArgument where the seeds do not divide S in two: an open curve, a point,
///         or a closed curve that does not separate its sides (a meridian of a torus); Cancelled
/// Time O(n), one thread.
std::vector<std::int8_t> signsOfCurves(const Field& field, Progress& progress = Progress::none());

/// Finishes a march from sources that include regions or curves: sets 0 inside the regions, or, for
/// a signed distance, the sign by the regions, or by the curves where there are no regions.
/// @param first  number of the source that is the first region
/// @throws Error  as signsOfCurves
void finishInside(const std::vector<std::shared_ptr<const Obstacles>>& regions, std::size_t first,
                  bool isSigned, Field& field, Progress& progress = Progress::none());

/// The sign of the distance at a point of S, interpolated; 1 without signs.
double signAt(const Field& field, const Vec3d& pIndex);

}  // namespace igeo
