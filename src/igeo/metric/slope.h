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

/// What slopes cost on a band.
struct SlopeCosts {
    std::vector<float> weights;              ///< per node; where it is too steep, 2
    std::shared_ptr<const Obstacles> steep;  ///< the parts that are too steep; null: none
};
/// Weights by the triangles of a mesh; at an edge by the gentlest of those that meet there. On
/// level sets and points by the normal, but at an edge, which voxels round off, no less than the
/// gentler side has. The obstacle: the steep triangles of a mesh (ObstacleSet::addTriangles), else
/// where the normal is too steep, or both sides of an edge are. Time O(n), in parallel.
/// @throws Error  InvalidArgument for a field of `slope` out of its range
SlopeCosts slopeCosts(const Band& band, const SlopeWeight& slope);

}  // namespace igeo
