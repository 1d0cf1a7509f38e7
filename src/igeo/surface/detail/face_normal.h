/// Normals next to edges, from the plane that psi shows. Internal.
#pragma once

#include <igeo/base/types.h>
#include <igeo/surface/detail/leaf_block.h>

#include <optional>

namespace igeo {

/// The unit normal of the plane of one face, where psi at the 26 voxels around a voxel shows one.
///
/// Within a voxel of an edge a difference along an axis mixes the face with what lies behind its
/// edge, and normals are off by up to 40 degrees. But psi is still linear over the face at some of
/// the voxels around. Candidates are the gradients of psi over the 48 tetrahedra between the voxel,
/// a face neighbor, an edge neighbor beside that and a corner neighbor beside both, of length 1. On
/// a face that is hardly wider than two voxels all that show it may lie in one plane of the
/// lattice: where too few agree with those candidates, gradients within such planes count,
/// completed to length 1. The one with which most neighbors agree counts, the less the more its
/// length is off 1, if it is enough of them: on curved parts of S, and where the edge itself is the
/// nearest point of S, there is none. Neighbors may be missing.
/// @param block  gathered with its corners
/// Time O(1), some hundred instructions per candidate.
std::optional<Vec3f> faceNormal(const LeafBlock& block, int x, int y, int z);

}  // namespace igeo
