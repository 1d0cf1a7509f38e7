#include <igeo/io/detail/voxel_values.h>

#include <fmt/core.h>
#include <igeo/base/detail/deflate.h>
#include <igeo/io/detail/file_bytes.h>

namespace igeo {

const char* nameOf(NumberType type) {
    constexpr const char* kNames[] = {"uint8", "int8",   "uint16", "int16",   "uint32",
                                      "int32", "uint64", "int64",  "float32", "float64"};
    return kNames[std::size_t(type)];
}

std::size_t voxelCount(const std::string& file, const std::array<std::size_t, 3>& size) {
    constexpr std::size_t kMost = std::size_t(1) << 34;
    std::size_t count = 1;
    for (const std::size_t n : size) {
        if (n == 0 || n > kMost / count)
            throw Error(Error::Kind::BadInput,
                        fmt::format("'{}' announces {} x {} x {} voxels; 1 to 2^34 are read", file,
                                    size[0], size[1], size[2]),
                        "the file is broken, or has to be resampled");
        count *= n;
    }
    return count;
}

std::string rawDataOf(const std::string& file, std::string_view data, std::size_t begin,
                      std::size_t end) {
    if (data.size() < end)
        throw Error(Error::Kind::BadInput,
                    fmt::format("'{}' ends after {} of {} bytes", file, data.size(), end),
                    "the file is cut off: write it again");
    return std::string(data.substr(begin, end - begin));
}

std::string dataOf(const std::string& file, std::string_view data, std::size_t begin,
                   std::size_t end) {
    if (!isGzip(data)) return rawDataOf(file, data, begin, end);
    const std::string start = naming("'" + file + "'", [&] { return inflatedStart(data, end); });
    return rawDataOf(file, start, begin, end);
}

std::vector<float> voxelsOf(const std::string& file, std::string_view bytes, NumberType type,
                            bool bigEndian, double scale, double shift) {
    ByteReader reader(file, bytes, bigEndian);
    std::vector<float> values(bytes.size() / sizeOf(type));
    for (float& value : values) value = float(scale * reader.next(type) + shift);
    return values;
}

}  // namespace igeo
