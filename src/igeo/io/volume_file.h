/// Volumes of voxels from files: images of heads, masks, scans.
#pragma once

#include <igeo/base/types.h>

#include <array>
#include <cstddef>
#include <string>
#include <vector>

namespace igeo {

/// A value per voxel, and where the voxels lie.
struct VoxelVolume {
    std::string file;  ///< as named, for messages
    std::string kind;  ///< in words: "NIfTI-1, int16"
    std::array<std::size_t, 3> size{};
    std::vector<float> values;    ///< i + size[0] (j + size[1] k); finite
    std::array<Vec3d, 3> axis{};  ///< world, from a voxel to the next along i, j, k; of any lengths
                                  ///< and angles
    Vec3d origin;                 ///< world, the center of voxel 0,0,0
    std::vector<std::string> warnings = {};

    Vec3d worldFromIndex(const Vec3d& p) const {
        return origin + p.x * axis[0] + p.y * axis[1] + p.z * axis[2];
    }
    /// Whether i, j, k is a left-handed system.
    bool mirrors() const { return dot(cross(axis[0], axis[1]), axis[2]) < 0; }
    /// The shortest step to the next voxel, world.
    double finestSpacing() const;
};

/// Whether a file is a volume by the ending of its name, in any case: .nii .hdr .img (.gz too),
/// .nrrd .nhdr.
bool isVolumeFile(const std::string& file);

/// Reads a volume: NIfTI-1 and NIfTI-2, in one file or as a pair of .hdr and .img, with gzip or
/// without; and NRRD, raw, gzip or text, with the data in it or in one file beside it.
///
/// World positions are those of the file, in its unit, which is the millimeter as a rule: of NIfTI
/// by the sform or, if there is none, the qform, with x to the right, y to the front, z up (RAS);
/// of NRRD by its directions and origin, in the space that it names, mostly LPS. Nothing is
/// converted between the two. Scale and intercept of NIfTI are applied.
/// @throws Error  Io where a file cannot be read; BadInput for other kinds of files, damaged ones
///         and those that end too early, volumes of several frames or channels, values that are not
///         finite (with the voxel), an axis of one voxel and axes that lie in one plane
/// Time O(size). Memory O(size), whatever counts the file announces.
VoxelVolume readVolume(const std::string& file);

}  // namespace igeo
