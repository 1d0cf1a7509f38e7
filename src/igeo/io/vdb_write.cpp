#include <igeo/io/vdb_write.h>

#include <fmt/core.h>
#include <igeo/base/atomic_file.h>
#include <igeo/base/digest.h>
#include <igeo/base/version.h>
#include <openvdb/io/Archive.h>

#include <cerrno>
#include <filesystem>
#include <sstream>

namespace igeo {

namespace {

/// Unlike File, Archive writes to any stream, so failures of the stream are seen.
struct Writer : openvdb::io::Archive {
    void writeTo(std::ostream& os, const openvdb::GridCPtrVec& grids, bool seekable) {
        openvdb::MetaMap meta;
        meta.insertMeta("creator",
                        openvdb::StringMetadata(std::string("implicit-geodesic ") + kVersion));
        write(os, grids, seekable, meta);
    }
};

/// Position of the UUID in a VDB header: magic (8), format, major, minor (4 each), offsets flag
/// (1).
constexpr std::streamoff kUuidPosition = 8 + 3 * 4 + 1;

/// Replaces the random UUID by one computed from the bytes after it.
void stampUuid(std::iostream& file) {
    Digest digest;
    std::vector<char> buffer(1 << 20);
    file.seekg(kUuidPosition + 36);
    while (file.read(buffer.data(), std::streamsize(buffer.size())), file.gcount() > 0)
        digest.add({buffer.data(), std::size_t(file.gcount())});
    const auto [a, b] = digest.value();
    const std::string text =
        fmt::format("{:08x}-{:04x}-{:04x}-{:04x}-{:012x}", a >> 32, a >> 16 & 0xffff,
                    (a & 0x0fff) | 0x8000, (b >> 48 & 0x3fff) | 0x8000, b & 0xffffffffffffULL);
    file.clear();
    file.seekp(kUuidPosition);
    file.write(text.data(), 36);
    file.seekp(0, std::ios::end);
}

}  // namespace

void writeVdb(std::ostream& stream, const openvdb::GridCPtrVec& grids) {
    std::stringstream buffer(std::ios::in | std::ios::out | std::ios::binary);
    Writer().writeTo(buffer, grids, /*seekable=*/false);
    stampUuid(buffer);
    buffer.seekg(0);
    stream << buffer.rdbuf() << std::flush;
}

void writeVdb(const std::string& file, const openvdb::GridCPtrVec& grids) {
    errno = 0;
    AtomicFile out(file);
    try {
        out.stream().exceptions(std::ios::badbit | std::ios::failbit);
        std::error_code ignored;
        if (std::filesystem::exists(file, ignored) &&
            !std::filesystem::is_regular_file(file, ignored)) {
            writeVdb(out.stream(), grids);
        } else {
            Writer().writeTo(out.stream(), grids, /*seekable=*/true);
            out.stream().flush();
            out.stream().exceptions(std::ios::badbit);
            stampUuid(out.stream());
        }
    } catch (const std::ios_base::failure&) {
        AtomicFile::throwWriteError(file, errno);
    } catch (const openvdb::Exception&) {
        AtomicFile::throwWriteError(file, errno);
    }
    out.commit();
}

}  // namespace igeo
