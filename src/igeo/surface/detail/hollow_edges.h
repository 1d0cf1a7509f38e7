/// Hollow edges that a conversion from a mesh has rounded. Internal.
#pragma once

#include <openvdb/openvdb.h>

#include <vector>

namespace igeo {

/// A voxel and the value that it had, in world units.
struct LoweredVoxel {
    openvdb::Coord at;
    float was;
};

/// The voxels that OpenVDB's meshToVolume has lowered in front of hollow edges, in tree order.
///
/// That function ends with a step of renormalization (Renormalize in tools/MeshToVolume.h). In
/// front of a hollow edge the step lowers psi by up to a voxel, as if the edge were rounded, and
/// distances over it come out up to 0.9 voxels too short. Before the step psi was the height over
/// the nearer of the planes of both faces, which the voxels inside still show. A voxel counts if
/// the step makes its value of these heights. None counts if the step would have lowered many
/// others that have not been: then psi is no such conversion. Time O(voxels with a kink), in
/// parallel.
std::vector<LoweredVoxel> loweredAtHollowEdges(const openvdb::FloatTree& psi, double dx);

}  // namespace igeo
