/// Fills a Band from a triangle mesh, which may be open.
#pragma once

#include <igeo/band/band.h>
#include <igeo/base/progress.h>
#include <igeo/io/triangle_mesh.h>

namespace igeo {

/// Numbers the voxels less than h from the mesh, with the nearest point of it as foot point. The
/// band keeps the triangles, for whatever asks for points of S.
///
/// Nothing has to be inside of anything: psi is the distance with the sign of the side, by the
/// normal of the part of the mesh that the foot point lies on (face, edge or corner: J. A.
/// Baerentzen and H. Aanaes, Signed distance computation using the angle weighted pseudonormal,
/// 2005), triangles being oriented alike first (orientConsistently). So both sides of a sheet
/// belong together, and sheets close to each other are kept apart (Band::linked).
///
/// A mesh ends at its boundary, and the band with it: a voxel whose foot point lies on a boundary
/// edge stays only if it is within half a voxel of the plane there, as a handle on the boundary
/// itself. Holes and slits so remain, however narrow, and paths lead around them. Where a component
/// has one side only (Moebius), the band is cut along one line across it.
/// @param dx  voxel size, in the mesh's units; voxel centers at dx (i, j, k)
/// @param h   half the band's thickness, voxels, sqrt(3)/2 to 8
///
/// Links follow the mesh: one stays only if a walk over triangles about as long as the path that it
/// stands for joins its foot points. So components stay apart however close they are, sheets that
/// cross are followed as the triangles meet, and nothing leads through thin walls. Where sheets
/// share out the voxels, bridges join nodes of one sheet over those of another.
/// @param gap  pieces no further apart than this, in the mesh's units, are joined by bridges;
///             Band::joints counts the pairs of components
/// @throws Error  InvalidArgument for h or dx out of range (requireReasonable), BadInput for too
///         many voxels or none, Cancelled through `progress`
/// Foot points are exact to rounding. Time O(triangles log triangles + voxels), in parallel; 35
/// bytes per node, about 100 more while it works.
Band bandFromMesh(const TriangleMesh& mesh, double dx, double h,
                  Progress& progress = Progress::none(), double gap = 0);

}  // namespace igeo
