#include <igeo/io/vdb_read.h>

#include <fmt/core.h>
#include <igeo/base/error.h>
#include <igeo/io/detail/vdb_archive.h>
#include <igeo/io/detail/vdb_sound.h>
#include <openvdb/io/Stream.h>

#include <cerrno>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iostream>
#include <memory>

namespace igeo {

namespace {

using Kind = Error::Kind;
using openvdb::GridBase;

/// The file in messages, as the object of a sentence.
std::string nameOf(const GridSource& source) {
    return source.file == "-" ? "standard input" : fmt::format("file '{}'", source.file);
}

/// One grid of a file, with its metadata.
struct Candidate {
    std::string name;         ///< unique name
    GridBase::ConstPtr grid;  ///< null: of a type that OpenVDB does not have
    std::string unknownType;

    template <typename Grid>
    bool is() const {
        return grid && grid->isType<Grid>();
    }
    openvdb::GridClass gridClass() const {
        return grid ? grid->getGridClass() : openvdb::GRID_UNKNOWN;
    }
    std::string type() const {
        if (!grid) return "unknown type " + unknownType;
        // OpenVDB calls the value type of a mask bool.
        return is<openvdb::MaskGrid>() ? "mask" : grid->valueType();
    }
    std::string className() const { return GridBase::gridClassToString(gridClass()); }
    std::string describe() const {
        return fmt::format("'{}' ({}{})", name, type(), grid ? ", " + className() : "");
    }
};
using Candidates = std::vector<Candidate>;

// Since OpenVDB 13 grids of half floats are a type of their own.
#if OPENVDB_LIBRARY_MAJOR_VERSION_NUMBER >= 13
bool isHalf(const Candidate& c) { return c.is<openvdb::HalfGrid>(); }
openvdb::FloatGrid::Ptr singlesOfHalves(const GridBase::Ptr& grid) {
    const auto halves = openvdb::gridPtrCast<openvdb::HalfGrid>(grid);
    return halves ? std::make_shared<openvdb::FloatGrid>(*halves) : nullptr;
}
#else
bool isHalf(const Candidate&) { return false; }
openvdb::FloatGrid::Ptr singlesOfHalves(const GridBase::Ptr&) { return nullptr; }
#endif

bool isAny(const Candidate&) { return true; }
bool isFog(const Candidate& c) { return c.gridClass() == openvdb::GRID_FOG_VOLUME; }
bool isLevelSet(const Candidate& c) { return c.gridClass() == openvdb::GRID_LEVEL_SET; }
bool isNoLevelSet(const Candidate& c) { return !isLevelSet(c); }
bool isUnknown(const Candidate& c) { return c.gridClass() == openvdb::GRID_UNKNOWN; }
bool isScalar(const Candidate& c) {
    return c.is<openvdb::FloatGrid>() || c.is<openvdb::DoubleGrid>() || isHalf(c);
}
bool isScalarOrMask(const Candidate& c) {
    return isScalar(c) || c.is<openvdb::BoolGrid>() || c.is<openvdb::MaskGrid>();
}
bool isVector(const Candidate& c) {
    return c.is<openvdb::Vec3SGrid>() || c.is<openvdb::Vec3DGrid>();
}
bool isPoints(const Candidate& c) { return c.grid && c.grid->valueType() == "ptdataidx32"; }

std::string describeAll(const Candidates& all) {
    std::string text;
    for (const Candidate& c : all) text += (text.empty() ? "" : ", ") + c.describe();
    return text.empty() ? "no grids" : text;
}

constexpr const char* kFromFog =
    "with rebuilt(), OpenVDB's tools::fogToSdf or Houdini's 'Convert VDB'";

/// The requirements of an input on its grid, and the words for them.
struct Wanted {
    const char *article, *noun;
    const char* values;              ///< what `fits` allows
    bool (*fits)(const Candidate&);  ///< by type
    bool fogToo = true;              ///< fog volumes are accepted
    /// The preferred ones among those that fit, if no grid is named.
    bool (*likely)(const Candidate&) = isNoLevelSet;
    bool (*conceivable)(const Candidate&) = isAny;

    std::string one() const { return std::string(article) + " " + noun; }
};
constexpr Wanted kLevelSet{"a",   "level set", "float or double", isScalar,
                           false, isLevelSet,  isUnknown};
constexpr Wanted kWeight{"a", "weight grid", "float or double", isScalar};
constexpr Wanted kObstacle{"an", "obstacle grid", "bool, mask, float or double", isScalarOrMask};
constexpr Wanted kTensor{"a", "tensor", "vec3s or vec3d", isVector};
constexpr Wanted kPoints{"a", "point grid", "ptdataidx32", isPoints};

bool allows(const Wanted& wanted, const Candidate& c) {
    return wanted.fits(c) && (wanted.fogToo || !isFog(c));
}

GridEntry entryOf(const Candidate& c) {
    GridEntry entry{c.name,
                    c.type(),
                    c.className(),
                    {},
                    allows(kLevelSet, c),
                    allows(kWeight, c),
                    allows(kObstacle, c)};
    if (!c.grid) return entry;
    // A grid of a file has only its metadata here; one of a stream is complete.
    if (const auto said =
            c.grid->getMetadata<openvdb::Int64Metadata>(GridBase::META_FILE_VOXEL_COUNT))
        entry.activeVoxels = std::uint64_t(said->value());
    else if (const auto count = c.grid->activeVoxelCount(); count > 0)
        entry.activeVoxels = count;
    return entry;
}

const Candidate* find(const Candidates& all, const std::string& name) {
    for (const Candidate& c : all)
        if (c.name == name) return &c;
    return nullptr;
}

const Candidate& named(const Candidates& all, const std::string& name, const GridSource& source,
                       const std::string& advice = "") {
    if (const Candidate* c = find(all, name)) return *c;
    throw Error(Kind::BadInput, fmt::format("{} has no grid '{}'", nameOf(source), name),
                "it holds " + describeAll(all) + advice);
}

/// The only usable grid where none is named.
const Candidate& meant(const Candidates& all, const Wanted& wanted, const GridSource& source) {
    std::vector<const Candidate*> fits;
    for (const auto belongs : {wanted.likely, wanted.conceivable})
        if (fits.empty())
            for (const Candidate& c : all)
                if (wanted.fits(c) && belongs(c)) fits.push_back(&c);
    if (fits.size() == 1) return *fits.front();
    const std::string where = nameOf(source);
    if (fits.empty()) {
        const bool fog = std::any_of(all.begin(), all.end(), isFog);
        throw Error(
            Kind::BadInput, where + " holds no " + wanted.noun + ", but " + describeAll(all),
            fog && !wanted.fogToo
                ? std::string("a fog volume holds density, not distance: convert it first, ") +
                      kFromFog
                : std::string("give a ") + wanted.values + " grid" +
                      (wanted.fogToo ? "" : " of class level set"));
    }
    throw Error(
        Kind::BadInput,
        fmt::format("{} holds {} {}s: {}", where, fits.size(), wanted.noun, describeAll(all)),
        "name one: " + source.file + ":" + fits.front()->name);
}

/// The named grid, or the only usable one.
const Candidate& choose(const Candidates& all, const Wanted& wanted, const GridSource& source) {
    return source.grid.empty() ? meant(all, wanted, source) : named(all, source.grid, source);
}

using Choice = std::vector<const Candidate*>;
using Choose = std::function<Choice(const Candidates&)>;

/// The grids that `choice` selects, if all have a type that fits.
Choice checked(const Candidates& all, const Wanted& wanted, const GridSource& source,
               const Choose& choice) {
    if (all.empty())
        throw Error(Kind::BadInput, nameOf(source) + " holds no grids",
                    "give a file with " + wanted.one());
    const Choice chosen = choice(all);
    for (const Candidate* c : chosen) {
        if (!c->grid)
            throw Error(
                Kind::BadInput,
                fmt::format(
                    "grid '{}' is of type {}, which OpenVDB {} of this program does not know ({})",
                    c->name, c->unknownType, OPENVDB_LIBRARY_VERSION_STRING, nameOf(source)),
                "write the grid as float; the file holds " + describeAll(all));
        if (!wanted.fits(*c))
            throw Error(Kind::BadInput,
                        fmt::format("grid '{}' holds {} values in a tree of type {}; {} holds {} "
                                    "in a 5_4_3 tree ({})",
                                    c->name, c->grid->valueType(), c->grid->type(), wanted.one(),
                                    wanted.values, nameOf(source)),
                        "the file holds " + describeAll(all));
        if (isFog(*c) && !wanted.fogToo)
            throw Error(Kind::BadInput,
                        fmt::format("grid '{}' is a fog volume: density, not distance ({})",
                                    c->name, nameOf(source)),
                        std::string("convert it to a level set first, ") + kFromFog);
    }
    return chosen;
}

struct NamedGrid {
    std::string name;
    GridBase::Ptr grid;
    std::vector<std::string> warnings;
};

/// A warning for files of a newer OpenVDB.
std::vector<std::string> warningsOf(const GridSource& source, std::ios_base& in) {
    const std::uint32_t format = openvdb::io::getFormatVersion(in);
    if (format <= openvdb::OPENVDB_FILE_VERSION) return {};
    const openvdb::VersionId library = openvdb::io::getLibraryVersion(in);
    return {
        fmt::format("{} was written by a newer OpenVDB, {}.{} (file format {}); this program has "
                    "OpenVDB {} (file format {}): check that the results are as expected",
                    nameOf(source), library.first, library.second, format,
                    OPENVDB_LIBRARY_VERSION_STRING, openvdb::OPENVDB_FILE_VERSION)};
}

/// A stream has no directory: all its grids are read. `in` must throw at its end, or OpenVDB would
/// read garbage in place of missing bytes.
std::vector<NamedGrid> readFromStream(const GridSource& source, std::istream& in,
                                      const Choose& choice) {
    if (in.peek() == std::istream::traits_type::eof())
        throw Error(Kind::BadInput, nameOf(source) + " is empty",
                    "check the program that writes it");
    in.exceptions(std::ios::failbit | std::ios::badbit);
    openvdb::io::Stream stream(in, /*delayLoad=*/false);
    Candidates all;
    std::map<std::string, int> seen;
    const auto grids = stream.getGrids();
    for (const GridBase::Ptr& g : *grids) {
        const int n = seen[g->getName()]++;
        all.push_back({n ? fmt::format("{}[{}]", g->getName(), n) : g->getName(), g, {}});
    }
    std::vector<NamedGrid> chosen;
    for (const Candidate* c : choice(all))
        chosen.push_back({c->name, (*grids)[std::size_t(c - all.data())], warningsOf(source, in)});
    return chosen;
}

std::vector<NamedGrid> readFromFile(const GridSource& source, const Choose& choice) {
    std::ifstream in(source.file, std::ios::binary);
    in.exceptions(std::ios::failbit | std::ios::badbit);
    VdbArchive file(source.file, in);
    if (!file.hasDirectory()) {
        in.seekg(0);
        return readFromStream(source, in, choice);
    }
    Candidates all;
    for (const VdbArchive::Entry& entry : file.entries())
        all.push_back({entry.name, entry.grid, entry.type});
    std::vector<NamedGrid> chosen;
    for (const Candidate* c : choice(all))
        chosen.push_back({c->name, file.read(c->name), warningsOf(source, in)});
    return chosen;
}

/// Refuses files that OpenVDB would report unclearly or not at all.
void requireReadable(const std::string& name, const Wanted& wanted) {
    errno = 0;
    std::ifstream in(name, std::ios::binary);
    if (!in)
        throw Error(Kind::Io, fmt::format("cannot read '{}': {}", name, std::strerror(errno)),
                    "check the name and the permissions");
    std::error_code ignored;
    if (std::filesystem::is_directory(name, ignored))
        throw Error(Kind::Io, fmt::format("cannot read '{}': it is a folder", name),
                    "give a .vdb file");
    std::array<unsigned char, 4> magic{};
    in.read(reinterpret_cast<char*>(magic.data()), magic.size());
    if (!in || std::memcmp(magic.data(), " BDV", 4) != 0)
        throw Error(Kind::BadInput, fmt::format("'{}' is not a VDB file", name),
                    "give " + wanted.one() + " written by OpenVDB, Houdini, Blender or vdb_tool");
}

/// The message of an OpenVDB exception, without the class name.
std::string withoutClass(const std::exception& e) {
    std::string why = e.what();
    if (const auto colon = why.find(": "); colon != std::string::npos) why.erase(0, colon + 2);
    return why;
}

/// Reads the grids that `choice` selects; refuses files with messages of its own.
std::vector<NamedGrid> readGrids(const GridSource& source, const Wanted& wanted,
                                 const Choose& choice) {
    openvdb::initialize();
    if (source.file != "-") requireReadable(source.file, wanted);
    const Choose check = [&](const Candidates& all) {
        return checked(all, wanted, source, choice);
    };
    try {
        auto read = source.file == "-" ? readFromStream(source, std::cin, check)
                                       : readFromFile(source, check);
        for (const NamedGrid& grid : read) {
            requireInvertible(*grid.grid,
                              fmt::format("grid '{}' of {}", grid.name, nameOf(source)));
            dropDamagedMetadata(*grid.grid);
        }
        return read;
    } catch (const Error&) {
        throw;
    } catch (const std::ios_base::failure&) {
        throw Error(Kind::BadInput, nameOf(source) + " is cut off", "copy or write it again");
    } catch (const openvdb::LookupError& e) {
        throw Error(
            Kind::BadInput,
            nameOf(source) + " is a stream with a grid of a type that OpenVDB " +
                OPENVDB_LIBRARY_VERSION_STRING +
                " of this program does not know: " + withoutClass(e),
            "write it to a file, of which the other grids can be read, or the grid as float");
    } catch (const std::bad_alloc&) {
        throw Error(Kind::BadInput, "cannot read a grid from " + nameOf(source) + ": out of memory",
                    "the grid is too large for this machine, or the file is damaged");
    } catch (const std::exception& e) {
        throw Error(Kind::BadInput,
                    "cannot read a grid from " + nameOf(source) + ": " + withoutClass(e),
                    "the file may be damaged or of a newer format; write it again");
    }
}

/// In single precision. Takes the leaves of `doubles` one by one, so both are never there at once.
openvdb::FloatGrid::Ptr singlesOfDoubles(openvdb::DoubleGrid& doubles) {
    using Leaf = openvdb::FloatTree::LeafNodeType;
    std::vector<openvdb::DoubleTree::LeafNodeType*> taken;
    doubles.tree().stealNodes(taken, doubles.background(), false);
    std::vector<std::unique_ptr<openvdb::DoubleTree::LeafNodeType>> leaves(taken.begin(),
                                                                           taken.end());
    auto singles = std::make_shared<openvdb::FloatGrid>(doubles);
    for (auto& leaf : leaves) {
        singles->tree().addLeaf(new Leaf(*leaf));
        leaf.reset();
    }
    return singles;
}

/// A float, double or half grid in single precision; null for any other.
openvdb::FloatGrid::Ptr scalars(const GridBase::Ptr& grid) {
    if (const auto singles = singlesOfHalves(grid)) return singles;
    if (const auto doubles = openvdb::gridPtrCast<openvdb::DoubleGrid>(grid))
        return singlesOfDoubles(*doubles);
    return openvdb::gridPtrCast<openvdb::FloatGrid>(grid);
}

/// A Vec3S or Vec3D grid in single precision. OpenVDB does not convert vectors; values of inactive
/// voxels are lost.
openvdb::Vec3SGrid::Ptr vectors(const GridBase::Ptr& grid) {
    const auto doubles = openvdb::gridPtrCast<openvdb::Vec3DGrid>(grid);
    if (!doubles) return openvdb::gridPtrCast<openvdb::Vec3SGrid>(grid);
    const auto singles = openvdb::Vec3SGrid::create(std::make_shared<openvdb::Vec3STree>(
        doubles->tree(), openvdb::Vec3s(doubles->background()), openvdb::TopologyCopy()));
    singles->setTransform(doubles->transformPtr());
    singles->setName(doubles->getName());
    const auto exact = doubles->getConstAccessor();
    for (auto it = singles->beginValueOn(); it; ++it)
        it.setValue(openvdb::Vec3s(exact.getValue(it.getCoord())));
    return singles;
}

/// The file as given, for messages.
std::string fileOf(const GridSource& source) {
    return source.file == "-" ? "standard input" : source.file;
}

/// The named grid, or the only usable one.
NamedGrid readGrid(const GridSource& source, const Wanted& wanted,
                   std::vector<GridEntry>* entries = nullptr) {
    return readGrids(source, wanted,
                     [&](const Candidates& all) {
                         if (entries)
                             for (const Candidate& c : all) entries->push_back(entryOf(c));
                         return Choice{&choose(all, wanted, source)};
                     })
        .front();
}

LoadedGrid readScalars(const GridSource& source, const Wanted& wanted,
                       std::vector<GridEntry>* entries = nullptr) {
    const NamedGrid read = readGrid(source, wanted, entries);
    return {scalars(read.grid), fileOf(source), read.name,
            read.grid->getGridClass() == openvdb::GRID_LEVEL_SET, read.warnings};
}

}  // namespace

LoadedGrid readLevelSetGrid(const GridSource& source, std::vector<GridEntry>* entries) {
    return readScalars(source, kLevelSet, entries);
}

LoadedGrid readScalarGrid(const GridSource& source) { return readScalars(source, kWeight); }

ObstacleGrid readObstacleGrid(const GridSource& source) {
    const NamedGrid read = readGrid(source, kObstacle);
    const openvdb::FloatGrid::Ptr numbers = scalars(read.grid);
    return {numbers ? numbers : read.grid, fileOf(source), read.name, read.warnings};
}

TensorGrids readTensorGrids(const GridSource& source) {
    const auto read = readGrids(source, kTensor, [&](const Candidates& all) {
        Choice chosen{&named(all, source.grid + "diagonal", source,
                             "; a tensor FILE:NAME is read from NAMEdiagonal and NAMEoffdiagonal")};
        if (const Candidate* c = find(all, source.grid + "offdiagonal")) chosen.push_back(c);
        return chosen;
    });
    return {vectors(read.front().grid), read.size() > 1 ? vectors(read.back().grid) : nullptr,
            fileOf(source), read.front().name, read.front().warnings};
}

openvdb::GridBase::Ptr readPointGrid(const GridSource& source, std::vector<std::string>& warnings) {
    NamedGrid read = readGrid(source, kPoints);
    warnings = std::move(read.warnings);
    return read.grid;
}

}  // namespace igeo
