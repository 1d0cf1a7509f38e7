#include <igeo/io/vdb_write.h>

#include <fmt/core.h>
#include <igeo/base/atomic_file.h>
#include <igeo/base/digest.h>
#include <igeo/base/version.h>
#include <openvdb/io/Archive.h>
#include <openvdb/io/GridDescriptor.h>

#include <cerrno>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <set>
#include <sstream>
#include <utility>

namespace igeo {

namespace {

/// Unlike File, Archive writes to any stream, so failures of the stream are seen.
class Writer : openvdb::io::Archive {
public:
    Writer(std::ostream& os, bool seekable) : os_(os), seekable_(seekable) {}
    ~Writer() { openvdb::io::clearStreamMetadataPtr(os_); }

    void writeAll(const openvdb::GridCPtrVec& grids) {
        openvdb::MetaMap meta;
        meta.insertMeta("creator",
                        openvdb::StringMetadata(std::string("implicit-geodesic ") + kVersion));
#if OPENVDB_LIBRARY_MAJOR_VERSION_NUMBER >= 13
        write(os_, grids, seekable_, meta);
#else
        writeOnce(grids, meta);
#endif
    }

private:
#if OPENVDB_LIBRARY_MAJOR_VERSION_NUMBER < 13
    using Descriptor = openvdb::io::GridDescriptor;

    /// As Archive::write, which before OpenVDB 13 compresses all leaves twice: it also lists their
    /// sizes.
    void writeOnce(const openvdb::GridCPtrVec& grids, const openvdb::MetaMap& meta) {
        setState(std::make_shared<openvdb::io::StreamMetadata>());
        openvdb::io::setDataCompression(os_, compression());
        writeHeader(os_, seekable_);
        meta.writeMeta(os_);
        const auto count = std::int32_t(grids.size());
        os_.write(reinterpret_cast<const char*>(&count), sizeof count);
        std::map<std::string, int> sameName;
        for (const auto& grid : grids) ++sameName[grid->getName()];
        std::set<std::string> names;
        std::map<const openvdb::TreeBase*, Descriptor> written;
        for (const auto& grid : grids) {
            const std::string given = grid->getName();
            std::string name =
                given.empty() || sameName[given] > 1 ? Descriptor::addSuffix(given, 0) : given;
            for (int n = 1; !names.insert(name).second; ++n) name = Descriptor::addSuffix(given, n);
            Descriptor d(name, grid->type(), grid->saveFloatAsHalf());
            const auto [parent, isFirst] = written.emplace(&grid->baseTree(), d);
            if (isFirst || parent->second.saveFloatAsHalf() != d.saveFloatAsHalf()) {
                writeTree(d, *grid);
            } else {
                d.setInstanceParentName(parent->second.uniqueName());
                writeGridInstance(d, grid, os_, seekable_);
            }
            // setGridCompression() is for one grid.
            openvdb::io::setDataCompression(os_, compression());
        }
    }

    void writeTree(Descriptor& d, const openvdb::GridBase& grid) {
        const auto state = std::make_shared<openvdb::io::StreamMetadata>();
        state->setHalfFloat(grid.saveFloatAsHalf());
        state->gridMetadata() = grid;
        setState(state);
        d.writeHeader(os_);
        const auto offsets = os_.tellp();
        d.writeStreamPos(os_);
        d.setGridPos(os_.tellp());
        setGridCompression(os_, grid);
        // With the same tree.
        const auto described = openvdb::ConstPtrCast<openvdb::GridBase>(grid.copyGrid());
        described->addStatsMetadata();
        described->insertMeta(openvdb::GridBase::META_FILE_COMPRESSION,
                              openvdb::StringMetadata(openvdb::io::compressionToString(
                                  openvdb::io::getDataCompression(os_))));
        described->writeMeta(os_);
        grid.writeTransform(os_);
        grid.writeTopology(os_);
        d.setBlockPos(os_.tellp());
        grid.writeBuffers(os_);
        d.setEndPos(os_.tellp());
        if (!seekable_) return;
        os_.seekp(offsets);
        d.writeStreamPos(os_);
        d.seekToEnd(os_);
    }
    void setState(openvdb::io::StreamMetadata::Ptr state) {
        state_ = std::move(state);
        openvdb::io::setStreamMetadataPtr(os_, state_, /*transfer=*/false);
    }

    openvdb::io::StreamMetadata::Ptr state_;  ///< the stream points to this pointer
#endif
    std::ostream& os_;
    bool seekable_;
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
    Writer(buffer, /*seekable=*/false).writeAll(grids);
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
            Writer(out.stream(), /*seekable=*/true).writeAll(grids);
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
