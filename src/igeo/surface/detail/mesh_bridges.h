/// Bridges between nodes that the mesh joins and links do not. Internal.
#pragma once

#include <igeo/surface/detail/mesh_links.h>

#include <vector>

namespace igeo {

/// Core nodes within a voxel of edges of three or more triangles, about one per voxel of the edge.
/// Time O(nodes * edges in a leaf), in parallel.
/// @param on  its core numbered
std::vector<NodeIndex> spineOfMesh(const MeshBand& on);

struct MeshBridges {
    std::vector<Bridge> bridges;
    std::vector<NodeIndex> spine;  ///< its nodes with jumps to such pages, ascending
};
/// Bridges between core nodes up to three steps apart that the mesh joins by a short walk, with no
/// path over one node in between: where sheets cross, or lie so close that other sheets take the
/// voxels. Jumps also lead from the spine to pages that have no nodes beside it.
/// @param on  its core numbered, links severed, spine set
MeshBridges bridgesOnMesh(const MeshBand& on, Progress& progress);

/// The share of core nodes that links and bridges do not join to the largest part of their
/// component, because the voxels are too large. 0 where no link is severed. Time O(n log n).
double shareCutOff(const MeshBand& on);

/// Each pair once, at most as many per node as a march stores; sorted.
std::vector<Bridge> thinned(std::vector<Bridge> bridges);

}  // namespace igeo
