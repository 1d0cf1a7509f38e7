/// Facts about a point cloud, before a band is made from it.
#pragma once

#include <igeo/base/fit_error.h>

#include <cstddef>
#include <string>
#include <vector>

namespace igeo {

/// How densely and how accurately points sample their surface. Lengths in world units.
///
/// The spacing at a point is the side of the square that it represents: sqrt(pi / 12) times the
/// distance to its 12th neighbor. In a square lattice that is its edge (within 3 %).
struct CloudDensity {
    std::size_t points = 0;      ///< distinct points that are used
    std::size_t duplicates = 0;  ///< points left out because another has the same position
    /// Dropped: far from the others, or from the surface of their neighbors
    std::size_t isolated = 0;
    double spacing = 0;       ///< median
    double spacing99 = 0;     ///< percentile
    double noise = 0;         ///< scatter around the surface, root mean square
    std::size_t fitted = 0;   ///< points per fit, more where there is noise
    std::size_t pieces = 0;   ///< components of the surface, connected through neighbors
    bool hasNormals = false;  ///< given with the points
    /// Share of the points with given normals more than 60 degrees off the surface
    double conflicts = 0;
    /// Share of the points beside which normals turn to the other side of the surface, and how long
    /// the longest line of these is: the surface is one-sided, or the given normals are not turned
    /// to one side.
    double turned = 0, seam = 0;
    double facing = 0;  ///< share of points with one on another sheet within three spacings
    double largestCurvature = 0;  ///< 95th percentile, 1 / world length

    /// By how much the fitted surface may be off. A fit has six unknowns, and its `fitted` points
    /// fill a disc, over which scatter is averaged. World lengths.
    FitError fitError() const;
};

/// Warnings about a cloud, a sentence each; empty for a good one.
std::vector<std::string> densityWarnings(const CloudDensity& density, const std::string& file);

}  // namespace igeo
