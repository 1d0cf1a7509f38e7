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
/// Points to the side of the ends of rays, and the corners around them. Where the corners at an end
/// lie on one side of it, they do not show how the front is curved.
struct BesideRays {
    static constexpr float kStep = 1;       ///< voxels, from the end
    static constexpr float kSpread = 0.1f;  ///< of the corners at the end, voxels^2: it is enough
    Lanes x, y, z;                          ///< from the voxel where the ray begins
    CellPlaces cell{};
    CellPoints points;
    JetCorners corners;
    alignas(32) RayLanes::PerLane<std::int32_t> wanted;  ///< 0 or -1
};
/// Sets the points.
/// @param corners  of the cells around the ends
void lookBeside(const JetCorners& corners, RayLanes& rays, BesideRays& beside);
/// Reads the front at the end that travels most nearly against the ray.
void readFronts(const JetCorners& corners, const BesideRays& beside, RayLanes& rays);

}  // namespace igeo
