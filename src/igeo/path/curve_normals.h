/// The normal of S along curves on it.
#pragma once

#include <igeo/band/band.h>
#include <igeo/path/path.h>

namespace igeo {

/// The unit normal of S at a point of it, index space.
///
/// On a mesh that of the triangle there; on an edge the mean of both sides, at a vertex the mean of
/// the triangles around it, weighted by their angles. Elsewhere the gradient of the surface that
/// foot points and normals of the nodes around show: second order, where the gradient
/// of the trilinear interpolant of psi is of first.
/// @param sheetNormal  normal of the sheet that is meant, where it is known; what is left where
///                     there is no surface near
Vec3d normalAt(const Band& band, const Vec3d& pIndex, const Vec3d& sheetNormal = {});

/// Sets PathVertex::normal, each by the sheet of the vertex before.
/// @param sheetNormal  of the first; none: of the target's node
/// Time O(vertices), on a mesh times the logarithm of its triangles.
void addNormals(const Band& band, Path& path, const Vec3d& sheetNormal = {});

}  // namespace igeo
