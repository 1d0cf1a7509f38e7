/// Hollow edges that a conversion from a mesh has rounded. Internal.
#pragma once

#include <igeo/surface/detail/leaf_block.h>
#include <openvdb/openvdb.h>

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

namespace igeo {

/// Voxels: what the last step of OpenVDB's meshToVolume takes psi relative to (renormalization.h).
constexpr double kRenormalizedAbout = 0.8;

/// A voxel and the value that it had, in world units.
struct LoweredVoxel {
    openvdb::Coord at;
    float was;
    float off;  ///< voxels: from what the step makes of it
};

/// Voxels that the last step of OpenVDB's meshToVolume has lowered in front of hollow edges.
///
/// There the step (renormalization.h) lowers psi by up to a voxel, as if the edge were rounded, and
/// distances over it come out up to 0.9 voxels too short. Before the step psi was the height over
/// the nearer of the planes of both faces, which the voxels inside still show. A voxel counts if
/// the step makes its value of these heights.
class HollowEdges {
public:
    /// Bits of the voxels of a leaf, by row.
    using Bits = std::array<std::uint8_t, 64>;
    /// What psi in a leaf shows.
    struct Shown {
        Bits plane;  ///< psi around the voxel is that of one face
        Bits mayBeLowered;
    };
    /// @param block  with its faces
    static Shown shownBy(const LeafBlock& block);

    /// @param shown  by the number of the leaf, which is in its transient data
    HollowEdges(const openvdb::FloatTree& psi, double dx, const std::vector<Shown>& shown);
    ~HollowEdges();

    /// Adds those of one leaf. Time O(voxels with a kink beside a face).
    void look(const LeafBlock::Leaf& leaf, std::vector<LoweredVoxel>& lowered);

private:
    class Before;
    std::unique_ptr<Before> before_;
    const std::vector<Shown>& shown_;
    double dx_;
};

}  // namespace igeo
