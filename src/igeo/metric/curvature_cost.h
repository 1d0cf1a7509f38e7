/// Costs made of curvature, before it is known.
#pragma once

#include <igeo/metric/curvature.h>

namespace igeo {

/// A weight made of curvature (curvatureWeights).
struct CurvatureWeight {
    CurvatureKind kind = CurvatureKind::Valley;
    double epsilon = kDefaultCurvatureEpsilon, power = kDefaultCurvaturePower;

    bool operator==(const CurvatureWeight&) const = default;
};

/// A tensor made of the principal curvatures (curvatureTensor).
struct BendingCost {
    Bending bending = Bending::Avoid;
    double length = 0;  ///< L, world units; 0: kCurvatureUnit voxels

    bool operator==(const BendingCost&) const = default;
};

}  // namespace igeo
