#include <igeo/march/detail/jet_update.h>

#include <igeo/march/detail/fermat_update.h>

#include <algorithm>

namespace igeo {

/// The fronts of the nodes of a group, and the fits of one or two of them.
struct JetGroup::Fits {
    JetFronts fronts;
    JetFits first, second;
    std::array<bool, Lanes::kNodes> hasSecond{};

    /// Fits the front of the neighbor that carries the least value; where other neighbors belong to
    /// another front (a cut locus) that may come first, fits theirs as well.
    explicit Fits(const JetLanes& lanes) {
        constexpr float kLater = 0.2f;
        findFronts(lanes, fronts);
        fitFronts(lanes, fronts.leadX, fronts.leadY, first);
        bool any = false;
        Lanes x{}, y{};
        for (std::size_t k = 0; k < Lanes::kNodes; ++k) {
            if (!(fronts.second[k] < JetFronts::kNoValue) ||
                fronts.second[k] >= orInfinity(first.u[k]) + kLater)
                continue;
            x[k] = fronts.secondX[k], y[k] = fronts.secondY[k];
            any = hasSecond[k] = true;
        }
        if (any) fitFronts(lanes, x, y, second);
    }
    static float orInfinity(float u) { return u < float(kInfinity) ? u : float(kInfinity); }
};

namespace {

/// The least of the fits of a node, and how far it can be trusted.
struct BestFit {
    JetGroup::Solution best;
    bool valid = true;          ///< no fit failed
    bool fromBothSides = true;  ///< no fit is an extrapolation
    bool clear = true;          ///< no reason for doubt

    /// Takes a fit. It fails where its residual is large, or its value more than kSlack above the
    /// straight line from some neighbor.
    void add(const JetFits& fits, const JetFronts& fronts, std::size_t k) {
        constexpr float kResidual = 0.02f, kDoubt = 2e-3f, kSlack = 1e-3f, kFocus = 0.2f;
        const float u = fits.u[k], residual2 = fits.residual2[k];
        if (!(u <= fronts.bound[k] + kSlack) || residual2 > kResidual * kResidual) {
            valid = false;
            return;
        }
        // Below all plane fronts: two neighbors always agree, however wrong.
        clear &= u >= fronts.straight[k] - kFocus && residual2 < kDoubt * kDoubt;
        fromBothSides &= !(fits.oneSided[k] > 0);
        if (u < best.u) best.u = u, best.g = {fits.gx[k], fits.gy[k]};
    }
};

bool frontsMeet(const JetNeighbors& all, Vec2f g) {
    FrontsMeet fronts(g);
    for (int k = 0; k < all.count(); ++k) fronts.add({all.a(k), all.g(k)});
    return fronts.meet();
}

}  // namespace

JetGroup::Solutions JetGroup::solve() {
    for (std::size_t k = size_; k < Lanes::kNodes; ++k) lanes_.count[k] = 0, lanes_.base[k] = 0;
    lanes_.pad();
    const Fits fits(lanes_);
    Solutions solutions;
    for (std::size_t k = 0; k < size_; ++k)
        solutions[k] = nodes_[k].oneSource ? settle(k, fits) : solvePerSource(k);
    return solutions;
}

JetGroup::Solution JetGroup::solveAtRim(std::size_t lane) {
    nodes_[lane].rim = true;
    return nodes_[lane].oneSource ? settle(lane, Fits(lanes_)) : solvePerSource(lane);
}

JetGroup::Solution JetGroup::settle(std::size_t lane, const Fits& fits) const {
    constexpr float kAgree = 0.01f;
    const Node& node = nodes_[lane];
    if (lanes_.count[lane] == 0) return {};
    BestFit fit;
    fit.best.source = sources_[lane][0];
    fit.best.frontsMeet = fits.hasSecond[lane] || fits.first.turn[lane] > FrontsMeet::kTurn;
    fit.add(fits.first, fits.fronts, lane);
    if (fits.hasSecond[lane]) fit.add(fits.second, fits.fronts, lane);
    const bool counts = fit.fromBothSides || !node.rim;
    fit.best.oneSided = !fit.fromBothSides && node.smooth;
    if (fit.valid && counts && fit.clear && node.smooth) return fit.best;
    const JetNeighbors neighbors = neighborsOf(lane);
    const Jet jet = fermatUpdate(neighbors);
    const Solution fallback{float(jet.u), jet.g, fit.best.source, true,
                            frontsMeet(neighbors, jet.g)};
    if (!counts && node.smooth) return fallback;
    return fit.valid && std::abs(fit.best.u - fallback.u) < kAgree ? fit.best : fallback;
}

JetNeighbors JetGroup::neighborsOf(std::size_t lane) const {
    JetNeighbors all;
    all.longest2 = nodes_[lane].longest2;
    for (std::size_t k = 0; k < lanes_.count[lane]; ++k) all.add(lanes_.at(lane, k));
    return all;
}

JetGroup::Solution JetGroup::solvePerSource(std::size_t lane) const {
    const std::uint32_t count = lanes_.count[lane];
    std::array<std::uint32_t, JetLanes::kMax> sources = sources_[lane];
    std::sort(sources.begin(), sources.begin() + count);
    const auto end = std::unique(sources.begin(), sources.begin() + count);
    Solution best;
    JetGroup parts;
    parts.clear(lanes_.pull);
    for (auto at = sources.begin(); at != end; ++at) {
        parts.begin(lanes_.base[lane], nodes_[lane].longest2);
        for (std::size_t k = 0; k < count; ++k)
            if (const JetNeighbor n = lanes_.at(lane, k); sources_[lane][k] == *at)
                parts.add(n.a, n.g, float(n.u), *at, !nodes_[lane].smooth);
        parts.nodes_[parts.size_ - 1].rim = nodes_[lane].rim;
        if (!parts.full() && at + 1 != end) continue;
        const Solutions solutions = parts.solve();
        bool oneSided = best.oneSided;
        for (std::size_t k = 0; k < parts.size(); ++k) {
            oneSided |= solutions[k].oneSided;
            if (solutions[k].u < best.u) best = solutions[k];
        }
        best.oneSided = oneSided;
        parts.clear(lanes_.pull);
    }
    return best;
}

Jet jetUpdate(const JetNeighbors& all) {
    JetGroup group;
    group.clear();
    group.begin(float(all.base()), all.longest2);
    for (int k = 0; k < all.count(); ++k) group.add(all.a(k), all.g(k), all.u(k), 0, false);
    const JetGroup::Solution s = group.solve()[0];
    return {all.base() + double(s.u), s.g, s.usedFallback};
}

}  // namespace igeo
