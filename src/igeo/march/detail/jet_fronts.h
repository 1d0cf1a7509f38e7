/// Which fronts the neighbors of a node belong to, and the value at the node by each one alone.
#pragma once

#include <igeo/march/detail/jet_neighbors.h>

namespace igeo::jet {

/// Value carried forward from neighbor k alone along the circle about a source at distance u,
/// relative to base(): to second order |r g + a| = r + along + (|a|^2 - along^2) / (2 r), with
/// along = g . a and r = u + along, which is enough to compare neighbors.
inline float carry(const JetNeighbors& all, int k, float len) {
    const float along = dot(all.g(k), all.a(k));
    if (along <= 0) return all.u(k) + len;
    const float r = float(all.base()) + all.u(k) + along;
    return all.u(k) + along + (len * len - along * along) / (2 * std::max(r, 1.0f));
}

/// The values by the neighbors one by one, relative to base(). Two fronts at most are
/// distinguished: that of the neighbor that carries the least value, and the best of those that
/// disagree with it.
struct Fronts {
    std::array<float, JetNeighbors::kMax> carried;  ///< per neighbor, by carry()
    float bound = float(kInfinity);                 ///< least u_j + |a_j|: no value lies above it
    float straight = float(kInfinity);              ///< least u_j + g_j . a_j: plane fronts
    int lead = 0;                                   ///< the neighbor that carries the least value

    explicit Fronts(const JetNeighbors& all) {
        for (int k = 0; k < all.count(); ++k) {
            const float len = all.len(k);
            carried[std::size_t(k)] = carry(all, k, len);
            bound = std::min(bound, all.u(k) + len);
            straight = std::min(straight, all.u(k) + dot(all.g(k), all.a(k)));
            if (carriedBy(k) < carriedBy(lead)) lead = k;
        }
    }
    float carriedBy(int k) const { return carried[std::size_t(k)]; }

    /// The neighbor of another front than the lead's that carries the least value, or -1.
    int second(const JetNeighbors& all) const {
        int second = -1;
        for (int k = 0; k < all.count(); ++k)
            if (dot(all.g(k), all.g(lead)) < kSameFront &&
                (second < 0 || carriedBy(k) < carriedBy(second)))
                second = k;
        return second;
    }
};

}  // namespace igeo::jet
