/// The links of a mesh's band, checked against the mesh. Internal.
#pragma once

#include <igeo/band/band.h>
#include <igeo/base/progress.h>
#include <igeo/surface/detail/mesh_distance.h>
#include <igeo/surface/detail/mesh_walk.h>

#include <vector>

namespace igeo {

/// How much the mesh bends in a leaf: at each edge by less than 37 degrees; by more; or it turns
/// back, by more than about 102 degrees.
enum class LeafBend : std::uint8_t { Slight, Sharp, Fold };

/// A mesh and the band made of it.
struct MeshBand {
    const MeshAdjacency& adjacency;
    const std::vector<Vec3d>& faceNormal;
    const std::vector<NearLeaf>& leaves;  ///< voxels in the order of the band's nodes
    const std::vector<LeafBend>& bends;   ///< bendsOf
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

/// Per leaf. Time O(triangles of the leaves), in parallel.
std::vector<LeafBend> bendsOf(const MeshAdjacency& adjacency, const std::vector<Vec3d>& faceNormal,
                              const std::vector<NearLeaf>& leaves, Progress& progress);

/// From the foot point of node j to that of node i.
Vec3f chordOf(const Band& band, NodeIndex i, NodeIndex j);

/// The distance between two foot points as a march computes it: in the tangent plane of one.
/// @param chord  from the foot point of node j to that of node i
double flatLength(const Band& band, NodeIndex i, const Vec3f& chord, NodeIndex j);

/// The same, not less than that in space.
double arcOf(const Band& band, NodeIndex i, const Vec3f& chord, NodeIndex j);

/// The longest walk that a link with this arc may represent.
inline double longestFor(double arc) { return 1.25 * arc + 0.25; }

/// Whether three or more triangles meet in an edge in a leaf or one beside it.
bool pagesMeetNear(const MeshBand& on, LeafIndex l);

/// Whether the mesh ends in a leaf or beside it: links may cut the corner of a rim.
bool hasRim(const MeshBand& on, LeafIndex l);

/// Severs the links between neighbors that normals allow but the mesh does not have: where a walk
/// over triangles is much longer than the path over the two tangent planes, which a march uses as
/// its length, or where there is no walk.
/// @throws Error  Cancelled through `progress`
/// Time O(triangles + nodes), in parallel: leaves whose triangles are connected and face one
/// direction are skipped, and leaves where no sheet faces another are tested at the core only, and
/// beside links that are severed.
/// @param on    its core numbered
/// @param band  that of `on`
void severOffMesh(const MeshBand& on, Band& band, Progress& progress);

/// Links of the core over bends of the mesh, with their lengths along it: where normals differ by
/// more than 10 degrees, or voxels between lie over other faces, and the walk is not as long as the
/// path over the two tangent planes.
/// @throws Error  Cancelled through `progress`
/// Time O(nodes), in parallel.
/// @param on  its core numbered, links severed
std::vector<StretchedLink> stretchedOnMesh(const MeshBand& on, Progress& progress);

}  // namespace igeo
