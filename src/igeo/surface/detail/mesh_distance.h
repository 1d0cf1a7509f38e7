/// The voxels around a triangle mesh, and the point of it nearest to each.
#pragma once

#include <igeo/base/nearest_on_triangle.h>
#include <igeo/base/progress.h>
#include <igeo/io/triangle_mesh.h>

#include <vector>

namespace igeo {

/// A voxel near a mesh.
struct NearVoxel {
    std::uint32_t triangle;  ///< the nearest; on ties the first
    std::uint16_t offset;    ///< in its leaf
    std::uint8_t feature;    ///< NearestOnTriangle
    Vec3d point;             ///< relative to the voxel, voxels
};
/// The near voxels of a block of 8^3, by offset.
struct NearLeaf {
    Ijk origin;
    std::vector<NearVoxel> voxels;
    /// The triangles that may be within `reach` plus a voxel of a voxel of the leaf, ascending.
    std::vector<std::uint32_t> triangles;
};

/// All voxels less than `reach` voxels from the mesh, leaf by leaf in the order (x, y, z) of their
/// origins. The list is complete, and every point is the nearest one.
/// @param points     in index space
/// @throws Error  Cancelled through `progress`
/// Time O(triangles + voxels visited), in parallel. The same bits on any number of threads.
std::vector<NearLeaf> voxelsNear(const std::vector<Vec3d>& points,
                                 const std::vector<TriangleMesh::Triangle>& triangles, double reach,
                                 Progress& progress = Progress::none());

}  // namespace igeo
