#include <igeo/march/detail/jet_two_fronts_fit.h>

#include <algorithm>
#include <cmath>

namespace igeo {

TwoFrontsFit::TwoFrontsFit(const CoreJets& jets) : jets_(jets) {
    lanes_.pull = jets.core->pull();
    lanes_.base = {};
    lanes_.count[0] = JetLanes::kMax;
    lanes_.pad();
}

bool TwoFrontsFit::layOut(std::span<const Neighbor> around, const Neighbor& from, double before) {
    constexpr float kOther = 0.7f;  // cosine
    for (std::size_t f = 0; f < 2; ++f) of_[f].clear(), lead_[f] = {};
    for (const auto& [link, both] : around) {
        if (!both || both->locus != from.both->locus) {
            const double apart = apart_ - double(dot(turn_, link.a()));
            of_[apart < 0 ? 0 : 1].push_back(marched(link));
            continue;
        }
        for (std::size_t f = 0; f < 2; ++f)
            if (const TwoFronts::Front& front = both->front[f]; front.u < kInfinity)
                of_[f].push_back({link.a(), link.turned(front.g), front.u});
    }
    for (std::size_t f = 0; f < 2; ++f) {
        if (const TwoFronts::Front& front = from.both->front[f]; front.u < kInfinity)
            lead_[f] = from.link.turned(front.g);
        else
            for (const JetNeighbor& n : of_[f]) lead_[f] = lead_[f] + n.g;
        if (const float l = length(lead_[f]); l > 0) lead_[f] = (1 / l) * lead_[f];
        for (const JetNeighbor& n : of_[f])
            if (dot(n.g, lead_[f]) < kOther && dot(n.g, n.a) > 0 && n.u < before) return false;
    }
    return true;
}

void TwoFrontsFit::fit(double before, Found& found) {
    if (std::max(of_[0].size(), of_[1].size()) > JetLanes::kMax) return;
    Lanes x{}, y{};
    for (std::size_t f = 0; f < 2; ++f) {
        lanes_.base[f] = float(before), lanes_.count[f] = std::uint32_t(of_[f].size());
        x[f] = lead_[f].x, y[f] = lead_[f].y;
        for (std::size_t k = 0; k < of_[f].size(); ++k) {
            const JetNeighbor& n = of_[f][k];
            JetLanes::Neighbor& to = lanes_.neighbor[k];
            to.ax[f] = n.a.x, to.ay[f] = n.a.y, to.gx[f] = n.g.x, to.gy[f] = n.g.y;
            to.u[f] = float(n.u - before);
        }
    }
    lanes_.pad(2);
    fitFronts(lanes_, x, y, fits_);
    for (std::size_t f = 0; f < 2; ++f) {
        const std::optional<double> u = valueOf(f, before);
        if (!u) continue;
        const Vec2f g{fits_.gx[f], fits_.gy[f]};
        found.both.front[f] = {*u, g};
        if (*u < found.u) found.u = *u, found.g = g;
    }
    if (const auto& [a, b] = found.both.front; a.u < kInfinity && b.u < kInfinity)
        found.both.apart = a.u - b.u, found.both.turn = a.g - b.g;
}

std::optional<double> TwoFrontsFit::valueOf(std::size_t front, double before) const {
    constexpr double kSlack = 0.01;  // voxels, above the straight line from a neighbor
    if (of_[front].size() < 2 || !(fits_.u[front] < float(kInfinity)) ||
        !(fits_.residual2[front] < jet::kResidual * jet::kResidual))
        return {};
    const double u = before + double(fits_.u[front]);
    for (const JetNeighbor& n : of_[front])
        if (u > n.u + double(length(n.a)) + kSlack) return {};
    return u;
}

std::optional<TwoFrontsFit::Found> TwoFrontsFit::solve(std::span<const Neighbor> around,
                                                       double before, float mostOff,
                                                       float mostAngle) {
    constexpr double kFallbackError = 0.25;  // voxels
    const Neighbor* from = nullptr;
    float nearest = float(kInfinity);
    for (const Neighbor& n : around)
        if (const float off = dot(n.link.a(), n.link.a()); n.both && off < nearest)
            nearest = off, from = &n;
    if (!from) return {};
    turn_ = from->link.turned(from->both->turn);
    apart_ = from->both->apart + double(dot(turn_, from->link.a()));
    const float angle = length(turn_), off = float(std::abs(apart_)) / angle;
    if (off > mostOff || angle > mostAngle || !layOut(around, *from, before)) return {};
    const std::size_t own = apart_ < 0 ? 0 : 1, other = 1 - own;
    const bool asOne = angle < kLeastAngle;
    if (asOne) of_[own].insert(of_[own].end(), of_[other].begin(), of_[other].end());
    if (asOne || off > kWidth) of_[other].clear();
    Found found{{kNoNode, from->both->locus, 0, {}, apart_, turn_}, kInfinity, {}, angle, off};
    fit(before, found);
    if (!(found.both.front[own].u < kInfinity) || std::abs(found.u - before) > kFallbackError)
        return {};
    return found;
}

std::optional<TwoFrontsFit::Found> TwoFrontsFit::begin(std::span<const Neighbor> around,
                                                       double before, const MeetingFronts& fronts) {
    constexpr float kSame = 0.9f;  // cosine
    constexpr double kBeside = 1;  // voxels
    for (std::size_t f = 0; f < 2; ++f) of_[f].clear(), lead_[f] = fronts.g[f];
    for (const Neighbor& n : around) {
        const JetNeighbor jet = marched(n.link);
        const float first = dot(jet.g, lead_[0]), second = dot(jet.g, lead_[1]);
        if (std::max(first, second) > kSame) of_[first > second ? 0 : 1].push_back(jet);
    }
    Found found{{}, kInfinity, {}, 0, 0};
    fit(before, found);
    const auto& [a, b] = found.both.front;
    if (!(a.u < kInfinity && b.u < kInfinity && std::abs(a.u - b.u) < kBeside)) return {};
    found.angle = length(found.both.turn);
    found.off = float(std::abs(found.both.apart)) / found.angle;
    return found;
}

}  // namespace igeo
