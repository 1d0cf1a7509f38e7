/// A triangle mesh as it was given: welded, counted, oriented.
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

    std::string file;           ///< as named, for messages
    std::vector<Vec3d> points;  ///< in the file's units
    std::vector<Triangle> triangles;
    std::size_t dropped = 0;            ///< triangles with two equal corners, or repeated
    std::size_t repeated = 0;           ///< of them those that have the corners of another
    std::vector<std::string> warnings;  ///< what a user should know, one sentence each

    static constexpr std::uint32_t kNoPoint = std::numeric_limits<std::uint32_t>::max();
    /// The file's own vertices and faces; null for kinds of files that have no such numbers (STL).
    std::shared_ptr<const PolygonMesh> source;
    /// Per vertex of the file its point; kNoPoint where no triangle uses it.
    std::vector<std::uint32_t> pointOfVertex;
};

/// Makes one point of those that are equal, so that triangles know their neighbors; drops
/// triangles left with fewer than three corners, triangles that are there twice (in any
/// orientation) and points that nothing uses.
///
/// A point within 1e-6 of the bounding box's diagonal from an earlier one is taken for it. Files
/// with a point per corner (STL) hold each point several times, rounded in different ways: single
/// precision is good to 6e-8 of the coordinate. A triangle of three corners on one line stays: it
/// holds its neighbors together. Keeps the order of what is left, and fills
/// pointOfVertex where there is a source, whose vertices are the points in their order. Time O(n).
void weld(TriangleMesh& mesh);

/// Which triangles meet along which edges.
struct MeshTopology {
    static constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max(),
                                   kMany = kNone - 1;

    /// Per triangle, the one beyond the edge from corner k to k + 1; kNone at a boundary, kMany
    /// where three or more meet.
    std::vector<std::array<std::uint32_t, 3>> neighbor;
    std::vector<std::uint32_t> component;  ///< per triangle, from 0 on, by first triangle
    std::size_t components = 0;            ///< joined through edges of any kind
    std::size_t boundaryEdges = 0;         ///< of one triangle
    std::size_t nonManifoldEdges = 0;      ///< of three or more
    std::size_t nonOrientable = 0;         ///< components in which no turning helps

    /// Every edge has two triangles, so that the mesh has an inside.
    bool closed() const { return boundaryEdges == 0 && nonManifoldEdges == 0; }
};
/// Time O(n log n).
MeshTopology meshTopology(const TriangleMesh& mesh);

/// Turns triangles over, so that neighbors run along their edge in opposite ways: in each part
/// joined through edges of two triangles as most of it had it. Where three or more meet, each goes
/// on in the next. Where a component has one side only, as a Moebius strip, some edges stay as they
/// are.
/// @return triangles turned
std::size_t orientConsistently(TriangleMesh& mesh);
/// The same where the topology is known, which is turned with the triangles.
std::size_t orientConsistently(TriangleMesh& mesh, MeshTopology& topology);

/// In the file's units, squared.
double meshArea(const TriangleMesh& mesh);

/// Voxels within `halfWidth` voxels of the mesh, about: what a grid of that voxel size will hold.
double estimatedVoxels(const TriangleMesh& mesh, double dx, double halfWidth = 3);

/// @throws Error  InvalidArgument for a voxel size that is not positive, asks for more than 1e9
///         voxels, or leaves coordinates beyond 2^30 voxels; BadInput for a mesh without triangles
void requireReasonable(const TriangleMesh& mesh, double dx, double halfWidth = 3);

}  // namespace igeo
