/// The cost of slopes, for terrain.
#pragma once

#include <igeo/band/band.h>
#include <igeo/metric/metric.h>

#include <memory>
#include <vector>

namespace igeo {

/// A weight of 1 + (tan a / tan steepest)^power where the surface is inclined by the angle a: 1 on
/// flat ground, 2 at the steepest. Steeper parts are an obstacle. The same for up and down and for
/// all directions; both sides of a surface have the same slope.
struct SlopeWeight {
    Vec3d up{0, 0, 1};      ///< world, unit
    double steepest = 0.5;  ///< radians, above 0 and below pi/2
    double power = 2;       ///< above 0

    bool operator==(const SlopeWeight&) const = default;
};

/// The weight per band node; where it is too steep, 2. On a mesh by its triangles; at an edge by
/// the least of those that meet there. On level sets and points by the normal, but at an edge,
/// which voxels round off, no less than the gentler side has. Time O(n), in parallel.
/// @throws Error  InvalidArgument for a field out of its range
std::vector<float> slopeWeights(const Band& band, const SlopeWeight& slope);

/// The obstacle of parts that are too steep, joined with `others`: on a mesh its steep triangles
/// (ObstacleSet::addTriangles), else where the normal of the surface is, or both sides of an edge.
/// @param others  may be null
/// @return null where nothing is too steep, and there are no others
std::shared_ptr<const Obstacles> steepObstacles(const Band& band, const SlopeWeight& slope,
                                                std::shared_ptr<const Obstacles> others);

}  // namespace igeo
