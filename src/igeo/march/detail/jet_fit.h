/// The fit of scheme `jet`: the jet at a node by weighted least squares over one front, for the
/// nodes of a group side by side in the vector registers.
///
/// For a circular front in the plane with directions g, g_j at two of its points, a_j apart,
///
///     u - u_j = (g + g_j) . a_j / (1 + g . g_j)                                  (circular step)
///
/// exactly, and for a straight front as its limit (docs/method.md, "2. Circular step"). The
/// trapezoid rule (g + g_j) . a_j / 2 misses a^3 / (4 r^2) next to a source, and that stays for
/// good.
///
/// Each neighbor gives the equation u - f_j g . a_j = u_j + f_j g_j . a_j, f_j = 1 / (1 + g . g_j),
/// linear in (u, g) once f_j is taken from the round before. Its weight is cos^2 of the angle
/// between a_j and the direction of travel over |a_j|^2 + 0.1, so that neighbors straight behind
/// the node decide. A small Tikhonov term pulls g to the predicted direction where the neighbors
/// leave it open: that of a front from a source at distance u, or narrower where they show it.
///
/// Each node has a lane of its own and its sums run over its neighbors in their order, so its
/// result has the same bits in whatever group it is solved, and in registers of any width.
#pragma once

#include <igeo/march/detail/jet_neighbors.h>

namespace igeo {

/// A number per node of a group.
struct alignas(32) Lanes {
    static constexpr std::size_t kNodes = 8;
    float of[kNodes];
    float& operator[](std::size_t lane) { return of[lane]; }
    float operator[](std::size_t lane) const { return of[lane]; }
};

/// The neighbors of up to eight nodes: the first of each node, the second of each, and so on.
struct JetLanes {
    static constexpr std::size_t kMax = JetNeighbors::kMax;  ///< neighbors of a node
    struct Neighbor {
        Lanes ax, ay, gx, gy, u;  ///< as in JetNeighbor; u relative to `base`
    };
    std::array<Neighbor, kMax> neighbor;
    Lanes base;
    std::array<std::uint32_t, Lanes::kNodes> count{};
    float pull = 0.005f;  ///< weight of the predicted direction in a fit, of all weights

    JetNeighbor at(std::size_t lane, std::size_t k) const {
        const Neighbor& n = neighbor[k];
        return {{n.ax[lane], n.ay[lane]}, {n.gx[lane], n.gy[lane]}, double(n.u[lane])};
    }
    /// Makes the first lanes as long as the longest. What is filled in belongs to no front.
    void pad(std::size_t lanes = Lanes::kNodes);
};

/// Which fronts the neighbors of a node belong to, and what they say one by one, relative to
/// JetLanes::base. Two fronts at most are distinguished: that of the neighbor that carries the
/// least value along a circle about its source, and the best of those that disagree with it.
struct JetFronts {
    Lanes leadX, leadY;      ///< direction of the neighbor that carries the least value
    Lanes second;            ///< the least value by a neighbor of another front; kNoValue: none
    Lanes secondX, secondY;  ///< its direction
    Lanes bound;             ///< least u_j + |a_j|: no value lies above it
    Lanes straight;          ///< least u_j + g_j . a_j: plane fronts

    static constexpr float kNoValue = 1e18f;  ///< squares of it are still finite
};
void findFronts(const JetLanes& lanes, JetFronts& fronts);

/// A front fitted. u is the weighted mean of what its neighbors say by the circular step.
struct JetFits {
    Lanes u;       ///< relative to JetLanes::base; NaN or +inf where fewer than two neighbors are
                   ///< behind the node, or they do not agree
    Lanes gx, gy;  ///< direction of travel
    Lanes residual2;  ///< variance of what the neighbors say, by the same weights
    Lanes oneSided;   ///< 0 where neighbors lie to the left and to the right of the ray, else 1
    Lanes turn;       ///< FrontsMeet::turn of the neighbors, of any front
};
/// Fits the fronts that have the directions `x`, `y` at one of the neighbors, in two rounds.
void fitFronts(const JetLanes& lanes, const Lanes& x, const Lanes& y, JetFits& fits);

/// FrontsMeet::turn of the neighbors, for directions of travel at the nodes.
void findTurns(const JetLanes& lanes, const Lanes& x, const Lanes& y, Lanes& turn);

/// What the fits of the first fronts come to, a bit per node.
struct JetVerdicts {
    unsigned second;  ///< the fit does not fail, and another front may come first, or 0.2 later
    unsigned clear;   ///< not so, no fronts meet, and there is no reason for doubt
};
JetVerdicts judge(const JetFronts& fronts, const JetFits& first);

namespace jet {

/// A fit fails where its value lies further above the straight line from some neighbor, or its
/// residual is larger.
constexpr float kSlack = 1e-3f, kResidual = 0.02f;
/// A fit is in doubt where its residual is larger, or its value further below all plane fronts: two
/// neighbors always agree, however wrong.
constexpr float kDoubt = 6e-3f, kFocus = 0.2f;

}  // namespace jet

}  // namespace igeo
