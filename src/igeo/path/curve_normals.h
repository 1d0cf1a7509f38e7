/// The normal of S along curves on it.
#pragma once

#include <igeo/band/band.h>
#include <igeo/path/path.h>

namespace igeo {

/// The unit normal of S at a point of it, index space.
///
/// On a mesh that of the triangle; on an edge the mean of both sides, at a vertex the mean of the
/// triangles around it, weighted by their angles, without those narrower than 1e-4 voxels.
/// Elsewhere the gradient of the surface that the foot points and normals of the nodes around give:
/// second order.
/// @param sheetNormal  normal of the sheet, if known; returned where no surface is near
Vec3d normalAt(const Band& band, const Vec3d& pIndex, const Vec3d& sheetNormal = {});

/// Sets PathVertex::normal; the normal of each vertex selects the sheet of the next.
/// @param sheetNormal  for the first vertex; zero: that of the target's node
/// Time O(vertices), on a mesh times the logarithm of its triangles.
void addNormals(const Band& band, Path& path, const Vec3d& sheetNormal = {});

}  // namespace igeo
