/// Which side of closed curves and regions a node lies on.
#pragma once

#include <igeo/base/progress.h>
#include <igeo/march/field.h>
#include <igeo/metric/metric.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace igeo {

/// Makes the distance from a region that of its outside: 0 at nodes inside, whatever seeds there
/// are besides.
/// @param inside per node (nodesInside)
/// @param source of the region (Field::source)
void clearInside(const std::vector<std::uint8_t>& inside, std::uint32_t source, Field& field);

/// Makes it that of the rim, negative at nodes inside.
void signInside(const std::vector<std::uint8_t>& inside, Field& field);

/// -1 or +1 per node: what lies across a curve of the field's seeds from a node has the other sign,
/// and of a connected part of S the smaller share, by nodes of the band, is negative. Of curves
/// within curves it is every other ring. 0 where the distance is not known.
///
/// Next to a curve the side is that of its nearest segment, seen along the normal; from there it
/// spreads from neighbor to neighbor.
/// @throws Error  InvalidArgument where the seeds do not part S in two: an open curve, a point, or
///         a closed curve that can be walked around (a meridian of a torus);
///         Cancelled
/// Time O(n), one thread.
std::vector<std::int8_t> signsOfCurves(const Field& field, Progress& progress = Progress::none());

/// What is left to do after a march from sources of which some are regions: 0 inside of them, or,
/// of a signed distance, the sign by them, or by the curves where there are none.
/// @param first  number of the source that is the first region
/// @throws Error  as signsOfCurves
void finishInside(const std::vector<std::shared_ptr<const Obstacles>>& regions, std::size_t first,
                  bool isSigned, Field& field, Progress& progress = Progress::none());

/// The sign of the distance at a point of S: that of the nearest node; 1 where there are no sides.
double signAt(const Field& field, const Vec3d& pIndex);

}  // namespace igeo
