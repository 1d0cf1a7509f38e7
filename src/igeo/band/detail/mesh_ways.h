/// Lines between nodes over the triangles of a mesh, where voxels cannot hold its sheets.
#pragma once

#include <igeo/band/detail/short_walk.h>

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

namespace igeo {

/// A line on triangles laid flat: straight, or straight from each vertex that it goes around to the
/// next.
struct MeshWay {
    NodeIndex from, to;
    WalkEnds line;
    bool atRim = false;  ///< links lead around there as well, less exactly
};

/// Nodes by the triangles of their foot points.
struct NodesOnTriangles {
    std::vector<std::pair<std::uint32_t, NodeIndex>> all;  ///< sorted

    /// Calls visit(node) for the nodes on a triangle.
    template <typename Visit>
    void forOn(std::uint32_t triangle, const Visit& visit) const {
        auto at = std::lower_bound(all.begin(), all.end(), std::pair(triangle, NodeIndex(0)));
        for (; at != all.end() && at->first == triangle; ++at) visit(at->second);
    }
};

/// The lines of a band, and the core nodes around.
struct MeshWays {
    /// Longest lines, voxels. Around the corner of a rim nodes are near.
    static constexpr double kReach = 12, kRimReach = 6;

    std::vector<MeshWay> ways;  ///< in both directions, sorted by their ends
    NodesOnTriangles nodes;

    /// Calls visit(line) for the lines to a node.
    template <typename Visit>
    void forTo(NodeIndex i, const Visit& visit) const {
        auto at = std::lower_bound(ways.begin(), ways.end(), i,
                                   [](const MeshWay& w, NodeIndex node) { return w.to < node; });
        for (; at != ways.end() && at->to == i; ++at) visit(*at);
    }
    /// Whether lines that links cannot replace lead to a node.
    bool hasOthersThanAtRim(NodeIndex i) const {
        bool found = false;
        forTo(i, [&](const MeshWay& way) { found |= !way.atRim; });
        return found;
    }
};

}  // namespace igeo
