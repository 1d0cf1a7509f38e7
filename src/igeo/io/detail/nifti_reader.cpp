#include <igeo/io/detail/nifti_reader.h>

#include <fmt/core.h>
#include <igeo/base/detail/deflate.h>
#include <igeo/io/detail/byte_reader.h>
#include <igeo/io/detail/file_bytes.h>
#include <igeo/io/detail/voxel_values.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>
#include <utility>

namespace igeo {

namespace {

using Type = NumberType;

/// Byte offsets of the header's fields; NIfTI-2 has wider numbers.
struct Layout {
    std::size_t size, magic, dim, datatype, pixdim, dataOffset, slope, intercept, qform, sform,
        quaternion, shift, rows;
    Type dimType, offsetType, real, code;
};
constexpr Layout kNifti1{348, 344, 40,  70,  76,        108,       112,       116,      252,
                         254, 256, 268, 280, Type::I16, Type::F32, Type::F32, Type::I16};
constexpr Layout kNifti2{540, 4,   16,  12,  104,       168,       176,       184,      344,
                         348, 352, 376, 400, Type::I64, Type::I64, Type::F64, Type::I32};

class NiftiHeader {
public:
    NiftiHeader(const std::string& file, const std::string& bytes) : file_(file), bytes_(bytes) {
        for (const bool big : {false, true}) {
            bigEndian_ = big;
            if (bytes.size() < 4) break;
            const double size = number(0, Type::I32);
            for (const Layout* layout : {&kNifti1, &kNifti2})
                if (size == double(layout->size) && bytes.size() >= layout->size) {
                    at_ = layout;
                    requireMagic();
                    return;
                }
        }
        refuseFile(file, "is no NIfTI file, or its header is cut off",
                   "write it again, as .nii or .nii.gz");
    }

    const Layout& at() const { return *at_; }
    bool bigEndian() const { return bigEndian_; }
    int version() const { return at_ == &kNifti1 ? 1 : 2; }
    /// Whether the voxels are in a separate file.
    bool isPair() const { return bytes_.compare(at_->magic, 2, "ni") == 0; }
    double number(std::size_t offset, Type type, std::size_t index = 0) const {
        ByteReader reader(file_, bytes_, bigEndian_);
        reader.skip(offset + index * sizeOf(type));
        return reader.next(type);
    }

private:
    void requireMagic() const {
        const char digit = version() == 1 ? '1' : '2';
        const std::string magic = bytes_.substr(at_->magic, 3);
        if (magic == std::string("n+") + digit || magic == std::string("ni") + digit) return;
        refuseFile(file_,
                   "is an image of ANALYZE, or broken: its header does not say that it is NIfTI",
                   "convert it to .nii.gz, which says where its voxels lie");
    }

    const std::string& file_;
    const std::string& bytes_;
    const Layout* at_ = nullptr;
    bool bigEndian_ = false;
};

void readSize(const NiftiHeader& header, VoxelVolume& volume) {
    const Layout& at = header.at();
    const double dims = header.number(at.dim, at.dimType);
    if (!(dims >= 1 && dims <= 7))
        refuseFile(volume.file, fmt::format("has {} dimensions", dims), "the header is broken");
    const auto along = [&](std::size_t d) {
        const double n = double(d) <= dims ? header.number(at.dim, at.dimType, d) : 1;
        if (n < 1 || n > 0x1p31)
            refuseFile(volume.file, fmt::format("has a dimension of {} voxels", n),
                       "the header is broken");
        return n;
    };
    for (std::size_t a = 0; a < 3; ++a) volume.size[a] = std::size_t(along(a + 1));
    const double frames = along(4) * along(5) * along(6) * along(7);
    if (frames > 1)
        refuseFile(volume.file, fmt::format("holds {} volumes, as of several times", frames),
                   "write the one you need into a file of its own, for instance by nibabel: "
                   "img.slicer[..., 0]");
}

Type typeOf(const NiftiHeader& header, const std::string& file) {
    static constexpr std::pair<int, Type> kTypes[] = {
        {2, Type::U8},   {4, Type::I16},   {8, Type::I32},   {16, Type::F32},   {64, Type::F64},
        {256, Type::I8}, {512, Type::U16}, {768, Type::U32}, {1024, Type::I64}, {1280, Type::U64}};
    const double code = header.number(header.at().datatype, Type::I16);
    for (const auto& [known, type] : kTypes)
        if (code == known) return type;
    refuseFile(file, fmt::format("has voxels of type {}, which is no real number", code),
               "convert it to one number per voxel, as float32");
}

/// Rows of the matrix from index to world space.
using Rows = std::array<std::array<double, 4>, 3>;

Rows rowsOfQuaternion(const NiftiHeader& header) {
    const Layout& at = header.at();
    const auto q = [&](std::size_t k) { return header.number(at.quaternion, at.real, k); };
    const double b = q(0), c = q(1), d = q(2);
    const double a = std::sqrt(std::max(0.0, 1 - (b * b + c * c + d * d)));
    const std::array<std::array<double, 3>, 3> turn{
        {{a * a + b * b - c * c - d * d, 2 * (b * c - a * d), 2 * (b * d + a * c)},
         {2 * (b * c + a * d), a * a + c * c - b * b - d * d, 2 * (c * d - a * b)},
         {2 * (b * d - a * c), 2 * (c * d + a * b), a * a + d * d - b * b - c * c}}};
    const double handed = header.number(at.pixdim, at.real) < 0 ? -1 : 1;
    Rows rows{};
    for (std::size_t r = 0; r < 3; ++r) {
        for (std::size_t k = 0; k < 3; ++k)
            rows[r][k] = turn[r][k] * header.number(at.pixdim, at.real, k + 1);
        rows[r][2] *= handed;
        rows[r][3] = header.number(at.shift, at.real, r);
    }
    return rows;
}

Rows rowsOf(const NiftiHeader& header, std::vector<std::string>& warnings) {
    const Layout& at = header.at();
    Rows rows{};
    if (header.number(at.sform, at.code) > 0) {
        for (std::size_t r = 0; r < 3; ++r)
            for (std::size_t k = 0; k < 4; ++k)
                rows[r][k] = header.number(at.rows, at.real, 4 * r + k);
        return rows;
    }
    if (header.number(at.qform, at.code) > 0) return rowsOfQuaternion(header);
    warnings.push_back(
        "the header has neither sform nor qform: voxel 0,0,0 is taken for the origin, and its axes "
        "for x, y and z");
    for (std::size_t k = 0; k < 3; ++k) rows[k][k] = header.number(at.pixdim, at.real, k + 1);
    return rows;
}

/// The name of the other file of a pair: `from` replaced by `to` in the ending.
std::string besides(const std::string& file, const std::string& from, const std::string& to) {
    std::string other = file;
    const auto at = other.rfind(from);
    if (at != other.npos) other.replace(at, from.size(), to);
    return other;
}

/// `name`, or `name` with .gz added or removed, whichever exists.
std::string eitherOf(const std::string& name) {
    std::error_code ignored;
    const std::string other =
        name.ends_with(".gz") ? name.substr(0, name.size() - 3) : name + ".gz";
    const bool isOther =
        !std::filesystem::exists(name, ignored) && std::filesystem::exists(other, ignored);
    return isOther ? other : name;
}

}  // namespace

VoxelVolume niftiFrom(const std::string& file, const std::string& header, const std::string& data) {
    VoxelVolume volume;
    volume.file = file;
    std::string begin = header.substr(0, kNifti2.size);
    if (isGzip(header))
        begin = naming("'" + file + "'", [&] { return inflatedStart(header, kNifti2.size); });
    const NiftiHeader head(file, begin);
    const Layout& at = head.at();
    readSize(head, volume);
    const Type type = typeOf(head, file);
    volume.kind = fmt::format("NIfTI-{}, {}", head.version(), nameOf(type));

    const Rows rows = rowsOf(head, volume.warnings);
    for (int r = 0; r < 3; ++r) {
        for (std::size_t k = 0; k < 3; ++k) volume.axis[k][r] = rows[std::size_t(r)][k];
        volume.origin[r] = rows[std::size_t(r)][3];
    }
    const std::size_t count = voxelCount(file, volume.size);
    const double offset = head.number(at.dataOffset, at.offsetType);
    const double least = head.isPair() ? 0 : double(at.size);
    if (!(offset >= least && offset <= 0x1p31))
        refuseFile(file, fmt::format("has its voxels from byte {} on, within its header", offset),
                   "the header is broken");
    const std::string raw = dataOf(file, head.isPair() ? data : header, std::size_t(offset),
                                   std::size_t(offset) + count * sizeOf(type));
    double slope = head.number(at.slope, at.real), shift = head.number(at.intercept, at.real);
    if (slope == 0 || !std::isfinite(slope) || !std::isfinite(shift)) slope = 1, shift = 0;
    volume.values = voxelsOf(file, raw, type, head.bigEndian(), slope, shift);
    return volume;
}

std::string otherOfPair(const std::string& file) {
    const std::string ending = endingBeforeGz(file);
    if (ending == ".nii") return "";
    const std::string written = std::filesystem::path(file.ends_with(".gz") || file.ends_with(".GZ")
                                                          ? file.substr(0, file.size() - 3)
                                                          : file)
                                    .extension()
                                    .string();
    const bool upper = written == ".HDR" || written == ".IMG";
    const char *const hdr = upper ? ".HDR" : ".hdr", *const img = upper ? ".IMG" : ".img";
    return eitherOf(ending == ".hdr" ? besides(file, hdr, img) : besides(file, img, hdr));
}

VoxelVolume readNifti(const std::string& file) {
    const std::string ending = endingBeforeGz(file), other = otherOfPair(file);
    if (other.empty()) return niftiFrom(file, fileBytes(file), "");
    if (ending == ".hdr") return niftiFrom(file, fileBytes(file), fileBytes(other));
    return niftiFrom(file, fileBytes(other), fileBytes(file));
}

}  // namespace igeo
