/// The parts of S that are nearest to each seed: geodesic Voronoi cells.
#pragma once

#include <igeo/base/progress.h>
#include <igeo/march/field.h>
#include <igeo/results/surface_mesh.h>

#include <vector>

namespace igeo {

struct VoronoiCell {
    double area = 0;      ///< square voxels
    double boundary = 0;  ///< length of what it shares with other cells, voxels; counted there too
};

struct VoronoiCells {
    std::vector<VoronoiCell> cells;  ///< one per seed
    double unreachedArea = 0;        ///< square voxels, beyond all cells or the limit of the march
    double area = 0;                 ///< of the whole mesh; cells and the rest add up to it
};

/// Areas and boundaries of the cells of the field's seeds.
///
/// A triangle whose corners belong to two seeds a and b is cut where their distances, continued
/// along its edges by the jets at its corners, d_a + g_a . t and d_b + g_b . t, are equal; one of
/// three seeds has a triple point where all three are. Where the march was limited (Field::limit),
/// triangles are cut there, by distances continued to corners that were not reached; elsewhere half
/// an edge counts as unreached where one end is.
/// @param mesh surfaceMesh() of the same field
/// @throws Error  InvalidArgument for several seeds without labels (Field::label)
///         Cancelled through `progress`
/// Time O(triangles). The cells' areas are those of flat triangles: second order in dx.
VoronoiCells voronoiCells(const Field& field, const SurfaceMesh& mesh,
                          Progress& progress = Progress::none());

}  // namespace igeo
