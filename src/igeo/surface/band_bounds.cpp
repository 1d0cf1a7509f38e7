#include <igeo/surface/band_bounds.h>

#include <fmt/core.h>
#include <igeo/base/error.h>
#include <igeo/surface/level_set.h>

#include <algorithm>
#include <cmath>

namespace igeo {

namespace {

// Flat surfaces have no largest curvature; no band of a real grid is wider than this.
constexpr double kLargestRadius = 1e6;

}  // namespace

BandBounds bandBounds(double largestCurvature, double reach, double halfWidth, double lower) {
    BandBounds b;
    b.lower = lower;
    const double radius = largestCurvature > 0 ? 1 / largestCurvature : kLargestRadius;
    b.upper = std::min(radius, kLargestRadius);
    b.why = "the surface's smallest radius of curvature";
    if (reach < halfWidth && reach < b.upper) {
        b.upper = reach;
        b.why = "the distance at which two sheets of the surface meet";
    }
    b.resolved = b.upper > b.lower;
    b.upper = std::max(b.upper, b.lower);
    return b;
}

BandBounds bandBounds(const LevelSetStats& stats) {
    BandBounds b = bandBounds(stats.largestCurvature, stats.reach, stats.halfWidth);
    b.unresolvedShare = stats.unresolvedShare;
    return b;
}

double defaultBandWidth(int order, double largestCurvature, const BandBounds& bounds) {
    const double radius = largestCurvature > 0 ? 1 / largestCurvature : kLargestRadius;
    // Beyond 6 voxels (R/dx = 400) trials show only cost and no gain.
    const double best = std::min(std::pow(radius, order == 1 ? 0.3 : 0.12), 6.0);
    // h stays strictly below the upper bound.
    return std::max(bounds.lower, std::min(best, 0.999 * bounds.upper));
}

double requireBandWidth(double h, const BandBounds& bounds, double dx) {
    // Accepts sqrt(3) dx typed with a few digits: Band itself takes any h.
    constexpr double kRounding = 1e-3;
    if (h >= bounds.lower - kRounding && (h < bounds.upper || h <= bounds.lower + kRounding))
        return std::max(h, bounds.lower);
    throw Error(
        Error::Kind::InvalidArgument,
        fmt::format("a band of h = {:.6g} ({:.4g} voxels) is outside the bounds of M&S (14): at "
                    "least {:.6g} ({}) and below {:.6g} ({:.4g} voxels), {}",
                    h * dx, h, bounds.lower * dx,
                    bounds.lower == std::sqrt(3.0) ? "sqrt(3) voxels" : "so that balls overlap",
                    bounds.upper * dx, bounds.upper, bounds.why),
        bounds.resolved
            ? "leave SolverOptions::band out for the best width within the bounds"
            : "the voxels resolve no wider band: leave SolverOptions::band out, or take smaller "
              "voxels");
}

}  // namespace igeo
