/// The edges of a triangle mesh, with the triangles on them. Internal.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <tuple>
#include <vector>

namespace igeo {

/// One side of an edge.
struct HalfEdge {
    std::uint32_t low, high;
    std::uint32_t triangle, corner;
    bool up;  ///< runs from low to high

    bool operator<(const HalfEdge& o) const {
        return std::tie(low, high, triangle, corner) <
               std::tie(o.low, o.high, o.triangle, o.corner);
    }
};

/// Calls visit(first, last) for the half-edges of each edge, ordered by triangle.
/// @param points  their number
template <typename Visit>
void forEdges(std::size_t points, const std::vector<std::array<std::uint32_t, 3>>& triangles,
              const Visit& visit) {
    // Sorted by their lower point first, which needs no comparisons.
    std::vector<std::size_t> place(points + 1);
    auto forSides = [&](const auto& see) {
        for (std::size_t t = 0; t < triangles.size(); ++t)
            for (std::uint32_t k = 0; k < 3; ++k) {
                const std::uint32_t a = triangles[t][k], b = triangles[t][(k + 1) % 3];
                see(HalfEdge{std::min(a, b), std::max(a, b), std::uint32_t(t), k, a < b});
            }
    };
    forSides([&](const HalfEdge& h) { ++place[h.low + 1]; });
    std::partial_sum(place.begin(), place.end(), place.begin());
    std::vector<HalfEdge> half(3 * triangles.size());
    forSides([&](const HalfEdge& h) { half[place[h.low]++] = h; });
    std::size_t first = 0;
    for (std::size_t point = 0; point < points; first = place[point++])
        std::sort(half.begin() + std::ptrdiff_t(first),
                  half.begin() + std::ptrdiff_t(place[point]));
    for (std::size_t begin = 0, end; begin < half.size(); begin = end) {
        end = begin + 1;
        while (end < half.size() && half[end].low == half[begin].low &&
               half[end].high == half[begin].high)
            ++end;
        visit(half.data() + begin, half.data() + end);
    }
}

}  // namespace igeo
