/// Links between components of a mesh that do not touch. Internal.
#pragma once

#include <igeo/surface/detail/mesh_bridges.h>

#include <cstddef>
#include <vector>

namespace igeo {

struct MeshJoints {
    std::vector<Bridge> bridges;
    /// Number of pairs of components that they join; also of one with itself
    std::size_t pairs = 0;
};

/// Bridges over gaps up to `gap` voxels between components, and between two boundaries of one: from
/// every core node that close to another component, to its nearest nodes there. Between
/// components they are as long as the path along the mesh to the gap, straight across, and along
/// the mesh.
/// @throws Error  Cancelled through `progress`
/// Time O(n log n).
MeshJoints jointsOverGaps(const MeshBand& on, double gap, Progress& progress);

}  // namespace igeo
