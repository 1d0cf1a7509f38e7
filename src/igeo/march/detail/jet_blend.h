/// Interpolation of jets: values between nodes that have one, not marching.
#pragma once

#include <igeo/march/detail/jet_neighbors.h>

namespace igeo {

/// One weight per neighbor, > 0; further entries 0.
using BlendWeights = std::array<float, JetNeighbors::kMax>;

namespace jet {

/// Neighbors less than 3 degrees off their mean direction are of one front.
constexpr float kClose = 0.9986f;
/// Directions closer than 6 degrees, as those of one front are on either side of a voxel 10 voxels
/// from its source: |g_i - g_j|^2.
constexpr float kAlike2 = 0.01f;

/// What two neighbors show of the front between them: its radius of curvature (positive where it
/// spreads, negative where it narrows), and by how much the circular step from one to the other
/// misses.
struct Pair {
    static constexpr float kLeastRadius = 0.25f;  ///< below, their chord is too short to tell
    static constexpr float kAgree = 0.02f;        ///< voxels
    static constexpr float kFocusBend2 = 0.1f;    ///< bend2 of a front that narrows by 18 degrees
    float bend2;                                  ///< |g_j - g_i|^2
    float radius;                                 ///< (g_j - g_i) . chord / bend2
    float miss;  ///< infinite where the directions are of two fronts in any case
    Pair(const JetNeighbors& all, int i, int j) {
        const Vec2f chord = all.a(i) - all.a(j), bend = all.g(j) - all.g(i);
        const float cosine = dot(all.g(i), all.g(j));
        bend2 = dot(bend, bend);
        radius = dot(bend, chord) / bend2;
        miss = cosine < kSameFront
                   ? float(kInfinity)
                   : std::abs(all.u(j) - all.u(i) - dot(all.g(i) + all.g(j), chord) / (1 + cosine));
    }
    /// Whether both are of a front that does not narrow: fronts that meet never look so.
    bool spreads() const {
        return miss < float(kInfinity) && (bend2 <= kAlike2 || radius >= kLeastRadius);
    }
    /// Whether both may be of a front that narrows to a focus. Two fronts that meet look so where
    /// one is the mirror image of the other, but not from corner to corner of a cell.
    bool narrows() const { return miss <= kAgree; }
};

/// Whether the neighbors, all within 45 degrees of their mean direction, are of one front.
inline bool ofOneFront(const JetNeighbors& all) {
    for (int i = 0; i < all.count(); ++i)
        for (int j = 0; j < i; ++j)
            if (const Pair pair(all, i, j); !pair.spreads() && !pair.narrows()) return false;
    return true;
}

/// Whether the neighbors are of one front that does not narrow.
inline bool spreads(const JetNeighbors& all) {
    for (int i = 0; i < all.count(); ++i)
        for (int j = 0; j < i; ++j)
            if (!Pair(all, i, j).spreads()) return false;
    return true;
}

/// Whether the neighbors may be beside a focus: three fronts meet, or one narrows by 18 degrees and
/// more from one to another.
inline bool nearFocus(const JetNeighbors& all) {
    std::array<Vec2f, 2> apart;
    std::size_t fronts = 0;
    for (int i = 0; i < all.count(); ++i) {
        const bool isOther = std::all_of(apart.begin(), apart.begin() + fronts,
                                         [&](Vec2f g) { return dot(g, all.g(i)) < kSameFront; });
        if (isOther && fronts == apart.size()) return true;
        if (isOther) apart[fronts++] = all.g(i);
        for (int j = 0; j < i; ++j)
            if (const Pair pair(all, i, j);
                pair.bend2 > Pair::kFocusBend2 && pair.radius < 0 && pair.narrows())
                return true;
    }
    return false;
}

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

/// One of the fronts at the origin.
struct BlendedFront {
    std::array<bool, JetNeighbors::kMax> own{};  ///< its neighbors
    float weight = 0;
    float u = 0;
    Vec2f g;
};

/// The front of the neighbor that leads those not blended yet.
inline BlendedFront blendFront(const JetNeighbors& all, const BlendWeights& weight, int lead,
                               std::array<bool, JetNeighbors::kMax>& done) {
    BlendedFront front;
    Vec2f sum{};
    for (int k = 0; k < all.count(); ++k) {
        if (done[std::size_t(k)] || (k != lead && !Pair(all, k, lead).spreads())) continue;
        done[std::size_t(k)] = front.own[std::size_t(k)] = true;
        sum = sum + weight[std::size_t(k)] * all.g(k);
    }
    const float len = length(sum);
    front.g = len > 0 ? (1 / len) * sum : Vec2f{};
    for (int k = 0; k < all.count(); ++k) {
        if (!front.own[std::size_t(k)]) continue;
        const float w = weight[std::size_t(k)];
        front.u +=
            w * (all.u(k) + dot(front.g + all.g(k), all.a(k)) / (1 + dot(front.g, all.g(k))));
        front.weight += w;
    }
    front.u /= front.weight;
    return front;
}

/// Whether a front may pass the origin. It comes from somewhere: one of its neighbors lies behind
/// the origin, not beyond it, if they have less than half of the weight. And it comes no earlier
/// than the values of other neighbors allow, less the lines from there, if those have more weight;
/// hardly earlier, if it has hardly any.
/// Beside a seed values at nodes over an edge may be too large: there it may pass, unless it has
/// hardly any weight, or a little and comes from nowhere, or less than half of those against it.
inline bool mayPass(const BlendedFront& front, const JetNeighbors& all, const BlendWeights& weight,
                    bool besideSeed) {
    constexpr float kBeyond = 0.1f, kEarlier = 0.25f, kEarlierFaint = 0.05f;  // voxels
    constexpr float kHardly = 0.1f, kFromElsewhere = 0.25f, kHalf = 0.5f;
    bool comes = false;
    float others = 0, against = 0;
    for (int k = 0; k < all.count(); ++k) {
        if (front.own[std::size_t(k)])
            comes |= dot(all.g(k), all.a(k)) > -kBeyond;
        else
            others += weight[std::size_t(k)];
    }
    const float earlier = front.weight < kHardly * others ? kEarlierFaint : kEarlier;
    for (int k = 0; k < all.count(); ++k)
        if (!front.own[std::size_t(k)] && all.u(k) - length(all.a(k)) > front.u + earlier)
            against += weight[std::size_t(k)];
    if (besideSeed && front.weight >= (comes ? kHardly : kFromElsewhere) * others &&
        front.weight >= kHalf * against)
        return true;
    return (comes || front.weight >= others) && front.weight >= against;
}

/// blendJets for neighbors of several fronts: each front is blended by itself, and the least value
/// counts of those that may pass; if none may, that of the front with most weight.
inline Jet blendFronts(const JetNeighbors& all, const BlendWeights& weight, bool besideSeed) {
    Jet best;
    BlendedFront heaviest;
    std::array<bool, JetNeighbors::kMax> done{};
    const auto jetOf = [&](const BlendedFront& front) {
        Jet jet;
        jet.u = all.base() + double(front.u), jet.g = front.g;
        return jet;
    };
    for (int lead = leastOf(all, done); lead >= 0; lead = leastOf(all, done)) {
        const BlendedFront front = blendFront(all, weight, lead, done);
        if (front.weight > heaviest.weight) heaviest = front;
        if (const Jet jet = jetOf(front); jet.u < best.u && mayPass(front, all, weight, besideSeed))
            best = jet;
    }
    if (!(best.u < kInfinity)) best = jetOf(heaviest);
    best.usedFallback = nearFocus(all), best.ofOneFront = false;
    return best;
}

/// The weights of a group of four neighbors.
inline Four fourOf(const BlendWeights& weight, int group) {
    const auto k = std::size_t(4 * group);
    return Four{weight[k], weight[k + 1], weight[k + 2], weight[k + 3]};
}

}  // namespace jet

/// The jet at the origin among jets on all sides of it: each neighbor carries its jet to the origin
/// by the circular step (jet_fit.h) in the mean direction; the values are blended. Where fronts
/// meet, each is blended by itself and the least value counts.
/// @param besideSeed  within the start disc of a seed
/// @return u = +inf without neighbors; usedFallback beside a focus (nearFocus)
inline Jet blendJets(const JetNeighbors& all, const BlendWeights& weight, bool besideSeed = false) {
    if (all.count() == 0) return {};
    jet::Four gx{}, gy{}, total{};
    for (int k = 0; k < all.groups(); ++k) {
        const auto n = all.group(k);
        const jet::Four w = jet::fourOf(weight, k);
        gx += w * n.gx, gy += w * n.gy, total += w;
    }
    const Vec2f mean{jet::sum(gx), jet::sum(gy)};
    const float len = length(mean);
    if (!(len > 0)) return jet::blendFronts(all, weight, besideSeed);
    const Vec2f g = (1 / len) * mean;
    jet::Four value{};
    bool close = true;
    for (int k = 0; k < all.groups(); ++k) {
        const auto n = all.group(k);
        const jet::Four w = jet::fourOf(weight, k);
        const jet::Four cosine = g.x * n.gx + g.y * n.gy;
        const auto other = (cosine < jet::kSameFront) & (w > 0);
        if (other[0] | other[1] | other[2] | other[3])
            return jet::blendFronts(all, weight, besideSeed);
        const auto off = (cosine < jet::kClose) & (w > 0);
        close = close && !(off[0] | off[1] | off[2] | off[3]);
        value += w * (n.u + ((g.x + n.gx) * n.ax + (g.y + n.gy) * n.ay) / (1 + cosine));
    }
    if (!close && !jet::ofOneFront(all)) return jet::blendFronts(all, weight, besideSeed);
    return {all.base() + double(jet::sum(value) / jet::sum(total)), g,
            !close && jet::nearFocus(all)};
}

}  // namespace igeo
