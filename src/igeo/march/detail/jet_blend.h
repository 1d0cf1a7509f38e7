/// Interpolation of jets: values between nodes that have one, not marching.
#pragma once

#include <igeo/march/detail/jet_neighbors.h>

namespace igeo {

/// One weight per neighbor, > 0; further entries 0.
using BlendWeights = std::array<float, JetNeighbors::kMax>;

namespace jet {

/// The neighbor of those not blended yet whose plane front has the least value here, or -1.
inline int leastOf(const JetNeighbors& all, const std::array<bool, JetNeighbors::kMax>& done) {
    int lead = -1;
    float least = float(kInfinity);
    for (int k = 0; k < all.count(); ++k) {
        const float value = all.u(k) + dot(all.g(k), all.a(k));
        if (!done[std::size_t(k)] && value < least) lead = k, least = value;
    }
    return lead;
}

/// blendJets for neighbors that may belong to two fronts: each is blended by itself, by the
/// trapezoid rule with the direction of its lead, and the lesser value counts.
inline Jet blendFronts(const JetNeighbors& all, const BlendWeights& weight) {
    Jet best;
    std::array<bool, JetNeighbors::kMax> done{};
    for (int front = 0; front < 2; ++front) {
        const int lead = leastOf(all, done);
        if (lead < 0) break;
        float sum = 0, total = 0;
        Vec2f g{};
        for (int k = 0; k < all.count(); ++k) {
            if (done[std::size_t(k)]) continue;
            if (k != lead && dot(all.g(k), all.g(lead)) < kSameFront) continue;
            done[std::size_t(k)] = true;
            const float w = weight[std::size_t(k)];
            g = g + w * all.g(k);
            sum += w * (all.u(k) + dot(all.g(k) + all.g(lead), all.a(k)) / 2);
            total += w;
        }
        const double u = all.base() + double(sum / total);
        const float len = length(g);
        if (u < best.u) best = {u, len > 0 ? (1 / len) * g : g, false, false};
    }
    return best;
}

/// The weights of a group of four neighbors.
inline Four fourOf(const BlendWeights& weight, int group) {
    const auto k = std::size_t(4 * group);
    return Four{weight[k], weight[k + 1], weight[k + 2], weight[k + 3]};
}

}  // namespace jet

/// The jet at the origin among jets on all sides of it: each neighbor carries its jet to the origin
/// by the circular step (jet_fit.h) in the mean direction; the values are blended. Where two fronts
/// meet, each is blended by itself and the lesser value counts.
/// @return u = +inf without neighbors
inline Jet blendJets(const JetNeighbors& all, const BlendWeights& weight) {
    if (all.count() == 0) return {};
    jet::Four gx{}, gy{}, total{};
    for (int k = 0; k < all.groups(); ++k) {
        const auto n = all.group(k);
        const jet::Four w = jet::fourOf(weight, k);
        gx += w * n.gx, gy += w * n.gy, total += w;
    }
    const Vec2f mean{jet::sum(gx), jet::sum(gy)};
    const float len = length(mean);
    if (!(len > 0)) return jet::blendFronts(all, weight);
    const Vec2f g = (1 / len) * mean;
    jet::Four value{};
    for (int k = 0; k < all.groups(); ++k) {
        const auto n = all.group(k);
        const jet::Four w = jet::fourOf(weight, k);
        const jet::Four cosine = g.x * n.gx + g.y * n.gy;
        const auto other = (cosine < jet::kSameFront) & (w > 0);
        if (other[0] | other[1] | other[2] | other[3]) return jet::blendFronts(all, weight);
        value += w * (n.u + ((g.x + n.gx) * n.ax + (g.y + n.gy) * n.ay) / (1 + cosine));
    }
    return {all.base() + double(jet::sum(value) / jet::sum(total)), g, false, false};
}

}  // namespace igeo
