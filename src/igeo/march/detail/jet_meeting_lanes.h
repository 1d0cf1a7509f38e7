/// The fronts that come to foot points, up to eight points side by side in the vector registers.
/// Internal to jet_meeting.cpp and jet_rays.cpp.
///
/// Each lane has the same bits in registers of any width.
#pragma once

#include <igeo/march/detail/jet_fit.h>
#include <igeo/march/detail/jet_state.h>

#include <array>

namespace igeo {

/// What the neighbors of the points bring: the first neighbor of each point, the second of each,
/// and so on.
struct Arrivals {
    static constexpr std::size_t kMax = JetLinks::kMax;
    template <typename T>
    using PerLane = std::array<T, Lanes::kNodes>;
    struct Neighbor {
        Lanes gx, gy;  ///< direction of travel
        Lanes u;       ///< value by a plane front; JetFronts::kNoValue: it travels away
    };
    std::array<Neighbor, kMax> neighbor;
    std::size_t count = 0;  ///< of the point that has most
};

/// The directions of the fronts that come first.
struct ArrivingFronts {
    static constexpr std::size_t kMax = MeetingFronts::kMost;
    std::array<Lanes, kMax> x, y;
    alignas(32) Arrivals::PerLane<std::int32_t> count;  ///< of the fronts of a point

    MeetingFronts at(std::size_t lane) const {
        MeetingFronts of{std::uint32_t(count[lane])};
        for (std::size_t k = 0; k < of.count; ++k) of.g[k] = {x[k][lane], y[k][lane]};
        return of;
    }
};
void findFronts(const Arrivals& arrivals, ArrivingFronts& fronts);

/// Nodes of a core, and all their links.
struct LinkedNodes {
    template <typename T>
    using PerLane = Arrivals::PerLane<T>;
    std::size_t size = 0;
    alignas(32) PerLane<NodeIndex> node{};
    alignas(32) PerLane<std::int32_t> links;  ///< how many
    PerLane<const JetLink*> link;             ///< the first of them

    LinkedNodes() { clear(); }
    void clear() {
        static constexpr JetLink kNoLink{};
        size = 0, links.fill(0), link.fill(&kNoLink);
    }
    bool full() const { return size == Lanes::kNodes; }
    void add(NodeIndex i, std::span<const JetLink> row) {
        if (row.empty()) return;
        node[size] = i, links[size] = std::int32_t(row.size()), link[size++] = row.data();
    }
};
/// What is known of these nodes from their neighbors that have a jet.
struct LinkedFronts {
    Arrivals arrivals;  ///< beyond the starts of the buckets of the nodes
    Lanes least;        ///< the least value of a neighbor, from there
    unsigned meet;      ///< bits: the nodes across which fronts meet (FrontsMeet)
    /// Per link, bits: the nodes toward which the neighbor travels from its side.
    std::array<std::uint8_t, JetLinks::kMax> toward;
};
/// @param nodes   accepted, all of one weight
void findFronts(const CoreJets& jets, const LinkedNodes& nodes, LinkedFronts& fronts);

}  // namespace igeo
