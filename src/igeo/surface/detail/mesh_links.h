/// Which links of a mesh's band the mesh has. Internal.
#pragma once

#include <igeo/band/band.h>
#include <igeo/base/progress.h>
#include <igeo/surface/detail/mesh_distance.h>
#include <igeo/surface/detail/mesh_walk.h>

#include <vector>

namespace igeo {

/// A mesh and the band made of it.
struct MeshBand {
    const MeshAdjacency& adjacency;
    const std::vector<Vec3d>& faceNormal;
    const std::vector<NearLeaf>& leaves;  ///< voxels in the order of the band's nodes
    const Band& band;

    const NearVoxel& voxel(NodeIndex i) const {
        const LeafIndex l = band.leafOf(i);
        return leaves[l].voxels[i - band.leaves[l].band.firstNode];
    }
    /// The foot point of a node.
    MeshPoint foot(NodeIndex i) const {
        const NearVoxel& v = voxel(i);
        return {v.triangle, Vec3d(band.ijk(i)) + v.point};
    }
};

/// Links between neighbors that normals allow and the mesh does not: where a walk over triangles is
/// much longer than the path over the two tangent planes that a march takes it for, or where there
/// is none.
/// @throws Error  Cancelled through `progress`
/// Time O(triangles + nodes), in parallel: where the triangles around a leaf are joined and face
/// one way, nothing is asked of its nodes, and where nothing faces them, of the core alone.
/// @param on  its core numbered
std::vector<Link> linksOffMesh(const MeshBand& on, Progress& progress);

/// Bridges between core nodes up to three steps apart that the mesh joins by a short walk and that
/// have no path over one node in between: where sheets cross, or lie so close that voxels are used
/// up by others.
/// @param on  its core numbered, links severed
std::vector<Bridge> bridgesOnMesh(const MeshBand& on, Progress& progress);

/// The share of core nodes that links and bridges do not join with the largest part of their
/// component: what the voxels are too large for. 0 where no link is severed.
/// Time O(n log n).
double shareCutOff(const MeshBand& on);

/// Each pair once, and no more per node than a march holds; sorted.
std::vector<Bridge> thinned(std::vector<Bridge> bridges);

}  // namespace igeo
