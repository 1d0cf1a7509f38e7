/// Signs of normals, chosen so that they point to one side of the surface.
#pragma once

#include <igeo/base/point_tree.h>
#include <igeo/base/types.h>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace igeo {

struct Orientation {
    std::vector<std::int8_t> sign;  ///< per point: +1 or -1, the factor of its normal
    std::size_t pieces = 0;         ///< of the neighborhood graph; each is oriented separately
};

/// Signs by the neighborhood graph, as Hoppe, DeRose, Duchamp, McDonald and Stuetzle have it
/// (Surface reconstruction from unorganized points, SIGGRAPH 1992).
///
/// The prediction of normal i for its neighbor j is n_i mirrored in the plane halfway between the
/// two. For two points of a circle it is n_j exactly; on one sheet it is nearly n_i; straight
/// across a gap it is -n_i, so that sheets that face each other get opposite normals. Edges are
/// certain where the mirrored normals agree, along the sheet rather than across. Those join points
/// to parts; then parts are joined, first those whose edges together say most. Beside a sharp edge
/// two points of different sheets lie both outside or both inside of the plane of the other: that
/// counts there. In each component the outermost point along a fixed direction has its normal point
/// outward, and so have then all normals of a closed surface.
/// @param normals    unit, per point
/// @param atEdge     per point: whether its normal is that of a sheet that ends at a sharp edge
///                   nearby; empty: none
/// @param neighbors of each point, the edges of the graph
/// Time O(n log n), serial except for the search of neighbors.
Orientation orientNormals(const PointTree& points, const std::vector<Vec3d>& normals,
                          const std::vector<std::uint8_t>& atEdge = {}, std::size_t neighbors = 10);

/// Where normals turn to the other side of the surface from one point to the next.
struct Seams {
    double share = 0;    ///< of the points, beside such a turn
    double longest = 0;  ///< extent of the largest connected part of these, world units
};

/// Seams by the certain edges of the neighborhood graph of orientNormals().
/// @param normals  unit, per point, with signs
/// Time O(n log n), in parallel but for the points beside seams.
Seams seamsOf(const PointTree& points, const std::vector<Vec3d>& normals,
              const std::vector<std::uint8_t>& atEdge = {}, std::size_t neighbors = 10);

}  // namespace igeo
