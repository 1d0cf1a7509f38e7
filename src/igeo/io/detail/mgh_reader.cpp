#include <igeo/io/detail/mgh_reader.h>

#include <fmt/core.h>
#include <igeo/base/detail/deflate.h>
#include <igeo/io/detail/byte_reader.h>
#include <igeo/io/detail/file_bytes.h>
#include <igeo/io/detail/voxel_values.h>

#include <utility>

namespace igeo {

namespace {

using Type = NumberType;

constexpr std::size_t kHeaderSize = 284;  // bytes, most of them unused

Type typeOf(std::int32_t code, const std::string& file) {
    static constexpr std::pair<int, Type> kTypes[] = {
        {0, Type::U8}, {1, Type::I32}, {3, Type::F32}, {4, Type::I16}, {10, Type::U16}};
    for (const auto& [known, type] : kTypes)
        if (code == known) return type;
    refuseFile(file, fmt::format("has voxels of type {}, which is none of MGH's numbers", code),
               "convert it to one number per voxel: mri_convert -odt float");
}

void readSize(ByteReader& reader, VoxelVolume& volume) {
    for (std::size_t& n : volume.size) {
        const auto along = reader.next<std::int32_t>();
        if (along < 1)
            refuseFile(volume.file, fmt::format("has a dimension of {} voxels", along),
                       "the header is broken");
        n = std::size_t(along);
    }
    if (const auto frames = reader.next<std::int32_t>(); frames != 1)
        refuseFile(volume.file, fmt::format("holds {} volumes, as of several times", frames),
                   "write the one that counts into a file of its own: mri_convert --frame 0");
}

/// Reads the spacings, the directions of the axes, and the center of the volume.
void readPlace(ByteReader& reader, VoxelVolume& volume) {
    double spacing[3] = {1, 1, 1};
    volume.axis = {Vec3d{-1, 0, 0}, Vec3d{0, 0, -1}, Vec3d{0, 1, 0}};
    Vec3d center;
    if (reader.next<std::int16_t>() > 0) {
        const auto read = [&](Vec3d& v) {
            for (int r = 0; r < 3; ++r) v[r] = double(reader.next<float>());
        };
        for (double& s : spacing) s = double(reader.next<float>());
        for (Vec3d& axis : volume.axis) read(axis);
        read(center);
    } else {
        volume.warnings.push_back(
            "the header has no orientation: voxels of 1 mm in coronal slices about the origin are "
            "taken, as FreeSurfer does");
    }
    volume.origin = center;
    for (std::size_t k = 0; k < 3; ++k) {
        volume.axis[k] = spacing[k] * volume.axis[k];
        volume.origin = volume.origin - 0.5 * double(volume.size[k]) * volume.axis[k];
    }
}

}  // namespace

VoxelVolume mghFrom(const std::string& file, const std::string& bytes) {
    VoxelVolume volume;
    volume.file = file;
    std::string header = bytes.substr(0, kHeaderSize);
    if (isGzip(bytes))
        header = naming("'" + file + "'", [&] { return inflatedStart(bytes, kHeaderSize); });
    if (header.size() < kHeaderSize || ByteReader(file, header, true).next<std::int32_t>() != 1)
        refuseFile(file, "is no MGH file of version 1, or its header is cut off",
                   "write it again, as .mgh or .mgz");
    ByteReader reader(file, header, /*bigEndian=*/true);
    reader.skip(sizeof(std::int32_t));  // the version
    readSize(reader, volume);
    const Type type = typeOf(reader.next<std::int32_t>(), file);
    reader.skip(sizeof(std::int32_t));  // degrees of freedom
    readPlace(reader, volume);
    volume.kind = fmt::format("MGH, {}", nameOf(type));
    const std::size_t count = voxelCount(file, volume.size);
    const std::string raw = dataOf(file, bytes, kHeaderSize, kHeaderSize + count * sizeOf(type));
    volume.values = voxelsOf(file, raw, type, /*bigEndian=*/true);
    return volume;
}

}  // namespace igeo
