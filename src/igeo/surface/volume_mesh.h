/// The surface of a volume of voxels, as triangles.
#pragma once

#include <igeo/base/progress.h>
#include <igeo/io/triangle_mesh.h>
#include <igeo/io/voxel_volume.h>

#include <array>
#include <optional>
#include <string>

namespace igeo {

/// The range of a volume's values.
struct VolumeRange {
    float low = 0, high = 0;
    bool isMask = false;  ///< it has only these two values, and they differ
};
VolumeRange rangeOf(const VoxelVolume& volume);

/// Facts about a volume.
struct VolumeFacts {
    std::string kind;  ///< as in VoxelVolume
    std::array<std::size_t, 3> size{};
    Vec3d spacing;  ///< world, between neighboring voxels along i, j, k
    VolumeRange range;
};
VolumeFacts volumeFacts(const VoxelVolume& volume);

/// The surface where a volume, interpolated between the centers of its voxels, is `iso`: by
/// OpenVDB's tools::volumeToMesh in index space, then through the axes of the voxels, of any
/// lengths and angles. Normals point out of the part with values of `iso` or more; where most
/// border voxels of the volume belong to that part, out of the other. The mesh is open where it
/// leaves the volume.
///
/// A mask (two values) is a staircase, on which paths are some percent too long at any spacing. It
/// is smoothed first: values next to the surface are averaged with their neighbors, and every voxel
/// keeps its side (after the constraint of R. T. Whitaker, Reducing aliasing artifacts in
/// iso-surfaces of binary volumes, 2000). A warning says so, and that `iso` has no effect then.
/// @param iso  none: for a mask halfway between its values; other volumes need one
/// @throws Error  BadInput where there is no such surface and where `iso` is missing;
///         InvalidArgument for an `iso` beyond the values; Cancelled through `progress`
/// Time O(voxels). Working memory 8 bytes per voxel.
TriangleMesh volumeMesh(const VoxelVolume& volume, std::optional<double> iso,
                        Progress& progress = Progress::none());

}  // namespace igeo
