/// The step that ends OpenVDB's conversion of meshes, undone. Internal.
#pragma once

#include <openvdb/openvdb.h>

#include <cstddef>
#include <cstdint>
#include <optional>

namespace igeo {

/// Whether the values of psi are as OpenVDB's meshToVolume leaves them.
///
/// It ends with a step of renormalization (Renormalize in tools/MeshToVolume.h) between two
/// additions, of -0.8 voxels and of 0.8 voxels less 1e-7. Values next to zero keep only the bits
/// that a number of 0.8 voxels has: here all of them do, of other values one in eight or fewer.
/// Values with few bits, as of a plane between voxels or in half precision, show nothing. Distances
/// computed in single precision, as a root less a radius of 1.5 to 13 voxels, have such bits too;
/// 16 or more different ones tell them apart, as almost all are even in the last place then. Looks
/// at a thousand leaves.
bool isRenormalized(const openvdb::FloatGrid& psi);

/// Whether psi near S has few different values, as of plane faces in line with the voxels: their
/// bits show nothing. Looks at as many leaves.
bool repeatsValues(const openvdb::FloatGrid& psi);

/// Whether all values are numbers of half precision, as of a grid that was saved as half floats.
/// Their bits do not show what made them. Values that repeat are so by chance. Looks at as many
/// leaves.
bool isInHalfPrecision(const openvdb::FloatGrid& psi);

/// Numbers of voxels once the step is undone.
struct Undone {
    std::size_t lowered = 0;     ///< in front of hollow edges
    std::uint64_t negative = 0;  ///< inside, of all active ones
};

/// Undoes that step.
///
/// It makes phi = psi - 0.8 voxels lower by c = |S| M. M is what the upwind gradient of phi is
/// above 1 outside of phi = 0 and below 1 inside, S = phi / sqrt(phi^2 + |grad phi|^2); M < 0
/// changes nothing. So psi is too low wherever the surface is hollow: by up to half the curvature,
/// and by up to a voxel in front of hollow edges and in folds.
/// - Voxels in front of hollow edges of plane faces get the least height over these (HollowEdges).
/// - Elsewhere M changes little along the gradient, and the upwind gradient of what is stored lacks
///   m = M (1 - q) of 1: q sums, over the axes, the share of the gradient times the fall of |S| to
///   the upwind neighbor. Where |S| times the sum of the shares nears 1, c hardly shows in the
///   stored values; there M is the mean over the 27 voxels around, weighted 1, 2, 1 along each
///   axis, and so where M is above 0.3 to 0.5. From M = 0.7 to 1 c fades to 0: there psi
///   contradicts itself, as in folds that the conversion closed, and `unresolved` is to see them.
/// docs/trials.md#hollow-edges-of-conversions has the errors. Time O(voxels), in parallel; the same
/// values on any number of threads. Memory: a float per voxel of a leaf, meanwhile. Sets the
/// transient data of leaves.
///
/// @param dx  voxel size
Undone undoRenormalization(openvdb::FloatGrid& psi, double dx);

/// The same where psi in front of hollow edges is, to a thousandth of a voxel, what the step makes
/// of the planes of their faces; else none, and psi stays as it is.
std::optional<Undone> undoIfEdgesShow(openvdb::FloatGrid& psi, double dx);

}  // namespace igeo
