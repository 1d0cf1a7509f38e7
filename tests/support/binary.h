/// Bytes of binary files, as tests write them.
#pragma once

#include <igeo/base/detail/deflate.h>
#include <igeo/io/detail/little_endian.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

namespace igeo::test {

template <typename T>
std::string bytesOf(const std::vector<T>& values, bool bigEndian = false) {
    std::string bytes;
    for (const T value : values) {
        std::string one;
        if constexpr (sizeof(T) == 2)
            for (const unsigned shift : {0u, 8u}) one += char(std::uint16_t(value) >> shift & 0xff);
        else
            putLittleEndian(one, value);
        if (bigEndian) std::reverse(one.begin(), one.end());
        bytes += one;
    }
    return bytes;
}

/// As a gzip file holds them: the data of zlib's format with other ends.
inline std::string gzipped(const std::string& bytes) {
    const std::string packed = deflated(bytes);
    return std::string("\x1f\x8b\x08\0\0\0\0\0\0\xff", 10) + packed.substr(2, packed.size() - 6) +
           bytesOf(std::vector<std::uint32_t>{std::uint32_t(crc32Of(bytes)),
                                              std::uint32_t(bytes.size())});
}

}  // namespace igeo::test
