/// By how much scattered points are farther apart than their foot points. Internal.
#pragma once

#include <igeo/band/band.h>
#include <igeo/base/fit_error.h>
#include <igeo/path/path.h>

#include <array>
#include <vector>

namespace igeo {

/// Sums over pairs of points beside one geodesic. With the points p, p', their foot points q, q' on
/// S, and h = |q - q'|, lengths in spacings, least squares give
///
///     (|p - p'|^2 - |q - q'|^2) / 2 = scatter^2 + stretch h^2 + bend h^3.
///
/// Where points show shape that S lacks, their surface is longer by the share `stretch`. Scatter is
/// independent from point to point, so it remains as h goes to 0. The slope of facets jumps, which
/// takes a term in h^3. `stretch` is a quadratic form of the direction: pairs at an angle a with
/// the geodesic count by 1 + 2 cos(2 a), which makes it that along the geodesic.
struct PointStretch {
    std::array<std::array<double, 3>, 3> matrix{};  ///< the normal equations
    std::array<double, 3> right{};
    /// Pairs: how many, and sums of a square and of h^2.
    struct Pairs {
        double count = 0, squares = 0, apart2 = 0;

        void add(double square, double h2);
        void add(const Pairs& pairs, double times);
        double mean() const { return squares / count; }
    };
    /// Of very near, near and far pairs: the differences of their heights over S. Those of scatter
    /// are as large for all, those of shape small for near ones.
    Pairs closest, close, wide;
    Pairs turned;  ///< of far pairs: the turn of the normal of S per spacing

    void add(const PointStretch& sums, double times);
    double stretch() const;
    /// Whether the heights are shape, not scatter, beyond chance.
    bool isShape() const;
    /// Whether they are scatter, not shape, beyond chance.
    bool isScatter() const;
    /// Whether they are shape that changes within a spacing, and very near pairs show its slopes.
    bool isNarrow() const;
};

/// @param path  with normals
/// @param fit   with points
/// Time O(length).
PointStretch stretchAlong(const Band& band, const Path& path, const FitError& fit);

/// The stretch along all geodesics together, 0 where it is scatter or below two standard errors.
/// These come from leaving out one geodesic after the other (jackknife). Where shape is narrow, far
/// pairs pass over it, and half the mean square of its slopes counts, as very near pairs show it.
double stretchShown(const std::vector<PointStretch>& geodesics);

}  // namespace igeo
