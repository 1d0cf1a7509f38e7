/// Options of scheme `jet`.
#pragma once

#include <igeo/band/surface_point.h>
#include <igeo/base/types.h>

#include <vector>

namespace igeo {

struct JetOptions {
    double startRadius = 3.5;  ///< arc-corrected chords within this radius of a seed, voxels
    double bucketWidth = 0.5;  ///< of the distance, voxels: nodes solved and accepted together
    double maxDistance = kInfinity;  ///< stop beyond this distance, voxels times weight
    std::vector<NodeIndex> stopAt;   ///< stop when these nodes of the core are known (coreAround);
                                     ///< empty: no stop
    /// Per band node: the march covers distances below this, and some voxels more; null: all.
    const std::vector<double>* below = nullptr;
    /// Whether to fill the field on the whole band. If false, the field has only the jets of the
    /// core (Field::core), and its readers compute the rest from them.
    bool extend = true;
};

}  // namespace igeo
