/// Steps of geodesics on S, up to eight side by side. Internal to jet_rays.cpp.
#pragma once

#include <igeo/march/detail/jet_corners.h>

#include <array>

namespace igeo {

struct RayLanes {
    template <typename T>
    using PerLane = std::array<T, Lanes::kNodes>;
    Lanes x, y, z;     ///< from the voxel where the ray begins
    Lanes vx, vy, vz;  ///< direction, unit
    Lanes nx, ny, nz;  ///< normal of S
    Lanes turn;        ///< of the direction toward the normal, in the last step
    Lanes length;      ///< so far
    alignas(32) PerLane<std::int32_t> valid;  ///< 0 or -1: the ray is on smooth S
    CellPlaces start{};                       ///< the voxel where the ray begins

    Lanes aheadX, aheadY, aheadZ;  ///< where the next step leads to, but for its height above S
    CellPlaces cell{};             ///< the one there

    /// At the end of a ray.
    Lanes u;          ///< value, over the weight, from the bucket of JetCorners on
    Lanes curvature;  ///< of the front
    Lanes off;        ///< sine of the angle from the ray to the path back, about the normal
};

/// Sets where steps of a length lead to, and the points there but for the nodes around them.
void lookAhead(float step, RayLanes& rays, CellPoints& points);
/// Makes the step.
/// @param corners  of the cells around the points ahead
/// @param faceted  as Band::faceted
void makeStep(const JetCorners& corners, bool faceted, RayLanes& rays);
/// Makes the last step, and reads the front there that travels most nearly against the ray.
void makeLastStep(const JetCorners& corners, bool faceted, RayLanes& rays);

}  // namespace igeo
