/// Fills a Band from a triangle mesh, which may be open.
#pragma once

#include <igeo/band/band.h>
#include <igeo/base/progress.h>
#include <igeo/io/triangle_mesh.h>

namespace igeo {

/// Numbers the voxels less than h from the mesh, with the nearest point of the mesh as foot point.
/// The band keeps the triangles for queries of points of S.
///
/// No inside is needed: psi is the distance with the sign of the side, by the normal of the part of
/// the mesh that contains the foot point (face, edge or corner: J. A. Baerentzen and H. Aanaes,
/// Signed distance computation using the angle weighted pseudonormal, 2005). The triangles are
/// first oriented consistently (orientConsistently). So both sides of a sheet are connected, and
/// sheets close to each other are separate (Band::linked).
///
/// The band ends at the boundary of the mesh: a voxel whose foot point is on a boundary edge stays
/// only if it is within half a voxel of the plane there, to represent the boundary itself. So holes
/// and slits remain, however narrow, and paths lead around them. Where a component has one side
/// only (Moebius), normals are opposite along one line across it, which stops `godunov`.
/// @param dx  voxel size, in the mesh's units; voxel centers at dx (i, j, k)
/// @param h   half the band's thickness, voxels, sqrt(3)/2 to 8
///
/// Links follow the mesh: a link stays only if a walk over triangles, about as long as the path
/// that the link represents, joins its foot points. So components stay separate however close they
/// are, crossing sheets are followed as their triangles connect, and no link leads through thin
/// walls. Where sheets divide the voxels between them, bridges join nodes of one sheet over those
/// of another.
/// @param gap  components no farther apart than this, in the mesh's units, are joined by bridges;
///             Band::joints counts the pairs of components
/// @throws Error  InvalidArgument for h or dx out of range (requireReasonable), BadInput for too
///         many voxels or none, Cancelled through `progress`
/// Foot points are exact to rounding. Time O(triangles log triangles + voxels), in parallel; 35
/// bytes per node, and about 100 bytes of working memory.
Band bandFromMesh(const TriangleMesh& mesh, double dx, double h,
                  Progress& progress = Progress::none(), double gap = 0);

}  // namespace igeo
