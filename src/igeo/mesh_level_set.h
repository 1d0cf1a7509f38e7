/// Level sets of triangle meshes.
#pragma once

#include <igeo/level_set.h>
#include <igeo/progress.h>
#include <igeo/triangle_mesh.h>

namespace igeo {

/// The signed distance to a closed mesh, looked at as one from a file is (checkLevelSet): sides by
/// OpenVDB's tools::meshToVolume, distances exact. Voxel centres at dx (i, j, k); named after the
/// file.
///
/// The sign comes from a flood fill from outside, so how triangles are oriented does not matter;
/// pieces that touch or overlap become one, and what lies inside of a piece is filled.
/// @param halfWidth  voxels, 2 or more
/// @throws Error  BadInput for an open mesh and what checkLevelSet refuses; InvalidArgument for a
///         voxel size that asks for too much (requireReasonable); Cancelled through `progress`
/// Time O(active voxels), in parallel.
LevelSet levelSetFromMesh(const TriangleMesh& mesh, double dx, double halfWidth = 3,
                          Progress& progress = Progress::none());

/// A closed level set around a mesh that may be open: the surface `thickness` voxels off on all
/// sides, for pictures and engravings. psi is |distance| - thickness, half-width 3.
/// @param thickness  voxels, 0.5 to 2
/// @throws Error  as levelSetFromMesh, but for the open mesh
LevelSet shellOfMesh(const TriangleMesh& mesh, double dx, double thickness = 1,
                     Progress& progress = Progress::none());

}  // namespace igeo
