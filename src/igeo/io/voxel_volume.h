/// A volume of voxels.
#pragma once

#include <igeo/base/types.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <string>
#include <vector>

namespace igeo {

/// A value per voxel, and the position of the voxels.
struct VoxelVolume {
    std::string file;  ///< as given, for messages
    std::string kind;  ///< in words: "NIfTI-1, int16"
    std::array<std::size_t, 3> size{};
    std::vector<float> values;  ///< i + size[0] (j + size[1] k); finite
    /// World, steps to the next voxel along i, j, k; any lengths and angles
    std::array<Vec3d, 3> axis{};
    Vec3d origin;  ///< world, the center of voxel 0,0,0
    std::vector<std::string> warnings = {};

    Vec3d worldFromIndex(const Vec3d& p) const {
        return origin + p.x * axis[0] + p.y * axis[1] + p.z * axis[2];
    }
    /// Whether i, j, k is a left-handed system.
    bool mirrors() const { return dot(cross(axis[0], axis[1]), axis[2]) < 0; }
    /// The shortest step to a neighboring voxel, world.
    double finestSpacing() const {
        return std::min({length(axis[0]), length(axis[1]), length(axis[2])});
    }
};

}  // namespace igeo
