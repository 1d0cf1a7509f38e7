/// What positions mean.
#pragma once

namespace igeo {

/// Lengths are in world units either way.
enum class Space {
    World,  ///< the surface's transform leads there
    Index   ///< multiples of the voxel size
};

}  // namespace igeo
