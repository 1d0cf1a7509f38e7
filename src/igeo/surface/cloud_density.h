/// What is known of a cloud before a band is made of it.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace igeo {

/// How densely and how well points show their surface. Lengths in world units.
///
/// The spacing at a point is the side of the square it has for itself: sqrt(pi / 12) times the
/// distance to its 12th neighbor, which in a square lattice is its edge (within 3 %).
struct CloudDensity {
    std::size_t points = 0;      ///< distinct ones that are used
    std::size_t duplicates = 0;  ///< points left out because another has the same position
    std::size_t isolated = 0;    ///< left out: far from the others, or from the surface they show
    double spacing = 0;          ///< median
    double spacing99 = 0;        ///< percentile
    double noise = 0;            ///< scatter about the surface, root of the mean square
    std::size_t fitted = 0;      ///< points in a fit, more where there is noise
    std::size_t pieces = 0;      ///< of the surface, as far as neighbors connect them
    double conflicts = 0;  ///< share of neighbors whose normals disagree (Orientation, or normals
                           ///< in the file that are no normals of the surface)
    double largestCurvature = 0;  ///< 95th percentile, 1 / world length
};

/// What is odd about a cloud, a sentence each; empty for a good one.
std::vector<std::string> densityWarnings(const CloudDensity& density, const std::string& file);

}  // namespace igeo
