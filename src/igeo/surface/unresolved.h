/// Where the voxels do not show S: walls and gaps of about a voxel, and folds that were closed when
/// a level set was made.
#pragma once

#include <igeo/band/band.h>
#include <igeo/surface/level_set.h>
#include <igeo/surface/mesh_facts.h>

#include <optional>
#include <string>
#include <vector>

namespace igeo {

/// Shares of the core, in [0, 1]; none: a surface of this kind is not asked.
struct Unresolved {
    /// Level sets: a sheet that faces the other way is within 1.1 voxels, and a voxel may hold one
    /// of the two only.
    std::optional<double> thin;
    /// Level sets: within two voxels of a place where psi contradicts itself.
    std::optional<double> closed;
    std::optional<double> facing;  ///< meshes: facingShare
    std::optional<double> cutOff;  ///< meshes: Band::cutOff
    /// Closed meshes that do not cross themselves: eulerOnVoxels() less that of the mesh. 0: the
    /// voxels show all tunnels, gaps and parts.
    std::optional<int> eulerDifference;
};

/// The share of the core that a sheet faces within two voxels, so that a front there depends on
/// Band::linked. Time O(n).
double facingShare(const Band& band);

/// Half the distance to the nearest sheet that faces core node i, voxels; +infinity: none is near.
/// @param cosine  of the two normals, at most
double reachAt(const Band& band, NodeIndex i, float cosine = Band::kOtherSheet);

/// psi contradicts itself where it is a distance to no surface. The ball about a voxel with radius
/// |psi| holds no point of S, so the foot point of a voxel lies outside the balls of its neighbors.
/// Where every point at distance |psi| is inside one of them by 0.4 voxels, there is none: a fold
/// or gap of up to two voxels was closed, and the values between its banks were made up.
/// @param band  of all of the level set
/// Time O(n), in parallel; a search at the kinks of psi only.
Unresolved unresolvedOf(const LevelSet& levelSet, const Band& band);

/// Time O(n), in parallel.
Unresolved unresolvedOf(const MeshFacts& facts, const Band& band);

/// The Euler characteristic of the surface at which psi changes its sign from voxel to voxel,
/// voxels that share a corner being connected. Of a closed surface. Time O(n), in parallel.
int eulerOnVoxels(const Band& band);

/// A sentence for each share that makes distances unreliable, with what to do about it.
std::vector<std::string> unresolvedWarnings(const Unresolved& unresolved);

}  // namespace igeo
