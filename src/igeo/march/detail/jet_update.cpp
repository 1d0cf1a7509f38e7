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
    return bounds.least[lane] > u - (kAgree - FermatBounds::kRounding) &&
           bounds.most[lane] < u + (mostBelow(smooth) - FermatBounds::kRounding);
}

}  // namespace

/// Fits the front of the neighbor that carries the least value; where other neighbors belong to
/// another front (a cut locus) that may come first, fits theirs as well.
void JetGroup::Fits::find(const JetLanes& lanes) {
    findFronts(lanes, fronts);
    fitFronts(lanes, fronts.leadX, fronts.leadY, first);
    verdicts = judge(fronts, first);
    if (!verdicts.second) return;
    Lanes x{}, y{};
    for (std::size_t k = 0; k < Lanes::kNodes; ++k)
        if (hasSecond(k)) x[k] = fronts.secondX[k], y[k] = fronts.secondY[k];
    fitFronts(lanes, x, y, second);
}

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
        const float u = fits.u[k], residual2 = fits.residual2[k];
        if (!(u <= fronts.bound[k] + jet::kSlack) || residual2 > jet::kResidual * jet::kResidual) {
            valid = false;
            return;
        }
        clear &= u >= fronts.straight[k] - jet::kFocus && residual2 < jet::kDoubt * jet::kDoubt;
        fromBothSides &= !(fits.oneSided[k] > 0);
        if (u < best.u) best.u = u, best.g = {fits.gx[k], fits.gy[k]};
    }
};

void JetGroup::fit() {
    if (!filled_) closeLanes(), lanes_.pad();
    fits_.find(lanes_);
    fitted_ = true;
}

JetGroup::Solutions JetGroup::solve() {
    fit();
    Solutions solutions;
    unsigned doubts = 0;
    for (std::size_t k = 0; k < size_; ++k)
        if (fits_.isClear(k) && nodes_[k].smooth && nodes_[k].oneSource)
            solutions[k] = {
                fits_.first.u[k], {fits_.first.gx[k], fits_.first.gy[k]}, sources_[k][0]};
        else
            doubts |= 1u << k;
    if (doubts) solveDoubtful(doubts, solutions);
    return solutions;
}

void JetGroup::solveDoubtful(unsigned doubts, Solutions& solutions) const {
    BestFits best;
    unsigned inFallback = 0;
    Lanes longest2{};
    for (; doubts; doubts &= doubts - 1) {
        const auto k = std::size_t(std::countr_zero(doubts));
        if (!nodes_[k].oneSource) {
            solutions[k] = solvePerSource(k);
        } else if (best[k] = bestFit(k); best[k].final) {
            solutions[k] = best[k].best;
        } else {
            longest2[k] = nodes_[k].longest2;
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
    FermatGroup fallback(lanes_, bounds);
    fallback.search(inFallback);
    decide(inFallback, best, fallback, solutions);
}

JetGroup::Solution JetGroup::solveAtRim(std::size_t lane) {
    nodes_[lane].rim = true;
    return solveAgain(lane);
}

JetGroup::Solution JetGroup::solveOverSegments(std::size_t lane, float longest2) {
    nodes_[lane].longest2 = longest2;
    return solveAgain(lane);
}

JetGroup::Solution JetGroup::solveAtFold(std::size_t lane) {
    nodes_[lane].smooth = false;
    return solveAgain(lane);
}

JetGroup::Solution JetGroup::solveAgain(std::size_t lane) {
    if (!fitted_) fit();
    Solutions solutions;
    solveDoubtful(1u << lane, solutions);
    return solutions[lane];
}

JetGroup::BestFit JetGroup::bestFit(std::size_t lane) const {
    const Node& node = nodes_[lane];
    BestFit fit;
    if (lanes_.count[lane] == 0) return fit;
    fit.best.source = sources_[lane][0];
    fit.best.frontsMeet = fits_.hasSecond(lane) || fits_.first.turn[lane] > FrontsMeet::kTurn;
    fit.add(fits_.first, fits_.fronts, lane);
    if (fits_.hasSecond(lane)) fit.add(fits_.second, fits_.fronts, lane);
    fit.counts = fit.fromBothSides || !node.rim;
    fit.best.oneSided = !fit.fromBothSides && node.smooth;
    fit.final = fit.valid && fit.counts && fit.clear && node.smooth;
    fit.mayCount = fit.valid && (fit.counts || !node.smooth);
    return fit;
}

void JetGroup::decide(unsigned nodes, const BestFits& fits, const FermatGroup& fallback,
                      Solutions& solutions) const {
    Lanes u, x{}, y{}, turn;
    for (unsigned left = nodes; left; left &= left - 1) {
        const auto k = std::size_t(std::countr_zero(left));
        const Solution& best = fits[k].best;
        u[k] = lanes_.neighbor[0].u[k] + fallback.u(k);
        if (fits[k].mayCount && best.u - u[k] < kAgree &&
            u[k] - best.u < mostBelow(nodes_[k].smooth)) {
            solutions[k] = best, nodes &= ~(1u << k);
            continue;
        }
        const Vec2f g = fallback.g(k);
        x[k] = g.x, y[k] = g.y;
    }
    if (!nodes) return;
    findTurns(lanes_, x, y, turn);
    for (; nodes; nodes &= nodes - 1) {
        const auto k = std::size_t(std::countr_zero(nodes));
        solutions[k] = {
            u[k],  {x[k], y[k]},       fits[k].best.source, true, turn[k] > FrontsMeet::kTurn,
            false, fallback.detour(k), fallback.ends(k)};
    }
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
