/// Seeds and targets: given points, moved onto the surface.
#pragma once

#include <igeo/band/band.h>

#include <algorithm>
#include <vector>

namespace igeo {

/// A point of S, found for a given point.
struct SurfacePoint {
    Vec3d askedIndex;          ///< as given, index space
    Vec3d pIndex;              ///< on S, index space
    double snapDistance = 0;   ///< |pIndex - askedIndex|, voxels
    NodeIndex node = kNoNode;  ///< node of the band on the same sheet, nearest to pIndex
    /// Of a mesh the triangle that pIndex lies on, of a segment the one that it starts on; kNone:
    /// the nearest.
    std::uint32_t triangle = SurfaceTriangles::kNone;
    double start = 0;   ///< distance at which the front of a seed starts, voxels times weight
    double weight = 1;  ///< the metric's weight here, set by the march
    /// Of S here or in the middle of the segment, set by jet's march. The node may lie on the other
    /// face of an edge.
    Vec3f normal;

    /// A seed may be a straight segment of a curve (seeds.h): all points from pIndex to pIndex +
    /// segment.
    Vec3d segment;
    bool joined = false;  ///< belongs to the same curve or region as the seed before it in the list
    /// On the rim of a region inside which the distance does not rise (clearInside)
    bool rim = false;
    bool offSurface = false;  ///< farther from S than allowed, and skipped: no distance

    /// The point of the seed nearest to p.
    Vec3d nearestTo(const Vec3d& p) const {
        const double l2 = dot(segment, segment);
        return l2 > 0 ? pIndex + std::clamp(dot(p - pIndex, segment) / l2, 0.0, 1.0) * segment
                      : pIndex;
    }
};

/// The same in world space.
struct SnappedPoint {
    Vec3d asked, position;    ///< as given; on the surface
    double distance = 0;      ///< between them, world units; +infinity: not known
    bool offSurface = false;  ///< as SurfacePoint; `position` is then unset
};
inline SnappedPoint inWorld(const SurfacePoint& p, const Similarity& transform) {
    return {transform.worldFromIndex(p.askedIndex), transform.worldFromIndex(p.pIndex),
            p.snapDistance * transform.dx, p.offSurface};
}

/// The point of S nearest to `pIndex`.
///
/// On a mesh: the nearest point of its triangles; for a vertex on a face of another part, of the
/// vertex's own triangles. Elsewhere: the search starts at the node with the nearest foot point
/// (among the 5^3 voxels around the point if these decide it, else among all nodes) and projects to
/// psi = 0 (projectToSurface). At a corner of a rim S goes on in the plane of that node, up to 1.5
/// voxels.
/// @param pIndex finite position in index space
/// @throws Error  BadInput for an empty band
/// Time O(1) near the surface, O(n) in parallel elsewhere; O(log triangles) on a mesh. Accuracy:
/// exact on a mesh; elsewhere the snap distance is the least over the foot points of band voxels,
/// which are less than a voxel apart.
SurfacePoint nearestSurfacePoint(const Band& band, const Vec3d& pIndex);

/// Where a point of a seed is on its mesh; where a segment runs through another face, on the
/// triangle along which it runs.
SurfaceTriangles::Place placeOn(const SurfaceTriangles& triangles, const SurfacePoint& seed,
                                const Vec3d& p);

/// Sets the triangles at both ends of the segment from `from` to `to`, for which the mesh may have
/// several: those along which it runs.
void takeTriangles(const SurfaceTriangles& triangles, SurfacePoint& from, SurfacePoint& to);

/// Nodes within `radius` voxels of a point of S that such nodes connect to it, sorted.
std::vector<NodeIndex> nodesAround(const Band& band, const SurfacePoint& p, double radius);

}  // namespace igeo
