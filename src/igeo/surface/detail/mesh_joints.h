/// Links between pieces of a mesh that do not touch. Internal.
#pragma once

#include <igeo/surface/detail/mesh_links.h>

#include <cstddef>
#include <vector>

namespace igeo {

struct MeshJoints {
    std::vector<Bridge> bridges;
    std::size_t pairs = 0;  ///< of components that they join; also of one with itself
};

/// Bridges over gaps up to `gap` voxels between components, and between two boundaries of one: from
/// every core node as close as that to another component, to the node of it that is nearest.
/// @throws Error  Cancelled through `progress`
/// Time O(n log n).
MeshJoints jointsOverGaps(const MeshBand& on, double gap, Progress& progress);

}  // namespace igeo
