/// By how much a surface that is fitted to scattered points is off the true one.
#pragma once

#include <igeo/base/point_tree.h>

#include <memory>

namespace igeo {

/// All zero: the surface is no fit.
struct FitError {
    /// Of scatter: the variance of the height of the fitted surface over the true one, times the
    /// length over which it varies; length^3
    double heightNoise = 0;
    double spacing = 0;  ///< of the points; length
    double radius = 0;   ///< of the disc that the points of one fit cover; length
    /// Points per fit beyond the unknowns of the fit and the one in its middle, as a share
    double freedom = 0;
    std::shared_ptr<const PointTree> points = nullptr;  ///< that it is fitted to, world units

    FitError scaled(double s) const {
        return {s * s * s * heightNoise, s * spacing, s * radius, freedom, points};
    }
};

}  // namespace igeo
