/// By how much a surface that is fitted to scattered points is off the true one.
#pragma once

namespace igeo {

/// All zero: the surface is no fit.
struct FitError {
    /// Of scatter: the variance of the height of the fitted surface over the true one, times the
    /// length over which it varies; length^3
    double heightNoise = 0;
    double radius = 0;  ///< of the disc that the points of one fit cover; length
    /// Points per fit beyond the unknowns of the fit, as a share: 0 where it passes through all
    double freedom = 0;

    FitError scaled(double s) const { return {s * s * s * heightNoise, s * radius, freedom}; }
};

}  // namespace igeo
