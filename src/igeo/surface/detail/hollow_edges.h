/// Hollow edges that a conversion from a mesh has rounded. Internal.
#pragma once

#include <igeo/surface/detail/leaf_block.h>
#include <openvdb/openvdb.h>

#include <memory>
#include <vector>

namespace igeo {

/// Voxels: what the last step of OpenVDB's meshToVolume takes psi relative to (renormalization.h).
constexpr double kRenormalizedAbout = 0.8;

/// A voxel and the value that it had, in world units.
struct LoweredVoxel {
    openvdb::Coord at;
    float was;
};

/// Voxels that the last step of OpenVDB's meshToVolume has lowered in front of hollow edges.
///
/// There the step (renormalization.h) lowers psi by up to a voxel, as if the edge were rounded, and
/// distances over it come out up to 0.9 voxels too short. Before the step psi was the height over
/// the nearer of the planes of both faces, which the voxels inside still show. A voxel counts if
/// the step makes its value of these heights.
class HollowEdges {
public:
    HollowEdges(const openvdb::FloatTree& psi, double dx);
    ~HollowEdges();

    /// Adds those of one leaf. Time O(voxels with a kink).
    /// @param block  of this leaf, with its faces
    void look(const LeafBlock& block, const openvdb::Coord& origin,
              std::vector<LoweredVoxel>& lowered);

private:
    class Before;
    std::unique_ptr<Before> before_;
    double dx_;
};

}  // namespace igeo
