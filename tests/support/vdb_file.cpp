#include "vdb_file.h"

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <stdexcept>

namespace igeo::test {
namespace {

/// A file starts with magic number (8 bytes), file version (4), library version (4 + 4), flag for
/// grid offsets (1), then the identifier as 36 characters.
constexpr std::size_t kIdOffset = 21, kIdLength = 36;

/// 64-bit FNV-1a hash of everything but the identifier.
std::uint64_t hashContents(const std::string& bytes, std::uint64_t hash) {
    for (std::size_t i = 0; i < bytes.size(); ++i) {
        if (i >= kIdOffset && i < kIdOffset + kIdLength) continue;
        hash = (hash ^ static_cast<unsigned char>(bytes[i])) * 0x100000001b3u;
    }
    return hash;
}

/// 128 bits in the form xxxxxxxx-xxxx-4xxx-8xxx-xxxxxxxxxxxx.
std::string formatId(std::uint64_t high, std::uint64_t low) {
    std::string id = "xxxxxxxx-xxxx-4xxx-8xxx-xxxxxxxxxxxx";
    int digit = 0;
    for (char& c : id) {
        if (c != 'x') continue;
        const std::uint64_t word = digit < 16 ? high : low;
        c = "0123456789abcdef"[(word >> (4 * (digit % 16))) & 15];
        ++digit;
    }
    return id;
}

void stabilizeId(const std::string& path) {
    std::fstream file(path, std::ios::binary | std::ios::in | std::ios::out);
    const std::string bytes{std::istreambuf_iterator<char>(file), {}};
    if (bytes.size() < kIdOffset + kIdLength || bytes[kIdOffset + 8] != '-')
        throw std::runtime_error("unexpected header in " + path);
    file.clear();
    file.seekp(kIdOffset);
    file << formatId(hashContents(bytes, 0xcbf29ce484222325u), hashContents(bytes, 1));
    if (!file.flush()) throw std::runtime_error("cannot write " + path);
}

}  // namespace

void writeVdb(const std::string& path, const openvdb::GridCPtrVec& grids) {
    const std::string temporary = path + ".part";
    try {
        openvdb::io::File file(temporary);
        file.write(grids);
        file.close();
        stabilizeId(temporary);
        std::filesystem::rename(temporary, path);
    } catch (...) {
        std::error_code ignored;
        std::filesystem::remove(temporary, ignored);
        throw;
    }
}

}  // namespace igeo::test
