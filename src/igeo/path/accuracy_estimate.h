/// An estimate of the error of a result, from the result.
#pragma once

#include <igeo/march/field.h>
#include <igeo/path/trace.h>

#include <cstddef>

namespace igeo {

/// An estimate from the result itself, not a bound.
struct AccuracyEstimate {
    std::size_t samples = 0;   ///< points at which the distance was compared with a geodesic
    double meanError = 0;      ///< mean of |d - length| / d
    double largestError = 0;   ///< largest of them
    double fallbackShare = 0;  ///< of the nodes solved: by the first-order fallback (jet)
};

/// Traces geodesics from `samples` nodes spread over the surface, straightens them, and compares
/// their lengths with the distances. Lengths have the small error of straighten() themselves, so
/// where the distances are better than that the estimate errs high. The error of psi
/// itself, against the surface it was made from, is no part of it. Time O(samples * length), in
/// parallel.
AccuracyEstimate estimateAccuracy(const Field& field, std::size_t samples = 8,
                                  Progress& progress = Progress::none());

}  // namespace igeo
