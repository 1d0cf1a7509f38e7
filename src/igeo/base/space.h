/// The space of given positions.
#pragma once

namespace igeo {

/// Lengths are in world units in both cases.
enum class Space {
    World,  ///< world space: the surface's transform applied to index space
    Index   ///< multiples of the voxel size
};

}  // namespace igeo
