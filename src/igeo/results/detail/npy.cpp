#include <igeo/results/detail/npy.h>

#include <fmt/core.h>
#include <igeo/io/detail/little_endian.h>

namespace igeo {

std::string npy(const std::vector<double>& values, const std::string& shape) {
    // Magic, version, length of the header; the header fills the rest of a multiple of 64 bytes.
    constexpr std::size_t kFixed = 10, kAlign = 64;
    std::string header =
        fmt::format("{{'descr': '<f8', 'fortran_order': False, 'shape': {}, }}", shape);
    header.resize((kFixed + header.size() + 1 + kAlign - 1) / kAlign * kAlign - kFixed - 1, ' ');
    header += '\n';
    std::string bytes = "\x93NUMPY";
    bytes += {char(1), char(0), char(header.size() & 0xff), char(header.size() >> 8)};
    bytes += header;
    bytes.reserve(bytes.size() + 8 * values.size());
    for (const double d : values) putLittleEndian(bytes, d);
    return bytes;
}

}  // namespace igeo
