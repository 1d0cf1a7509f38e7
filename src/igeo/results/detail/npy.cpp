#include <igeo/results/detail/npy.h>

#include <fmt/core.h>
#include <igeo/base/detail/deflate.h>
#include <igeo/base/error.h>
#include <igeo/io/detail/little_endian.h>

#include <limits>

namespace igeo {

namespace {

template <typename T>
std::string npyOf(const std::vector<T>& values, const char* type, const std::string& shape) {
    // Magic, version, length of the header; the header is padded to a multiple of 64 bytes.
    constexpr std::size_t kFixed = 10, kAlign = 64;
    std::string header =
        fmt::format("{{'descr': '{}', 'fortran_order': False, 'shape': {}, }}", type, shape);
    header.resize((kFixed + header.size() + 1 + kAlign - 1) / kAlign * kAlign - kFixed - 1, ' ');
    header += '\n';
    std::string bytes = "\x93NUMPY";
    bytes += {char(1), char(0), char(header.size() & 0xff), char(header.size() >> 8)};
    bytes += header;
    bytes.reserve(bytes.size() + sizeof(T) * values.size());
    for (const T v : values) putLittleEndian(bytes, v);
    return bytes;
}

/// The common part of a zip entry's header and its directory record, from the required version on:
/// stored, dated 1980-01-01.
std::string zipFacts(const std::string& content, const std::string& name) {
    constexpr std::uint16_t kZipVersion = 20, kStored = 0, kDay = 1 << 5 | 1;
    std::string bytes;
    for (const std::uint16_t field :
         {kZipVersion, std::uint16_t(0), kStored, std::uint16_t(0), kDay})
        putLittleEndian(bytes, field);
    for (const std::size_t field : {std::size_t(crc32Of(content)), content.size(), content.size()})
        putLittleEndian(bytes, std::uint32_t(field));
    putLittleEndian(bytes, std::uint16_t(name.size()));
    putLittleEndian(bytes, std::uint16_t(0));  // length of extra fields
    return bytes;
}

void requirePlainZip(const std::vector<std::pair<std::string, std::string>>& arrays) {
    constexpr std::size_t kPerArray = 1024;  // more than headers and names need
    std::size_t size = 0;
    for (const auto& array : arrays) size += array.second.size() + kPerArray;
    if (size > std::numeric_limits<std::uint32_t>::max())
        throw Error(
            Error::Kind::InvalidArgument,
            fmt::format("arrays of {:.1f} GB in one .npz file, which holds 4", double(size) / 1e9),
            "write .npy, which holds any number");
}

}  // namespace

std::string npy(const std::vector<double>& values, const std::string& shape) {
    return npyOf(values, "<f8", shape);
}

std::string npy(const std::vector<std::int32_t>& values, const std::string& shape) {
    return npyOf(values, "<i4", shape);
}

std::string npz(const std::vector<std::pair<std::string, std::string>>& arrays) {
    constexpr std::uint32_t kEntry = 0x04034b50, kPlace = 0x02014b50, kEnd = 0x06054b50;
    constexpr std::uint16_t kZipVersion = 20;
    requirePlainZip(arrays);
    std::string bytes, directory;
    for (const auto& [array, content] : arrays) {
        const std::string name = array + ".npy", facts = zipFacts(content, name);
        putLittleEndian(directory, kPlace);
        putLittleEndian(directory, kZipVersion);
        directory += facts;
        // Comment, disk and attributes: empty.
        directory.append(10, '\0');
        putLittleEndian(directory, std::uint32_t(bytes.size()));
        directory += name;
        putLittleEndian(bytes, kEntry);
        bytes += facts;
        bytes += name;
        bytes += content;
    }
    const auto begin = std::uint32_t(bytes.size()), size = std::uint32_t(directory.size());
    bytes += directory;
    putLittleEndian(bytes, kEnd);
    putLittleEndian(bytes, std::uint32_t(0));  // disks
    for (int k = 0; k < 2; ++k) putLittleEndian(bytes, std::uint16_t(arrays.size()));
    putLittleEndian(bytes, size);
    putLittleEndian(bytes, begin);
    putLittleEndian(bytes, std::uint16_t(0));  // comment
    return bytes;
}

}  // namespace igeo
