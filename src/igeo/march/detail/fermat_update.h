/// The fallback of scheme `jet`, by Fermat's principle: the minimum, over the neighbors and the
/// segments between them, of the value there plus the length of the straight line from there to the
/// node. It is the update of the jet marching method of S. F. Potter and M. K. Cameron, Jet
/// marching methods for solving the eikonal equation, SIAM J. Sci. Comput. 43 (2021).
#pragma once

#include <igeo/march/detail/jet_fit.h>

#include <array>

namespace igeo {

/// The fallback: the minimum of u_j + |a_j| over the neighbors, and over the segments between them.
/// Never below the values it starts from; at least first order, second where the front is smooth.
/// @return u = +infinity without neighbors
/// @param ends  the neighbors at the ends of the segment from which u comes; equal: one neighbor
Jet fermatUpdate(const JetNeighbors& all, std::array<std::uint8_t, 2>* ends = nullptr);

/// Bounds of the fallbacks of the nodes of a group, without a search.
struct FermatBounds {
    Lanes least, most;  ///< relative to JetLanes::base

    /// Of each node the neighbor with the least u_j + |a_j|, and that, relative to the first one.
    alignas(32) std::array<std::int32_t, Lanes::kNodes> end;
    Lanes leastEnd;
    /// Bits, for the segments from each neighbor to those before: the nodes whose fallback may come
    /// from there.
    static constexpr std::size_t kMostPairs = JetLanes::kMax * (JetLanes::kMax - 1) / 2;
    std::array<std::uint8_t, kMostPairs> mayBeLeast;
    std::size_t count;  ///< of neighbors, of the node that has most

    static constexpr float kRounding = 1e-3f;  ///< bounds are off by less
};
/// @param longest2  as in JetNeighbors, per node; 0: the node is left out
void boundFallbacks(const JetLanes& lanes, const Lanes& longest2, FermatBounds& bounds);

/// Up to eight segments, each from a neighbor p to a neighbor q.
struct SegmentLanes {
    struct End {
        Lanes ax, ay, gx, gy, u;  ///< as in JetNeighbor, u relative to the first neighbor
    };
    End p{}, q{};
    std::array<std::uint8_t, Lanes::kNodes> node{};                 ///< whose neighbors they are
    std::array<std::array<std::uint8_t, 2>, Lanes::kNodes> ends{};  ///< which of them p and q are
    std::size_t count = 0;
};

/// The fallbacks of nodes of a group, whose segments are searched side by side. A node gets the
/// same bits in any group.
class FermatGroup {
public:
    FermatGroup(const JetLanes& lanes, const FermatBounds& bounds)
        : lanes_(lanes), bounds_(bounds) {}
    /// Finds the fallbacks of nodes that have bounds.
    /// @param nodes  bits
    void search(unsigned nodes);
    /// The value of a node, relative to its first neighbor, and the direction of travel.
    float u(std::size_t node) const { return nodes_[node].u; }
    Vec2f g(std::size_t node) const;
    /// How much longer the straight line to the node is than what a plane front travels along it:
    /// large where no neighbor lies straight behind the node.
    float detour(std::size_t node) const { return nodes_[node].detour; }
    /// The neighbors at the ends of the segment from which the value comes; equal: one neighbor.
    using Ends = std::array<std::uint8_t, 2>;
    Ends ends(std::size_t node) const { return nodes_[node].ends; }

private:
    struct Node {
        float u = float(kInfinity);  ///< the least so far
        Vec2f a;                     ///< to the node from where that is
        Vec2f g;                     ///< at the neighbor there, or at an end of the segment
        float detour = 0;            ///< detour()
        Ends ends{};                 ///< ends()
    };
    void addSegment(std::size_t node, std::size_t p, std::size_t q);
    void takeSegments();

    const JetLanes& lanes_;
    const FermatBounds& bounds_;
    std::array<Node, Lanes::kNodes> nodes_;
    SegmentLanes segments_;
};

}  // namespace igeo
