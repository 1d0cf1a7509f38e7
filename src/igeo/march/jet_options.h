/// How scheme `jet` marches.
#pragma once

#include <igeo/band/surface_point.h>
#include <igeo/base/types.h>

#include <vector>

namespace igeo {

struct JetOptions {
    double startRadius = 3.5;        ///< arc-corrected chords within this radius of a seed, voxels
    double bucketWidth = 0.5;        ///< of a voxel: nodes solved and accepted together
    double maxDistance = kInfinity;  ///< stop beyond this distance, voxels times weight
    std::vector<SurfacePoint> stopAt;  ///< stop when d is known around all of these; empty: do not
    /// Per band node: the march covers d below this, and a few voxels more; null: all d.
    const std::vector<double>* below = nullptr;
    /// Whether to fill the field on the whole band. If not, the field holds the jets of the core
    /// (Field::core), and its readers find what they need of the rest.
    bool extend = true;
};

}  // namespace igeo
