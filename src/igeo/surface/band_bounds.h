/// The allowed widths of the band, and the best one.
#pragma once

#include <cmath>
#include <string>

namespace igeo {

struct LevelSetStats;

/// M&S (14) in voxels: sqrt(3) <= h < min(1 / M_S, W).
struct BandBounds {
    /// sqrt(3), so that all corners of all cells that S passes are in the band; more for balls
    /// around points, which must overlap
    double lower;
    double upper;                ///< h must be less; never below `lower`
    std::string why;             ///< what sets `upper`, for messages
    bool resolved;               ///< false: S bends or folds within `lower`, so (14) cannot be met
    double unresolvedShare = 0;  ///< of S: where it does
};

/// @param largestCurvature M_S, per voxel (LevelSetStats::largestCurvature); 0: flat
/// @param reach            W, voxels (LevelSetStats::reach)
/// @param halfWidth        how far psi is known, voxels: W is not known beyond it
/// @param lower            lower bound of h, voxels
BandBounds bandBounds(double largestCurvature, double reach, double halfWidth,
                      double lower = std::sqrt(3.0));
BandBounds bandBounds(const LevelSetStats& stats);

/// The half-width, voxels, at which the error of `godunov` is least: max(sqrt(3), (R/dx)^e), R =
/// 1/M_S, within the bounds.
///
/// In a narrower band, fronts miss upwind neighbors at its edge, and distances are too long. In a
/// wider band, paths take shortcuts through it, and distances are too short, by order h times
/// curvature. At order 1 both errors are large and cancel best for e = 0.3; at order 2 the first is
/// small and e = 0.12 is best (docs/trials.md).
/// @param order of godunov, 1 or 2
double defaultBandWidth(int order, double largestCurvature, const BandBounds& bounds);

/// Returns `h` if M&S (14) holds.
/// @param h  given, voxels
/// @param dx voxel size, for the message
/// @throws Error  InvalidArgument that states the allowed range in world units and voxels
double requireBandWidth(double h, const BandBounds& bounds, double dx);

}  // namespace igeo
