/// An estimate of the error of a result, computed from the result.
#pragma once

#include <igeo/base/fit_error.h>
#include <igeo/march/field.h>
#include <igeo/path/trace.h>

#include <cstddef>

namespace igeo {

/// An estimate, not a bound.
struct AccuracyEstimate {
    std::size_t samples = 0;  ///< points at which the distance was compared with a geodesic
    /// Mean of |d - length| / d, in which no sample counts more than samples / 2 times the median
    /// or than the third largest, over triangles the second: one or two that are far off change it
    /// little.
    double meanError = 0;
    double largestError = 0;  ///< maximum of |d - length| / d
    /// The mean error if all that scatters about S is scatter. Below meanError where it may be
    /// facets, as no points are close enough to each other to tell.
    double withoutFacets = 0;
    /// Share of the solved nodes that took the first-order fallback (jet)
    double fallbackShare = 0;
};

/// Traces geodesics from the foot points of nodes spread over the surface, straightens them, and
/// compares their lengths with the distances. On a mesh every second one starts from the vertex
/// nearest to such a point, or where triangles are large from a point between voxels: errors are
/// larger there. Lengths over sharp edges are those over both sheets, where voxels show these.
/// There are 64 over triangles, where lengths are exact and take little time, and errors differ
/// much from point to point; 16 elsewhere. Elsewhere the arcs of S count, not the chords of
/// straighten(). Both lack what S lacks of the true surface, so that is added; where the distance
/// is longer than the length and lacks less of it, the larger counts:
///  - Edges that voxels round off, or fits to points, as S shows them; or, where that is more, what
///    points show of shape that S lacks: beside the geodesics they are farther apart than their
///    foot points (stretchShown), or scatter that may be facets about as wide as their spacing,
///    unless points next to each other scatter alike.
///  - Scatter of points: where S lies e(s) too high along a geodesic of normal curvature k(s), the
///    geodesic is too long by the integral of k e to first order. Its standard deviation is the
///    root of `fit.heightNoise` times the integral of k^2.
/// Other errors of S are not included. Time O(length), in parallel.
/// @param fit  SurfaceFacts::fit
AccuracyEstimate estimateAccuracy(const Field& field, const FitError& fit = {},
                                  Progress& progress = Progress::none());

}  // namespace igeo
