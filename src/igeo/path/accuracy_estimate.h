/// An estimate of the error of a result, computed from the result.
#pragma once

#include <igeo/march/field.h>
#include <igeo/path/trace.h>

#include <cstddef>

namespace igeo {

/// An estimate, not a bound.
struct AccuracyEstimate {
    std::size_t samples = 0;  ///< points at which the distance was compared with a geodesic
    double meanError = 0;     ///< mean of |d - length| / d
    double largestError = 0;  ///< maximum of |d - length| / d
    /// Share of the solved nodes that took the first-order fallback (jet)
    double fallbackShare = 0;
};

/// Traces geodesics from the foot points of `samples` nodes spread over the surface, straightens
/// them, and compares their lengths with the distances. On a mesh every second one starts from the
/// vertex nearest to such a point, where errors are largest. The lengths have the small error of
/// straighten(); where the distances are more accurate than that, the estimate is too high. It does
/// not include the error of psi against the surface that psi was made from. Time O(samples *
/// length), in parallel.
AccuracyEstimate estimateAccuracy(const Field& field, std::size_t samples = 8,
                                  Progress& progress = Progress::none());

}  // namespace igeo
