#include <igeo/march/detail/jet_update.h>

#include <igeo/march/detail/fermat_update.h>

#include <algorithm>
#include <bit>

namespace igeo {

namespace {

/// So near to the fallback a fit has to be where it is in doubt.
constexpr float kAgree = 0.01f;
/// So far below it over creases: along a rim that bends, a fit lets the front cut the bend.
constexpr float kBelowOverCrease = 0.002f;

/// How far a fit may be below the fallback.
constexpr float mostBelow(bool smooth) { return smooth ? kAgree : kBelowOverCrease; }

/// Whether a fit agrees with the fallback for certain.
bool surelyAgrees(float u, const FermatBounds& bounds, std::size_t lane, bool smooth) {
    constexpr float kRounding = 1e-3f;
    return bounds.least[lane] > u - (kAgree - kRounding) &&
           bounds.most[lane] < u + (mostBelow(smooth) - kRounding);
}

}  // namespace

/// The fronts of the nodes of a group, and the fits of one or two of them.
struct JetGroup::Fits {
    JetFronts fronts;
    JetFits first, second;
    JetVerdicts verdicts;

    /// Fits the front of the neighbor that carries the least value; where other neighbors belong to
    /// another front (a cut locus) that may come first, fits theirs as well.
    explicit Fits(const JetLanes& lanes) {
        findFronts(lanes, fronts);
        fitFronts(lanes, fronts.leadX, fronts.leadY, first);
        verdicts = judge(fronts, first);
        if (!verdicts.second) return;
        Lanes x{}, y{};
        for (std::size_t k = 0; k < Lanes::kNodes; ++k)
            if (hasSecond(k)) x[k] = fronts.secondX[k], y[k] = fronts.secondY[k];
        fitFronts(lanes, x, y, second);
    }
    bool hasSecond(std::size_t k) const { return verdicts.second >> k & 1; }
    bool isClear(std::size_t k) const { return verdicts.clear >> k & 1; }
};

/// The least of the fits of a node, and how far it can be trusted.
struct JetGroup::BestFit {
    Solution best;
    bool valid = true;          ///< no fit failed
    bool fromBothSides = true;  ///< no fit is an extrapolation
    bool clear = true;          ///< no reason for doubt
    bool counts = true;         ///< it is no extrapolation at a rim
    bool final = true;          ///< it needs no fallback
    bool mayCount = false;      ///< it counts if the fallback agrees

    /// Takes a fit. It fails where its residual is large, or its value more than kSlack above the
    /// straight line from some neighbor.
    void add(const JetFits& fits, const JetFronts& fronts, std::size_t k) {
        constexpr float kResidual = 0.02f;
        const float u = fits.u[k], residual2 = fits.residual2[k];
        if (!(u <= fronts.bound[k] + jet::kSlack) || residual2 > kResidual * kResidual) {
            valid = false;
            return;
        }
        clear &= u >= fronts.straight[k] - jet::kFocus && residual2 < jet::kDoubt * jet::kDoubt;
        fromBothSides &= !(fits.oneSided[k] > 0);
        if (u < best.u) best.u = u, best.g = {fits.gx[k], fits.gy[k]};
    }
};

JetGroup::Solutions JetGroup::solve() {
    if (!filled_) closeLanes(), lanes_.pad();
    const Fits fits(lanes_);
    Solutions solutions;
    unsigned doubts = 0;
    for (std::size_t k = 0; k < size_; ++k)
        if (fits.isClear(k) && nodes_[k].smooth && nodes_[k].oneSource)
            solutions[k] = {fits.first.u[k], {fits.first.gx[k], fits.first.gy[k]}, sources_[k][0]};
        else
            doubts |= 1u << k;
    if (doubts) solveDoubtful(fits, doubts, solutions);
    return solutions;
}

void JetGroup::solveDoubtful(const Fits& fits, unsigned doubts, Solutions& solutions) const {
    std::array<BestFit, Lanes::kNodes> best;
    unsigned inFallback = 0;
    Lanes longest2{};
    for (; doubts; doubts &= doubts - 1) {
        const auto k = std::size_t(std::countr_zero(doubts));
        if (!nodes_[k].oneSource) {
            solutions[k] = solvePerSource(k);
        } else if (best[k] = bestFit(k, fits); best[k].final) {
            solutions[k] = best[k].best;
        } else {
            if (best[k].mayCount) longest2[k] = nodes_[k].longest2;
            inFallback |= 1u << k;
        }
    }
    if (!inFallback) return;
    FermatBounds bounds;
    boundFallbacks(lanes_, longest2, bounds);
    for (unsigned left = inFallback; left; left &= left - 1) {
        const auto k = std::size_t(std::countr_zero(left));
        if (best[k].mayCount && surelyAgrees(best[k].best.u, bounds, k, nodes_[k].smooth))
            solutions[k] = best[k].best, inFallback &= ~(1u << k);
    }
    if (!inFallback) return;
    FermatGroup fallback;
    for (unsigned left = inFallback; left; left &= left - 1) {
        const auto k = std::size_t(std::countr_zero(left));
        fallback.add(k, lanes_, nodes_[k].longest2);
    }
    fallback.finish();
    for (; inFallback; inFallback &= inFallback - 1) {
        const auto k = std::size_t(std::countr_zero(inFallback));
        solutions[k] = decide(k, best[k], fallback);
    }
}

JetGroup::Solution JetGroup::solveAtRim(std::size_t lane) {
    nodes_[lane].rim = true;
    if (!nodes_[lane].oneSource) return solvePerSource(lane);
    const BestFit fit = bestFit(lane, Fits(lanes_));
    if (fit.final) return fit.best;
    FermatGroup fallback;
    fallback.add(lane, lanes_, nodes_[lane].longest2);
    fallback.finish();
    return decide(lane, fit, fallback);
}

JetGroup::BestFit JetGroup::bestFit(std::size_t lane, const Fits& fits) const {
    const Node& node = nodes_[lane];
    BestFit fit;
    if (lanes_.count[lane] == 0) return fit;
    fit.best.source = sources_[lane][0];
    fit.best.frontsMeet = fits.hasSecond(lane) || fits.first.turn[lane] > FrontsMeet::kTurn;
    fit.add(fits.first, fits.fronts, lane);
    if (fits.hasSecond(lane)) fit.add(fits.second, fits.fronts, lane);
    fit.counts = fit.fromBothSides || !node.rim;
    fit.best.oneSided = !fit.fromBothSides && node.smooth;
    fit.final = fit.valid && fit.counts && fit.clear && node.smooth;
    fit.mayCount = fit.valid && (fit.counts || !node.smooth);
    return fit;
}

JetGroup::Solution JetGroup::decide(std::size_t lane, const BestFit& fit,
                                    const FermatGroup& fallback) const {
    const float u = lanes_.neighbor[0].u[lane] + fallback.u(lane);
    if (fit.mayCount && fit.best.u - u < kAgree && u - fit.best.u < mostBelow(nodes_[lane].smooth))
        return fit.best;
    FrontsMeet fronts(fallback.g(lane));
    for (std::size_t k = 0; k < lanes_.count[lane]; ++k) fronts.add(lanes_.at(lane, k));
    return {u,     fallback.g(lane),      fit.best.source,    true, fronts.meet(),
            false, fallback.detour(lane), fallback.ends(lane)};
}

JetGroup::Solution JetGroup::solvePerSource(std::size_t lane) const {
    const std::uint32_t count = lanes_.count[lane];
    std::array<std::uint32_t, JetLanes::kMax> sources = sources_[lane];
    std::sort(sources.begin(), sources.begin() + count);
    const auto end = std::unique(sources.begin(), sources.begin() + count);
    Solution best;
    JetGroup parts;
    parts.clear(lanes_.pull);
    std::array<std::array<std::uint8_t, JetLanes::kMax>, Lanes::kNodes> number;  // here, of theirs
    for (auto at = sources.begin(); at != end; ++at) {
        parts.begin(lanes_.base[lane], nodes_[lane].longest2);
        for (std::size_t k = 0; k < count; ++k)
            if (const JetNeighbor n = lanes_.at(lane, k); sources_[lane][k] == *at) {
                number[parts.size() - 1][parts.count()] = std::uint8_t(k);
                parts.add(n.a, n.g, float(n.u), *at, !nodes_[lane].smooth);
            }
        parts.nodes_[parts.size_ - 1].rim = nodes_[lane].rim;
        if (!parts.full() && at + 1 != end) continue;
        Solutions solutions = parts.solve();
        bool oneSided = best.oneSided;
        for (std::size_t k = 0; k < parts.size(); ++k) {
            oneSided |= solutions[k].oneSided;
            for (std::uint8_t& of : solutions[k].ends) of = number[k][of];
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
