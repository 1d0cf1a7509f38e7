#include <igeo/io/volume_file.h>

#include <fmt/core.h>
#include <igeo/base/error.h>
#include <igeo/io/detail/file_bytes.h>
#include <igeo/io/detail/mgh_reader.h>
#include <igeo/io/detail/nifti_reader.h>
#include <igeo/io/detail/nrrd_reader.h>

#include <algorithm>
#include <cmath>

namespace igeo {

namespace {

using Kind = Error::Kind;

bool isNrrd(const std::string& ending) { return ending == ".nrrd" || ending == ".nhdr"; }
bool isMgh(const std::string& ending) { return ending == ".mgh" || ending == ".mgz"; }

void requireAxes(const VoxelVolume& volume) {
    double longest = 0;
    for (const Vec3d& axis : volume.axis) longest = std::max(longest, length(axis));
    const double solid = std::abs(dot(cross(volume.axis[0], volume.axis[1]), volume.axis[2]));
    constexpr double kFlat = 1e-9;
    if (std::isfinite(length(volume.origin)) && solid > kFlat * longest * longest * longest &&
        std::isfinite(solid))
        return;
    throw Error(Kind::BadInput,
                "the axes of the voxels in '" + volume.file +
                    "' have no length, lie in one plane or are not finite",
                "correct the affine transform in the file's header");
}

void requireValues(const VoxelVolume& volume) {
    const auto at = std::find_if(volume.values.begin(), volume.values.end(),
                                 [](float v) { return !std::isfinite(v); });
    if (at == volume.values.end()) return;
    const auto k = std::size_t(at - volume.values.begin());
    const auto& n = volume.size;
    throw Error(Kind::BadInput,
                fmt::format("the value of voxel {},{},{} in '{}' is {}", k % n[0], k / n[0] % n[1],
                            k / n[0] / n[1], volume.file, double(*at)),
                "write a number there, as 0 for what is outside");
}

}  // namespace

bool isVolumeFile(const std::string& file) {
    const std::string ending = endingBeforeGz(file);
    return isMgh(ending) || ending == ".nii" || ending == ".hdr" || ending == ".img" ||
           isNrrd(ending);
}

VoxelVolume readVolume(const std::string& file) {
    if (!isVolumeFile(file))
        throw Error(Kind::BadInput, "'" + file + "' is no volume by its name",
                    "volumes are read from .nii, .nii.gz, .hdr with .img, .mgz, .mgh, .nrrd and "
                    ".nhdr; .vdb files go to readLevelSetGrid");
    const std::string ending = endingBeforeGz(file);
    VoxelVolume volume = isNrrd(ending)  ? readNrrd(file, fileBytes(file))
                         : isMgh(ending) ? mghFrom(file, fileBytes(file))
                                         : readNifti(file);
    for (std::size_t a = 0; a < 3; ++a)
        if (volume.size[a] < 2)
            throw Error(Kind::BadInput,
                        fmt::format("'{}' is {} x {} x {} voxels: an image, not a volume", file,
                                    volume.size[0], volume.size[1], volume.size[2]),
                        "give all slices in one file");
    requireAxes(volume);
    requireValues(volume);
    return volume;
}

}  // namespace igeo
