#include <igeo/vdb_io.h>

#include <igeo/atomic_file.h>
#include <igeo/error.h>
#include <igeo/version.h>
#include <openvdb/io/Archive.h>
#include <openvdb/io/File.h>
#include <openvdb/io/GridDescriptor.h>
#include <openvdb/io/Stream.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <iostream>
#include <sstream>

namespace igeo {

namespace {

using Kind = Error::Kind;
using openvdb::GridBase;

std::string quoted(const std::string& s) { return "'" + s + "'"; }

/// The file for messages, as the object of a sentence.
std::string nameOf(const GridSource& source) {
    return source.file == "-" ? "standard input" : "file " + quoted(source.file);
}

/// One grid of a file, as far as its metadata tells.
struct Candidate {
    std::string name;  ///< unique name
    GridBase::ConstPtr grid;
    bool isScalar = false;
    bool isFog = false;
    bool isLevelSet = false;

    Candidate(std::string uniqueName, GridBase::ConstPtr g) : name(std::move(uniqueName)), grid(g) {
        isScalar = grid->isType<openvdb::FloatGrid>() || grid->isType<openvdb::DoubleGrid>();
        isFog = grid->getGridClass() == openvdb::GRID_FOG_VOLUME;
        isLevelSet = grid->getGridClass() == openvdb::GRID_LEVEL_SET;
    }
    std::string describe() const {
        return quoted(name) + " (" + grid->valueType() + ", " +
               GridBase::gridClassToString(grid->getGridClass()) + ")";
    }
};

std::string describeAll(const std::vector<Candidate>& all) {
    std::string text;
    for (const Candidate& c : all) text += (text.empty() ? "" : ", ") + c.describe();
    return text.empty() ? "no grids" : text;
}

/// The grid asked for, or the only one that can be meant.
const Candidate& choose(const std::vector<Candidate>& all, const GridSource& source) {
    const std::string where = nameOf(source);
    if (all.empty())
        throw Error(Kind::BadInput, where + " holds no grids", "give a file with a level set");
    if (!source.grid.empty()) {
        for (const Candidate& c : all)
            if (c.name == source.grid) return c;
        throw Error(Kind::BadInput, where + " has no grid " + quoted(source.grid),
                    "it holds " + describeAll(all));
    }
    std::vector<const Candidate*> fits;
    for (const Candidate& c : all)
        if (c.isScalar && c.isLevelSet) fits.push_back(&c);
    if (fits.empty())
        for (const Candidate& c : all)
            if (c.isScalar && c.grid->getGridClass() == openvdb::GRID_UNKNOWN) fits.push_back(&c);
    if (fits.size() == 1) return *fits.front();
    if (fits.empty()) {
        const bool fog = std::any_of(all.begin(), all.end(), [](auto& c) { return c.isFog; });
        throw Error(
            Kind::BadInput, where + " holds no level set, but " + describeAll(all),
            fog ? "a fog volume holds density, not distance: convert it first, for instance "
                  "with OpenVDB's tools::fogToSdf or Houdini's 'Convert VDB'"
                : "give a float or double grid of class level set");
    }
    throw Error(
        Kind::BadInput,
        where + " holds " + std::to_string(fits.size()) + " level sets: " + describeAll(all),
        "name one: " + source.file + ":" + fits.front()->name);
}

const Candidate& chooseChecked(const std::vector<Candidate>& all, const GridSource& source) {
    const Candidate& c = choose(all, source);
    const std::string where = " (" + nameOf(source) + ")";
    if (!c.isScalar)
        throw Error(Kind::BadInput,
                    "grid " + quoted(c.name) + " holds " + c.grid->valueType() +
                        " values in a tree of type " + c.grid->type() +
                        "; a level set holds float or double in a 5_4_3 tree" + where,
                    "the file holds " + describeAll(all));
    if (c.isFog)
        throw Error(Kind::BadInput,
                    "grid " + quoted(c.name) + " is a fog volume: density, not distance" + where,
                    "convert it to a level set first, for instance with OpenVDB's tools::fogToSdf "
                    "or Houdini's 'Convert VDB'");
    return c;
}

LoadedGrid load(const GridSource& source, const Candidate& chosen, GridBase::Ptr full) {
    LoadedGrid out;
    out.file = source.file == "-" ? "standard input" : source.file;
    out.name = chosen.name;
    out.isLevelSetClass = chosen.isLevelSet;
    if (auto doubles = openvdb::gridPtrCast<openvdb::DoubleGrid>(full)) {
        out.grid = std::make_shared<openvdb::FloatGrid>(*doubles);
    } else {
        out.grid = openvdb::gridPtrCast<openvdb::FloatGrid>(full);
    }
    out.grid->setName(full->getName());
    return out;
}

/// A stream has no directory: all its grids are read. `in` must throw at its end, or OpenVDB would
/// take garbage for what is missing.
LoadedGrid readFromStream(const GridSource& source, std::istream& in) {
    if (in.peek() == std::istream::traits_type::eof())
        throw Error(Kind::BadInput, nameOf(source) + " is empty",
                    "check the program that was to write it");
    in.exceptions(std::ios::failbit | std::ios::badbit);
    openvdb::io::Stream stream(in, /*delayLoad=*/false);
    std::vector<Candidate> all;
    std::map<std::string, int> seen;
    const auto grids = stream.getGrids();
    for (const GridBase::Ptr& g : *grids) {
        const int n = seen[g->getName()]++;
        all.emplace_back(n ? g->getName() + "[" + std::to_string(n) + "]" : g->getName(), g);
    }
    const Candidate& chosen = chooseChecked(all, source);
    return load(source, chosen, (*grids)[std::size_t(&chosen - all.data())]);
}

/// What a file says about itself before its grids.
struct Directory : openvdb::io::Archive {
    bool hasOffsets = false;   ///< false: the file was written to a stream
    std::int64_t gridEnd = 0;  ///< where the last grid ends, if the file has offsets

    explicit Directory(std::istream& in) {
        in.exceptions(std::ios::failbit | std::ios::badbit);
        readHeader(in);
        setFormatVersion(in);
        setLibraryVersion(in);
        hasOffsets = inputHasGridOffsets();
        if (!hasOffsets) return;
        openvdb::MetaMap().readMeta(in);
        for (std::int32_t n = readGridCount(in); n > 0; --n) {
            openvdb::io::GridDescriptor grid;
            grid.read(in);
            gridEnd = std::max(gridEnd, grid.getEndPos());
            in.seekg(grid.getEndPos());
        }
    }
};

LoadedGrid readFromFile(const GridSource& source) {
    std::ifstream in(source.file, std::ios::binary);
    const Directory directory(in);
    if (!directory.hasOffsets) {
        in.seekg(0);
        return readFromStream(source, in);
    }
    // OpenVDB reads garbage beyond the end, and notices only some of it.
    const auto size = std::int64_t(std::filesystem::file_size(source.file));
    if (size < directory.gridEnd)
        throw Error(Kind::BadInput,
                    "file " + quoted(source.file) + " is cut off: it has " + std::to_string(size) +
                        " bytes, its grids end at " + std::to_string(directory.gridEnd),
                    "copy or write it again");
    openvdb::io::File file(source.file);
    file.open(/*delayLoad=*/false);
    std::vector<Candidate> all;
    for (auto it = file.beginName(); it != file.endName(); ++it)
        all.emplace_back(it.gridName(), file.readGridMetadata(it.gridName()));
    const Candidate& chosen = chooseChecked(all, source);
    return load(source, chosen, file.readGrid(chosen.name));
}

/// Refuses what OpenVDB would report in its own words or not at all.
void requireReadable(const std::string& name) {
    errno = 0;
    std::ifstream in(name, std::ios::binary);
    if (!in)
        throw Error(Kind::Io, "cannot read " + quoted(name) + ": " + std::strerror(errno),
                    "check the name and the permissions");
    if (std::filesystem::is_directory(name))
        throw Error(Kind::Io, "cannot read " + quoted(name) + ": it is a folder",
                    "give a .vdb file");
    std::array<unsigned char, 4> magic{};
    in.read(reinterpret_cast<char*>(magic.data()), magic.size());
    if (!in || std::memcmp(magic.data(), " BDV", 4) != 0)
        throw Error(Kind::BadInput, quoted(name) + " is not a VDB file",
                    "give a level set written by OpenVDB, Houdini, Blender or vdb_tool");
}

/// Archive writes to any stream, which lets the stream's failures be seen.
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

/// Replaces the random UUID by one made from the bytes behind it (two FNV-1a hashes).
void stampUuid(std::iostream& file) {
    constexpr std::uint64_t kPrime = 1099511628211ULL;
    std::uint64_t a = 14695981039346656037ULL, b = ~a;
    std::vector<char> buffer(1 << 20);
    file.seekg(kUuidPosition + 36);
    while (file.read(buffer.data(), std::streamsize(buffer.size())), file.gcount() > 0) {
        // Eight bytes at a time: the hash must not cost more than the writing.
        const auto n = std::size_t(file.gcount());
        std::memset(buffer.data() + n, 0, (8 - n % 8) % 8);
        for (std::size_t k = 0; k < n; k += 8) {
            std::uint64_t word;
            std::memcpy(&word, buffer.data() + k, 8);
            a = (a ^ word) * kPrime;
            b = (b ^ (word << 32 | word >> 32)) * kPrime;
            a ^= a >> 29;
            b ^= b >> 31;
        }
    }
    std::array<char, 40> text{};
    std::snprintf(text.data(), text.size(), "%08x-%04x-%04x-%04x-%012llx", unsigned(a >> 32),
                  unsigned(a >> 16 & 0xffff), unsigned((a & 0x0fff) | 0x8000),
                  unsigned((b >> 48 & 0x3fff) | 0x8000),
                  static_cast<unsigned long long>(b & 0xffffffffffffULL));
    file.clear();
    file.seekp(kUuidPosition);
    file.write(text.data(), 36);
    file.seekp(0, std::ios::end);
}

void writeToMemory(const openvdb::GridCPtrVec& grids, std::ostream& os) {
    std::stringstream buffer(std::ios::in | std::ios::out | std::ios::binary);
    Writer().writeTo(buffer, grids, /*seekable=*/false);
    stampUuid(buffer);
    buffer.seekg(0);
    os << buffer.rdbuf() << std::flush;
}

}  // namespace

GridSource parseGridSource(const std::string& text) {
    std::error_code ignored;
    const auto colon = text.rfind(':');
    if (colon == std::string::npos || std::filesystem::exists(text, ignored)) return {text, ""};
    return {text.substr(0, colon), text.substr(colon + 1)};
}

LoadedGrid readLevelSetGrid(const GridSource& source) {
    openvdb::initialize();
    if (source.file != "-") requireReadable(source.file);
    try {
        return source.file == "-" ? readFromStream(source, std::cin) : readFromFile(source);
    } catch (const Error&) {
        throw;
    } catch (const std::ios_base::failure&) {
        throw Error(Kind::BadInput, nameOf(source) + " is cut off", "copy or write it again");
    } catch (const std::bad_alloc&) {
        throw Error(Kind::BadInput, "cannot read a grid from " + nameOf(source) + ": out of memory",
                    "the grid is too large for this machine, or the file is damaged");
    } catch (const std::exception& e) {
        // OpenVDB's exceptions begin with their class name.
        std::string why = e.what();
        if (const auto colon = why.find(": "); colon != std::string::npos) why.erase(0, colon + 2);
        throw Error(Kind::BadInput, "cannot read a grid from " + nameOf(source) + ": " + why,
                    "the file may be damaged or of a newer format; write it again");
    }
}

void writeVdb(const std::string& file, const openvdb::GridCPtrVec& grids) {
    errno = 0;
    if (file == "-") {
        writeToMemory(grids, std::cout);
        if (!std::cout) AtomicFile::throwWriteError("standard output", errno);
        return;
    }
    AtomicFile out(file);
    try {
        out.stream().exceptions(std::ios::badbit | std::ios::failbit);
        if (std::filesystem::exists(file) && !std::filesystem::is_regular_file(file)) {
            writeToMemory(grids, out.stream());
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
