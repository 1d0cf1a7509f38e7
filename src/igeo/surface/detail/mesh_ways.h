/// Lines of a mesh's band, where voxels cannot hold its folds. Internal.
#pragma once

#include <igeo/band/detail/mesh_ways.h>
#include <igeo/base/progress.h>
#include <igeo/surface/detail/mesh_links.h>

#include <vector>

namespace igeo {

/// Core nodes beside folds whose links and bridges leave a sector open in which the mesh goes on:
/// other folds take the voxels there. And those at necks narrower than voxels and at corners of
/// rims: shortest paths bend around the vertices there. Ascending.
/// @param on  its core numbered, links severed, bridges set
std::vector<NodeIndex> openOnMesh(const MeshBand& on, Progress& progress);

/// Links between open nodes that are not as long as the mesh between their ends.
std::vector<Link> inexactLinks(const MeshBand& on, const std::vector<NodeIndex>& open);

/// The straight lines from open nodes to the nearest core nodes in each direction, and lines that
/// go around vertices.
/// Time O(open nodes * triangles within reach), in parallel.
MeshWays waysOnMesh(const MeshBand& on, const std::vector<NodeIndex>& open, Progress& progress);

}  // namespace igeo
