/// Where the voxels do not resolve S: walls and gaps of about a voxel, and folds that the
/// conversion to a level set has closed.
#pragma once

#include <igeo/band/band.h>
#include <igeo/surface/level_set.h>
#include <igeo/surface/mesh_facts.h>

#include <optional>
#include <string>
#include <vector>

namespace igeo {

/// Shares of the core, in [0, 1]; empty where they do not apply.
struct Unresolved {
    /// Level sets: a sheet that is opposed within 26 degrees is within 1.1 voxels, where a voxel
    /// may represent only one of the two.
    std::optional<double> thin;
    /// Level sets: within two voxels of a contradiction in psi.
    std::optional<double> closed;
    /// Level sets that OpenVDB made from a mesh, or may have made, as values in half precision do
    /// not tell: another sheet, opposed within 45 degrees, lies outside within 2.3 voxels. In such
    /// gaps the conversion may give voxels the sign of the inside, which leaves a neck from sheet
    /// to sheet.
    std::optional<double> gap;
    bool halfPrecision = false;    ///< LevelSetStats::halfPrecision: nothing tells
    std::optional<double> facing;  ///< meshes: facingShare
    /// Meshes: Band::cutOff. Level sets: nodes that no front reaches, in groups of at most eight,
    /// as the links to all nodes beside them are cut
    std::optional<double> cutOff;
    /// Closed meshes that do not cross themselves: eulerOnVoxels() minus that of the mesh. 0: the
    /// voxels resolve all tunnels, gaps and components.
    std::optional<int> eulerDifference;
};

/// The share of the core that a sheet faces within two voxels, opposed within 26 degrees, so that a
/// front there depends on Band::linked. Time O(n).
double facingShare(const Band& band);

/// Half the distance to the nearest sheet that faces core node i, voxels; +infinity: none near.
double reachAt(const Band& band, NodeIndex i);

/// psi contradicts itself where it is a distance to no surface. The ball around a voxel with radius
/// |psi| contains no point of S, so the foot point of a voxel lies outside the balls of its
/// neighbors. Where every point at distance |psi| is inside one of them by 0.4 voxels, there is no
/// foot point: where normals within two voxels differ by more than 120 degrees, a fold or gap of up
/// to two voxels was closed, and the values between its walls are invented. Elsewhere psi is that
/// of a union, beside its hollow edges.
/// @param band  of all of the level set
/// Time O(n), in parallel; searches only at kinks of psi.
Unresolved unresolvedOf(const LevelSet& levelSet, const Band& band);

/// Time O(n), in parallel.
Unresolved unresolvedOf(const MeshFacts& facts, const Band& band);

/// The Euler characteristic of the surface where psi changes sign between voxels; voxels that share
/// a corner are connected. For closed surfaces. Time O(n), in parallel.
int eulerOnVoxels(const Band& band);

/// A sentence for each share that makes distances unreliable, with a remedy.
std::vector<std::string> unresolvedWarnings(const Unresolved& unresolved);

}  // namespace igeo
