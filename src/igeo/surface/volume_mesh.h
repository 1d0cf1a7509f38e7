/// The surface in a volume of voxels, as triangles.
#pragma once

#include <igeo/base/progress.h>
#include <igeo/io/triangle_mesh.h>
#include <igeo/io/voxel_volume.h>

#include <array>
#include <optional>
#include <string>

namespace igeo {

/// The values of a volume.
struct VolumeRange {
    float low = 0, high = 0;
    bool isMask = false;  ///< there are no others, and they differ
};
VolumeRange rangeOf(const VoxelVolume& volume);

/// A volume in numbers.
struct VolumeFacts {
    std::string kind;  ///< as in VoxelVolume
    std::array<std::size_t, 3> size{};
    Vec3d spacing;  ///< world, from a voxel to the next along i, j, k
    VolumeRange range;
};
VolumeFacts volumeFacts(const VoxelVolume& volume);

/// The surface where a volume, interpolated between the centers of its voxels, is `iso`: by
/// OpenVDB's tools::volumeToMesh in index space, then through the axes of the voxels, of whatever
/// lengths and angles. Normals point out of what is `iso` or more, or, where most voxels at the
/// border of the volume are that, out of what is less. It is open where it leaves the volume.
///
/// A mask (two values) is a staircase, on which ways are some per cent too long at any spacing. It
/// is smoothed first: values beside the surface are averaged with their neighbors, and every voxel
/// keeps its side (after the constraint of R. T. Whitaker, Reducing aliasing artifacts in
/// iso-surfaces of binary volumes, 2000). A warning says so.
/// @param iso  none: of a mask halfway between its values; other volumes need one
/// @throws Error  BadInput where there is no such surface and where `iso` is missing;
///         InvalidArgument for an `iso` beyond the values; Cancelled through `progress`
/// Time O(voxels). Memory 8 bytes per voxel while it works.
TriangleMesh volumeMesh(const VoxelVolume& volume, std::optional<double> iso,
                        Progress& progress = Progress::none());

}  // namespace igeo
