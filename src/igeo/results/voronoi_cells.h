/// Geodesic Voronoi cells: the parts of S that are nearest to each seed.
#pragma once

#include <igeo/base/progress.h>
#include <igeo/march/field.h>
#include <igeo/results/surface_mesh.h>

#include <vector>

namespace igeo {

struct VoronoiCell {
    double area = 0;      ///< square voxels
    double boundary = 0;  ///< length shared with other cells, voxels; counted in both
};

struct VoronoiCells {
    std::vector<VoronoiCell> cells;  ///< one per seed
    double unreachedArea = 0;        ///< square voxels, beyond all cells or the limit of the march
    double area = 0;                 ///< of the whole mesh: the sum of the cells and unreachedArea
};

/// Areas and boundaries of the cells of the field's seeds.
///
/// A triangle whose corners belong to two seeds a and b is cut where their distances, extrapolated
/// along its edges by the jets at its corners, d_a + g_a . t and d_b + g_b . t, are equal; one of
/// three seeds has a triple point where all three are. Where the march was limited (Field::limit),
/// triangles are cut there, by distances extrapolated to unreached corners; elsewhere half an edge
/// is unreached if one end is.
/// @param mesh surfaceMesh() of the same field
/// @throws Error  InvalidArgument for several seeds without labels (Field::label); Cancelled
///         through `progress`
/// Time O(triangles). The cells' areas are those of flat triangles: second order in dx.
VoronoiCells voronoiCells(const Field& field, const SurfaceMesh& mesh,
                          Progress& progress = Progress::none());

}  // namespace igeo
