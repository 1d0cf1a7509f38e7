/// psi = 0 of a level set as quadrilaterals. Internal.
#pragma once

#include <igeo/base/types.h>

#include <array>
#include <cstdint>
#include <vector>

namespace igeo {

struct Band;
struct LevelSet;

/// Quadrilaterals on psi = 0, counter-clockwise seen from outside; index space.
struct QuadMesh {
    using Quad = std::array<std::uint32_t, 4>;

    std::vector<Vec3d> points;
    std::vector<Quad> quads;
};

/// Dual marching cubes (G. Nielson, 2004): a vertex in each cell that S passes through, or several
/// where sheets share it, and a quadrilateral around each crossed edge between voxels. The mesh is
/// closed where S is: where two cells would share a tunnel, both part it (R. Wenger, Isosurfaces,
/// 2013, 3.5).
///
/// A vertex is the mean of the points where its sheet crosses edges, moved along grad psi to the
/// zero set of the trilinear interpolant. Quadrilaterals that touch the edge of the volume, where
/// the sign of psi changes without a surface, are left out.
/// @param band  of the level set, or of a part of it
/// Time O(active voxels), in parallel. Order and bits do not depend on the number of threads.
QuadMesh levelSetMesh(const LevelSet& levelSet, const Band& band);

}  // namespace igeo
