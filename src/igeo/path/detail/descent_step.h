/// Steps of a path down the gradient of a distance. Internal to the paths.
#pragma once

#include <igeo/march/field.h>

namespace igeo {

struct StepLimits {
    double least, most, error;  ///< voxels; error: of one step
};

/// One accepted Runge-Kutta step from p, projected, or a slide where an obstacle is ahead.
/// @param sheetNormal  of the sheet of the path
/// @return false if the step would be below the least
bool stepDown(const Field& field, const StepLimits& limits, const Vec3d& sheetNormal, Vec3d& p,
              double& step);

}  // namespace igeo
