/// Geodesics by back-tracking the distance (M&S 4.1).
#pragma once

#include <igeo/base/progress.h>
#include <igeo/march/field.h>
#include <igeo/path/path.h>

#include <vector>

namespace igeo {

struct TraceOptions {
    double maxStep = 1.0;     ///< voxels
    double minStep = 0.01;    ///< voxels; below it the path continues from node to node
    double tolerance = 1e-3;  ///< local error per step, voxels
    /// Steps of two voxels, each by the gradient of one node: a tenth of the time, for a path that
    /// only shows straightened() where the geodesic runs. Its chords leave S, and are not laid on
    /// triangles. Without weights and obstacles.
    bool rough = false;
};

/// Follows gamma' = -grad_S d / |grad_S d|, or -G^-1 grad_S d made unit where the metric is a
/// tensor G, from `target` by the embedded Runge-Kutta pair 2(3) of Bogacki and Shampine with
/// adaptive step. Each step is projected to S. Within a seed's start disc the path goes straight to
/// the seed on the surface.
///
/// Where an obstacle blocks a step, the path slides along its rim. Where no step along the gradient
/// leads down (cut loci, creases), the path continues over the foot points of nodes, each time to
/// the neighbor of least distance. Distances never rise along a path.
///
/// On a mesh without weights and obstacles the path is then made the shortest curve over the
/// triangles around it, exact to rounding, as straighten() does.
/// @return vertices lie on S: on psi = 0 (samplePsi) to 1e-6 voxels where the projection converges;
///         or on the triangles of a mesh, with all segments as well, since there is a vertex on
///         each edge that the path crosses
/// Time O(length).
Path tracePath(const Field& field, const SurfacePoint& target, const TraceOptions& options = {});

/// tracePath for every target, in parallel; results in the order of the targets.
std::vector<Path> tracePaths(const Field& field, const std::vector<SurfacePoint>& targets,
                             const TraceOptions& options = {},
                             Progress& progress = Progress::none());

}  // namespace igeo
