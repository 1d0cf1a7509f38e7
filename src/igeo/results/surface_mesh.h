/// S as triangles, with distances at their corners.
#pragma once

#include <igeo/band/band.h>
#include <igeo/base/progress.h>
#include <igeo/march/field.h>

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

namespace igeo {

struct LevelSet;

constexpr std::uint32_t kNoLabel = std::numeric_limits<std::uint32_t>::max();

/// Triangles on psi = 0, counter-clockwise seen from outside. Lengths in voxels, index space.
struct SurfaceMesh {
    using Triangle = std::array<std::uint32_t, 3>;

    std::vector<Vec3d> position;
    std::vector<Vec3f> normal;         ///< unit, outward
    std::vector<double> distance;      ///< voxels times weight; +infinity: unreached
    std::vector<std::uint32_t> label;  ///< the nearest seed, kNoLabel: unreached
    std::vector<Vec3f> gradient;       ///< of the distance along the surface (gradientAt)
    std::vector<Triangle> triangles;
};

/// The same in world units, counter-clockwise seen from outside.
SurfaceMesh inWorld(SurfaceMesh mesh, const Similarity& transform);

/// psi = 0: a vertex per crossed cell, or several where sheets share it, on the zero set of the
/// trilinear interpolant, and a quadrilateral per crossed lattice edge, split along the better
/// diagonal (levelSetMesh).
///
/// Closed surfaces give closed meshes. Where the edge of the volume cuts the surface, the mesh ends
/// within two voxels of it. A vertex stays the mean of the points where S crosses the edges of its
/// cell, some thousandths of a voxel off, where a corner is missing, or where a projection
/// to psi = 0 leaves the cell and the band.
/// @param field distances are sampleDistance(); a label is Arrival::source
/// @throws Error  Cancelled through `progress`
/// Time O(active voxels), in parallel. Order and bits do not depend on the number of threads.
SurfaceMesh surfaceMesh(const LevelSet& levelSet, const Field& field,
                        Progress& progress = Progress::none());

/// The same without distances and labels; normals are the means of the triangles around.
SurfaceMesh surfaceMesh(const LevelSet& levelSet, const Band& band,
                        Progress& progress = Progress::none());

/// Fills distance and label of a mesh on S from its positions and normals (arrivalsAt).
/// @throws Error  Cancelled through `progress`
void sampleDistances(SurfaceMesh& mesh, const Field& field, Progress& progress = Progress::none());

/// Turns a mesh that isolines and cells are made from into what users read. Its vertices beyond the
/// limit of the march become unreached: next to it they are extrapolated, by up to some voxels, so
/// that isolines end there. Distances and gradients get the signs of the field.
/// @param mesh  in index space
void finish(SurfaceMesh& mesh, const Field& field);

/// Fills normal, distance, label and gradient of a mesh on S from its positions and triangles.
/// @throws Error  Cancelled through `progress`
void sampleField(SurfaceMesh& mesh, const Field& field, Progress& progress = Progress::none());

/// The edges of a mesh, each between two triangles, or at the rim of one.
///
/// An edge that four triangles share becomes two edges, so that each edge has at most one triangle
/// on the other side.
struct MeshEdges {
    std::vector<std::array<std::uint32_t, 2>> ends;        ///< vertices, the lesser first
    std::vector<std::array<std::uint32_t, 3>> ofTriangle;  ///< edge from corner k to corner k + 1
};
/// Time O(n log n).
MeshEdges meshEdges(const SurfaceMesh& mesh);

/// Color (red, green, blue in [0, 1]) for a share of the largest distance, in [0, 1].
using Color = std::function<Vec3f(double)>;

}  // namespace igeo
