/// Triangle meshes: welded, counted, oriented.
#pragma once

#include <igeo/base/types.h>
#include <igeo/io/polygon_mesh.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <string>
#include <vector>

namespace igeo {

struct TriangleMesh {
    using Triangle = std::array<std::uint32_t, 3>;

    std::string file;           ///< as given, for messages
    std::vector<Vec3d> points;  ///< in the file's units
    std::vector<Triangle> triangles;
    std::size_t dropped = 0;            ///< triangles with two equal corners, or duplicates
    std::size_t repeated = 0;           ///< of these the duplicates
    std::size_t junctions = 0;          ///< points at which splitAtJunctions() split edges
    std::vector<Triangle> unsplit;      ///< those with area before; empty unless it split some
    std::vector<std::string> warnings;  ///< for the user, one sentence each

    /// Points this close are the same, as a share of the diagonal of the bounding box.
    static constexpr double kSame = 1e-6;
    static constexpr std::uint32_t kNoPoint = std::numeric_limits<std::uint32_t>::max();
    /// The vertices and faces of the file; null for formats without vertex numbers (STL).
    std::shared_ptr<const PolygonMesh> source;
    /// Per vertex of the file its point; kNoPoint if no triangle uses it.
    std::vector<std::uint32_t> pointOfVertex;
};

/// A point of a mesh that lies on a triangle without being a corner of it.
struct MeshContact {
    std::uint32_t point = 0;
    Vec3d normal;  ///< of the triangle
};

/// Merges equal points, so that triangles find their neighbors. Drops triangles with fewer than
/// three corners left, duplicate triangles (in any orientation) and unused points.
///
/// A point closer to an earlier one than kSame of the diagonal of the triangles' bounding box is
/// merged into it.
/// Files with a point per corner (STL) hold each point several times, rounded in different ways:
/// single precision is good to 6e-8 of the coordinate. A triangle with three corners on one line
/// stays, because it joins its neighbors, up to splitAtJunctions(). Keeps the order of the rest,
/// and fills pointOfVertex where there is a source, whose vertices are the points in their order.
/// Time O(n).
void weld(TriangleMesh& mesh);

/// Splits the boundary edges in which the corners of other triangles lie, so that both sides have
/// the same edges: as where the last row of a fine grid ends on the edge of a large triangle.
///
/// A point splits an edge within kSame of it, as in weld(), if a boundary edge that ends in the
/// point runs along it. A point that only touches does not. Triangles without area are left out
/// first, so that their middle corner splits the triangle beyond their longest edge: not at edges
/// of three triangles, nor where a corner has no others. The pieces of a triangle take its place in
/// the order of triangles; points and source stay. Counts the points in `junctions`, and keeps the
/// triangles as they were in `unsplit`.
/// @param mesh  welded
/// Time O(n log n) for n boundary edges, and O(triangles).
void splitAtJunctions(TriangleMesh& mesh);

/// The neighbors of triangles across their edges.
struct MeshTopology {
    static constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max(),
                                   kMany = kNone - 1;

    /// Per triangle, the neighbor across the edge from corner k to k + 1; kNone at a boundary,
    /// kMany where three or more meet.
    std::vector<std::array<std::uint32_t, 3>> neighbor;
    std::vector<std::uint32_t> component;  ///< per triangle, from 0 on, by first triangle
    std::size_t components = 0;            ///< joined through edges of any kind
    std::size_t boundaryEdges = 0;         ///< of one triangle
    std::size_t nonManifoldEdges = 0;      ///< of three or more
    std::size_t nonOrientable = 0;         ///< components that cannot be oriented

    /// Whether every edge has two triangles, so that the mesh has an inside.
    bool closed() const { return boundaryEdges == 0 && nonManifoldEdges == 0; }
};
/// Time O(n log n).
MeshTopology meshTopology(const TriangleMesh& mesh);

/// Flips triangles so that neighbors traverse their common edge in opposite directions. Each part
/// joined through edges of two triangles takes the orientation of most of its triangles. At edges
/// of three or more, each part is oriented by the next. A component with one side only, as a
/// Moebius strip, keeps some inconsistent edges. Where the closed components enclose a negative
/// volume in all, their triangles are flipped, so that normals point out.
/// @return number of triangles flipped. Time O(n log n)
std::size_t orientConsistently(TriangleMesh& mesh);
/// The same with a known topology, which is updated.
std::size_t orientConsistently(TriangleMesh& mesh, MeshTopology& topology);

/// In squared units of the file. Time O(n).
double meshArea(const TriangleMesh& mesh);

/// The approximate number of voxels within `halfWidth` voxels of the mesh: the size of its grid.
double estimatedVoxels(const TriangleMesh& mesh, double dx, double halfWidth = 3);

/// @throws Error  InvalidArgument for a voxel size that is not positive, gives more than 1e9
///         voxels, or coordinates beyond 2^30 voxels; BadInput for a mesh without triangles
void requireReasonable(const TriangleMesh& mesh, double dx, double halfWidth = 3);

}  // namespace igeo
