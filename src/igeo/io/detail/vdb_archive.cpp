#include <igeo/io/detail/vdb_archive.h>

#include <fmt/core.h>
#include <igeo/base/error.h>

#include <array>
#include <cstdint>
#include <filesystem>

namespace igeo {

namespace {
using Kind = Error::Kind;
}
using openvdb::GridBase;

VdbArchive::VdbArchive(const std::string& file, std::istream& in) : file_(file), in_(in) {
    readHeader(in_);
    setFormatVersion(in_);
    setLibraryVersion(in_);
    setDataCompression(in_);
    if (inputHasGridOffsets()) readDirectory();
}

std::vector<VdbArchive::Entry> VdbArchive::entries() {
    std::vector<Entry> all;
    for (const Descriptor& d : grids_) {
        all.push_back({Descriptor::nameAsString(d.uniqueName()), d.gridType(), nullptr});
        if (!GridBase::isRegistered(d.gridType())) continue;
        const GridBase::Ptr grid = d.create();
        d.seekToGrid(in_);
        readGridCompression(in_);
        grid->readMeta(in_);
        all.back().grid = grid;
    }
    return all;
}

GridBase::Ptr VdbArchive::read(const std::string& name) {
    const Descriptor& d = find(name);
    const GridBase::Ptr grid = readOne(d);
    // A tree shared by several grids is stored once.
    if (d.isInstance())
        grid->setTree(
            readOne(find(Descriptor::nameAsString(d.instanceParentName())))->baseTreePtr());
    return grid;
}

GridBase::Ptr VdbArchive::Descriptor::create() const {
    const GridBase::Ptr grid = GridBase::createGrid(gridType());
    grid->setSaveFloatAsHalf(saveFloatAsHalf());
    return grid;
}

void VdbArchive::readDescriptor(Descriptor& d) {
    try {
        d.read(in_);
    } catch (const openvdb::LookupError&) {
        // OpenVDB stops after the name of an unregistered type; three positions follow.
        std::array<std::int64_t, 3> positions{};
        in_.read(reinterpret_cast<char*>(positions.data()), sizeof positions);
        d.setGridPos(positions[0]);
        d.setBlockPos(positions[1]);
        d.setEndPos(positions[2]);
    }
}

void VdbArchive::readDirectory() {
    const auto size = std::int64_t(std::filesystem::file_size(file_));
    openvdb::MetaMap().readMeta(in_);
    for (std::int32_t n = readGridCount(in_); n > 0; --n) {
        Descriptor d;
        readDescriptor(d);
        const std::int64_t begin = d.getGridPos(), end = d.getEndPos();
        // They must increase: a grid that "ends" before it begins would be read forever.
        if (begin < in_.tellg() || end < begin)
            throw Error(
                Kind::BadInput,
                fmt::format("file '{}' is damaged: by its directory a grid lies from byte {} to {}",
                            file_, begin, end),
                "copy or write it again");
        if (end > size)
            throw Error(Kind::BadInput,
                        fmt::format("file '{}' is cut off: it has {} bytes, its grids end at {}",
                                    file_, size, end),
                        "copy or write it again");
        grids_.push_back(d);
        in_.seekg(end);
    }
}

const VdbArchive::Descriptor& VdbArchive::find(const std::string& name) const {
    for (const Descriptor& d : grids_)
        if (Descriptor::nameAsString(d.uniqueName()) == name) return d;
    throw Error(Kind::BadInput, "file '" + file_ + "' has no grid '" + name + "'",
                "the file may be damaged; write it again");
}

GridBase::Ptr VdbArchive::readOne(const Descriptor& d) {
    GridBase::Ptr grid = d.create();
    d.seekToGrid(in_);
    readGrid(grid, d, in_);
    return grid;
}

}  // namespace igeo
