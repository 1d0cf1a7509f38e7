/// The local solve of scheme `jet`, alone: no grid, no states, no surface.
///
/// In the chart of a node it looks for the jet (value and gradient) at the origin that continues
/// its neighbors' jets, in three parts: the fronts that the neighbors belong to (jet_fronts.h), a
/// fit of each front (jet_fit.h), and a fallback where the fit is in doubt (fermat_update.h).
/// docs/method.md, "3. Local solve", has the thresholds.
#pragma once

#include <igeo/march/detail/fermat_update.h>
#include <igeo/march/detail/jet_fit.h>
#include <igeo/march/detail/jet_fronts.h>

namespace igeo {

namespace jet {

/// The least of the fits of one or two fronts, and how far it can be trusted.
struct FrontFits {
    Jet best;
    bool valid = true;          ///< no fit failed
    bool fromBothSides = true;  ///< no fit is an extrapolation where that makes a difference
    float doubt = 0;            ///< the largest residual

    /// Fits the front of neighbor k. The fit fails where its residual is large, or its value more
    /// than kSlack above the straight line from some neighbor.
    void tryFront(const JetNeighbors& all, const Fronts& fronts, int k) {
        constexpr float kResidual = 0.02f, kSlack = 1e-3f, kFocus = 0.2f;
        float residual = 0;
        const Jet fit = fitFront(all, all.g(k), residual);
        if (!(fit.u - all.base() <= double(fronts.bound + kSlack)) || residual > kResidual) {
            valid = false;
            return;
        }
        // Below all plane fronts: two neighbors always agree, however wrong.
        if (fit.u - all.base() < double(fronts.straight - kFocus)) doubt = kDoubt;
        doubt = std::max(doubt, residual);
        fromBothSides &= fit.fromBothSides || !all.rim;
        if (fit.u < best.u) best = fit;
    }
    bool certain(bool smooth) const { return valid && fromBothSides && smooth && doubt < kDoubt; }

private:
    static constexpr float kDoubt = 2e-3f;
};

/// Fits the front of the neighbor that carries the least value; where other neighbors belong to
/// another front (a cut locus) that may come first, fits theirs as well.
inline FrontFits fitFronts(const JetNeighbors& all) {
    constexpr double kLater = 0.2;
    const Fronts fronts(all);
    FrontFits fits;
    fits.tryFront(all, fronts, fronts.lead);
    const int second = fronts.second(all);
    if (second >= 0 && all.base() + double(fronts.carriedBy(second)) < fits.best.u + kLater)
        fits.tryFront(all, fronts, second);
    return fits;
}

}  // namespace jet

/// The jet at the origin: the least of the fits of its fronts. Where a fit is in doubt the fallback
/// is computed as well, and the fit counts if it is valid and the two agree within 0.01.
/// @return u = +inf without neighbors
inline Jet jetUpdate(const JetNeighbors& all) {
    constexpr double kAgree = 0.01;
    if (all.count() == 0) return {};
    const jet::FrontFits fits = jet::fitFronts(all);
    if (fits.certain(all.smooth)) return fits.best;
    const Jet fallback = fermatUpdate(all);
    // Extrapolated from one side: around a rim a front reaches the node by the last neighbor only.
    if (!fits.fromBothSides && all.smooth) return fallback;
    return fits.valid && std::abs(fits.best.u - fallback.u) < kAgree ? fits.best : fallback;
}

}  // namespace igeo
