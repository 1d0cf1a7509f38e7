/// Normals that are known but for their sign, turned to one side of the surface.
#pragma once

#include <igeo/base/point_tree.h>
#include <igeo/base/types.h>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace igeo {

struct Orientation {
    std::vector<std::int8_t>
        sign;                ///< per point: +1 or -1, by which its normal is to be multiplied
    std::size_t pieces = 0;  ///< of the neighborhood graph; each is oriented by itself
    /// Share of the sure neighbors whose normals disagree in the end: near 0, unless the surface
    /// is one-sided or the normals are noise.
    double conflicts = 0;
};

/// Signs along a minimum spanning tree of the neighborhood graph (Hoppe, DeRose, Duchamp,
/// McDonald and Stuetzle, Surface reconstruction from unorganized points, SIGGRAPH 1992).
///
/// What normal i says about its neighbor j is n_i mirrored in the plane halfway between the two:
/// for two points of a circle that is n_j exactly, on one sheet it is nearly n_i, and straight
/// across a gap it is -n_i, so that sheets that face each other are turned apart. The tree takes
/// sure edges first: those with mirrored normals along each other, along the sheet rather than
/// across. In each piece the outermost point along a fixed direction has its normal point outward;
/// so do then all normals of a closed surface.
/// @param normals    unit, per point
/// @param neighbors of each point, that make the graph
/// Time O(n log n), serial but for the search of neighbors.
Orientation orientNormals(const PointTree& points, const std::vector<Vec3d>& normals,
                          std::size_t neighbors = 10);

}  // namespace igeo
