/// A path on the surface, the result of tracing, straightening and shooting.
#pragma once

#include <igeo/band/surface_point.h>

#include <cstddef>
#include <vector>

namespace igeo {

enum class PathStatus {
    Reached,      ///< ends at a seed
    Unreachable,  ///< the target has no distance: no path in the band, or beyond an early stop
    Stalled,      ///< no lower point was found before a seed
    OffSurface    ///< the target was skipped (SurfacePoint::offSurface)
};
const char* toString(PathStatus status);

/// A point on a geodesic.
struct PathVertex {
    Vec3d pIndex;          ///< on S, index space
    double arcLength = 0;  ///< from the target, voxels
    double distance = 0;   ///< d here, voxels times weight
    Vec3d normal = {};     ///< unit, of S; zero until addNormals
};

/// A geodesic from a target to the seed that gives its distance.
struct Path {
    SurfacePoint target;
    PathStatus status = PathStatus::Unreachable;
    std::size_t seed = 0;              ///< index of the seed reached, if Reached
    std::vector<PathVertex> vertices;  ///< from the target to the seed; empty if Unreachable
    double weightedLength = 0;         ///< by the metric: voxels times weight
    double length = 0;                 ///< voxels; the same where there is no weight
    double distance = kInfinity;       ///< d at the target, voxels times weight
    /// Of a walk: the sharp bends that it crossed as the voxels round them (shoot).
    std::size_t roundedBends = 0;
    /// Of a walk: the edges that it crossed within about a voxel of a corner.
    std::size_t closeCorners = 0;
};

}  // namespace igeo
