/// Costs from curvature, as options: the curvature itself is computed later.
#pragma once

#include <igeo/metric/curvature.h>

namespace igeo {

/// A weight made from curvature (curvatureWeights).
struct CurvatureWeight {
    CurvatureKind kind = CurvatureKind::Valley;
    double epsilon = kDefaultCurvatureEpsilon, power = kDefaultCurvaturePower;

    bool operator==(const CurvatureWeight&) const = default;
};

/// A tensor made from the principal curvatures (curvatureTensor).
struct BendingCost {
    Bending bending = Bending::Avoid;
    double length = 0;  ///< L, world units; 0: kCurvatureUnit voxels

    bool operator==(const BendingCost&) const = default;
};

}  // namespace igeo
