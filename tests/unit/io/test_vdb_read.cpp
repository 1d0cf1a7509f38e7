#include <igeo/io/vdb_read.h>
#include <igeo/io/vdb_write.h>
#include <openvdb/io/File.h>
#include <openvdb/io/Stream.h>
#include <support/bad_inputs.h>
#include <support/catch.h>
#include <support/expect_error.h>
#include <support/openvdb.h>
#include <support/shapes.h>
#include <support/temp_dir.h>
#include <support/test_device.h>

#include <cstring>
#include <fstream>
#include <functional>
#include <iterator>
#include <limits>

namespace igeo::test {
namespace {

openvdb::FloatGrid::Ptr smallSphere(const std::string& name = "psi") {
    return makeLevelSet(sphere({0.1, 0.2, 0.3}, 1), 0.1, 3, name);
}

/// A few voxels of one value.
template <typename Grid>
typename Grid::Ptr gridOf(const std::string& name, const typename Grid::ValueType& value) {
    const auto grid = Grid::create();
    grid->setName(name);
    grid->setTransform(rotatedTransform(0.1, {1, 2, 3}, 20, {4, 5, 6}));
    grid->denseFill({{0, 0, 0}, {9, 9, 9}}, value);
    return grid;
}

std::string bytesOf(const std::string& path) {
    std::ifstream in(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
}

/// Writes the grids of a kind of bad input and reads them back as GRID of the file.
void refuse(const std::string& kind, const std::string& grid, Error::Kind expected,
            const std::vector<std::string>& phrases) {
    const TempDir folder;
    for (const BadInput& b : badInputs())
        if (b.kind == kind) {
            const auto grids = b.make();
            writeVdb(folder / "bad.vdb", {grids.begin(), grids.end()});
            INFO(kind);
            expectError(expected, phrases, [&] { readLevelSetGrid({folder / "bad.vdb", grid}); });
            return;
        }
    FAIL("no bad input " << kind);
}

}  // namespace

TEST_CASE("parseGridSource: FILE[:GRID]") {
    const auto check = [](const char* text, const char* file, const char* grid) {
        const GridSource s = parseGridSource(text);
        INFO(text);
        CHECK(s.file == file);
        CHECK(s.grid == grid);
    };
    check("a.vdb", "a.vdb", "");
    check("a.vdb:psi", "a.vdb", "psi");
    check("a.vdb:psi[1]", "a.vdb", "psi[1]");
    check("a.vdb:", "a.vdb", "");
    check("-", "-", "");
    check("-:psi", "-", "psi");
    check("b:a.vdb:psi", "b:a.vdb", "psi");
    check("folder/a.vdb:two words", "folder/a.vdb", "two words");
}

TEST_CASE("parseGridSource: a file whose whole name exists wins") {
    const TempDir folder;
    const std::string whole = folder / "12:30.vdb";
    CHECK(parseGridSource(whole).grid == "30.vdb");
    std::ofstream(whole) << "x";
    CHECK(parseGridSource(whole).file == whole);
    CHECK(parseGridSource(whole).grid.empty());
    CHECK(parseGridSource(whole + ":psi").file == whole);
    CHECK(parseGridSource(whole + ":psi").grid == "psi");
}

TEST_CASE("writeVdb and readLevelSetGrid: there and back, bit by bit") {
    const TempDir folder;
    const auto grid = smallSphere();
    grid->setTransform(rotatedTransform(0.1, {1, 1, 0}, 20, {1, 2, 3}));
    writeVdb(folder / "a.vdb", {grid});
    const LoadedGrid back = readLevelSetGrid({folder / "a.vdb", ""});
    CHECK(back.name == "psi");
    CHECK(back.file == folder / "a.vdb");
    CHECK(back.isLevelSetClass);
    CHECK(back.grid->transform() == grid->transform());
    CHECK(back.grid->background() == grid->background());
    REQUIRE(back.grid->activeVoxelCount() == grid->activeVoxelCount());
    CHECK(back.grid->tree().hasSameTopology(grid->tree()));
    for (auto it = grid->cbeginValueAll(); it; ++it)
        if (back.grid->tree().getValue(it.getCoord()) != *it) FAIL("differs at " << it.getCoord());
}

TEST_CASE("writeVdb: the same grids give the same bytes, other grids others") {
    const TempDir folder;
    writeVdb(folder / "a.vdb", {smallSphere(), smallSphere("other")});
    writeVdb(folder / "b.vdb", {smallSphere(), smallSphere("other")});
    const std::string a = bytesOf(folder / "a.vdb");
    CHECK(a.size() > 1000);
    CHECK(a == bytesOf(folder / "b.vdb"));
    writeVdb(folder / "b.vdb", {smallSphere(), smallSphere("fresh")});
    const std::string b = bytesOf(folder / "b.vdb");
    CHECK(a != b);
    // 36 characters behind magic number, versions and flag.
    CHECK(a.substr(21, 36) != b.substr(21, 36));
}

TEST_CASE("writeVdb: OpenVDB reads grids of one name, of one tree and of halves") {
    const TempDir folder;
    const auto grid = smallSphere();
    const openvdb::FloatGrid::Ptr twin = grid->copy();  // with the same tree
    const auto halves = smallSphere("half");
    halves->setSaveFloatAsHalf(true);
    writeVdb(folder / "a.vdb", {grid, smallSphere(), twin, halves});
    openvdb::io::File file(folder / "a.vdb");
    file.open(/*delayLoad=*/false);
    // By name.
    const openvdb::GridPtrVec back = *file.getGrids();
    REQUIRE(back.size() == 4);
    CHECK(back[0]->getName() == "half");
    CHECK(back[0]->saveFloatAsHalf());
    CHECK(back[1]->baseTreePtr() != back[2]->baseTreePtr());
    CHECK(back[1]->baseTreePtr() == back[3]->baseTreePtr());
    for (const openvdb::GridBase::Ptr& g : back) {
        const auto floats = openvdb::gridPtrCast<openvdb::FloatGrid>(g);
        REQUIRE(floats);
        CHECK(floats->tree().hasSameTopology(grid->tree()));
        CHECK(floats->transform() == grid->transform());
    }
    for (const std::size_t k : {0, 1, 2}) {
        CHECK(back[k]->metaValue<std::int64_t>("file_voxel_count") ==
              std::int64_t(grid->activeVoxelCount()));
        CHECK(!back[k]->metaValue<std::string>("file_compression").empty());
    }
}

TEST_CASE("readLevelSetGrid: doubles and halves become floats") {
    const TempDir folder;
    const auto exact = smallSphere();
    const auto doubles = makeDoubleLevelSet(sphere({0.1, 0.2, 0.3}, 1), exact->transform(), 3);
    const auto halves = smallSphere("half");
    halves->setSaveFloatAsHalf(true);
    writeVdb(folder / "d.vdb", {doubles});
    writeVdb(folder / "h.vdb", {halves});
    const auto d = readLevelSetGrid({folder / "d.vdb", ""});
    const auto h = readLevelSetGrid({folder / "h.vdb", ""});
    CHECK(d.isLevelSetClass);
    CHECK(d.grid->transform() == exact->transform());
    REQUIRE(d.grid->tree().hasSameTopology(exact->tree()));
    REQUIRE(h.grid->tree().hasSameTopology(exact->tree()));
    for (auto it = exact->cbeginValueOn(); it; ++it) {
        REQUIRE(d.grid->tree().getValue(it.getCoord()) == *it);
        // 11 significant bits.
        REQUIRE(std::abs(h.grid->tree().getValue(it.getCoord()) - *it) <=
                std::abs(*it) / 2048 + 1e-7);
    }
}

TEST_CASE("readLevelSetGrid: takes the grid that is meant") {
    const TempDir folder;
    auto fog = smallSphere("density");
    fog->setGridClass(openvdb::GRID_FOG_VOLUME);
    auto unknown = smallSphere("unknown");
    unknown->setGridClass(openvdb::GRID_UNKNOWN);
    const auto vectors = openvdb::Vec3SGrid::create();
    vectors->setName("v");
    writeVdb(folder / "a.vdb", {fog, vectors, smallSphere(), unknown});
    CHECK(readLevelSetGrid({folder / "a.vdb", ""}).name == "psi");
    const auto named = readLevelSetGrid({folder / "a.vdb", "unknown"});
    CHECK(named.name == "unknown");
    CHECK(!named.isLevelSetClass);
    // Without a level set the only grid of class unknown is usable.
    writeVdb(folder / "b.vdb", {fog, unknown});
    CHECK(readLevelSetGrid({folder / "b.vdb", ""}).name == "unknown");
    // Two of one name.
    writeVdb(folder / "c.vdb", {smallSphere(), unknown, smallSphere()});
    CHECK(readLevelSetGrid({folder / "c.vdb", "psi[1]"}).name == "psi[1]");
}

TEST_CASE("readLevelSetGrid: refuses what is no level set") {
    const auto bad = Error::Kind::BadInput;
    refuse("fog", "", bad, {"no level set", "'density'", "fogToSdf"});
    refuse("fog", "density", bad, {"fog volume", "fogToSdf"});
    refuse("vector", "", bad, {"no level set", "velocity"});
    refuse("vector", "velocity", bad, {"vec3s", "float or double"});
    refuse("int", "", bad, {"no level set", "int32"});
    refuse("int", "psi", bad, {"int32"});
    refuse("two-level-sets", "", bad, {"2 level sets", "psi_a", "psi_b", "bad.vdb:psi_a"});
    refuse("two-level-sets", "psi", bad, {"no grid 'psi'", "psi_a", "psi_b"});
    refuse("same-name", "", bad, {"2 level sets"});
    refuse("no-grids", "", bad, {"holds no grids"});
}

TEST_CASE("readLevelSetGrid: refuses files that are no VDB files or cut off") {
    const TempDir folder;
    expectError(Error::Kind::Io, {"nowhere.vdb", "No such file"}, [&] {
        readLevelSetGrid({folder / "nowhere.vdb", ""});
    });
    expectError(Error::Kind::Io, {"folder"}, [&] {
        readLevelSetGrid({folder.path().string(), ""});
    });
    for (const std::string content : {"", " BD", "not a vdb file at all"}) {
        std::ofstream(folder / "text.vdb", std::ios::binary) << content;
        expectError(Error::Kind::BadInput, {"not a VDB file"}, [&] {
            readLevelSetGrid({folder / "text.vdb", ""});
        });
    }
    writeVdb(folder / "a.vdb", {smallSphere()});
    const std::string whole = bytesOf(folder / "a.vdb");
    for (const std::size_t length :
         {std::size_t(10), std::size_t(60), std::size_t(300), whole.size() / 2, whole.size() - 1}) {
        std::ofstream(folder / "cut.vdb", std::ios::binary) << whole.substr(0, length);
        INFO(length << " of " << whole.size() << " bytes");
        expectError(Error::Kind::BadInput, {"cut.vdb"}, [&] {
            readLevelSetGrid({folder / "cut.vdb", ""});
        });
    }
}

TEST_CASE("a directory that sends its reader back or beyond the end is refused") {
    const TempDir folder;
    writeVdb(folder / "a.vdb", {smallSphere()});
    const std::string whole = bytesOf(folder / "a.vdb");
    // A grid's entry: its name, its type and its parent, each after its length; then three
    // positions.
    const std::string type = "Tree_float_5_4_3";
    const std::size_t positions = whole.find(type) + type.size() + 4;
    auto withPositions = [&](std::int64_t begin, std::int64_t end) {
        std::string bytes = whole;
        std::memcpy(&bytes[positions], &begin, 8);
        std::memcpy(&bytes[positions + 16], &end, 8);
        std::ofstream(folder / "b.vdb", std::ios::binary) << bytes;
        return GridSource{folder / "b.vdb", ""};
    };
    std::int64_t begin = 0, end = 0;
    std::memcpy(&begin, &whole[positions], 8);
    std::memcpy(&end, &whole[positions + 16], 8);
    CHECK(end == std::int64_t(whole.size()));
    CHECK(readLevelSetGrid(withPositions(begin, end)).name == "psi");
    const auto bad = Error::Kind::BadInput;
    expectError(bad, {"b.vdb' is damaged"}, [&] { readLevelSetGrid(withPositions(0, end)); });
    expectError(bad, {"b.vdb' is damaged"}, [&] { readLevelSetGrid(withPositions(begin, 0)); });
    expectError(bad, {"b.vdb' is damaged"}, [&] { readLevelSetGrid(withPositions(-8, -8)); });
    expectError(bad, {"b.vdb' is cut off"},
                [&] { readLevelSetGrid(withPositions(begin, end + 1)); });
}

TEST_CASE("readLevelSetGrid: never reads beyond the end") {
    // A grid claims 1000 items of metadata: OpenVDB's File would find all of them.
    const TempDir folder;
    writeVdb(folder / "a.vdb", {smallSphere()});
    std::string bytes = bytesOf(folder / "a.vdb");
    const std::string type = "Tree_float_5_4_3";
    std::int64_t begin = 0;
    std::memcpy(&begin, &bytes[bytes.find(type) + type.size() + 4], 8);
    const std::int32_t many = 1000;
    // After the flags of its compression.
    std::memcpy(&bytes[std::size_t(begin) + 4], &many, 4);
    std::ofstream(folder / "b.vdb", std::ios::binary) << bytes;
    expectError(Error::Kind::BadInput, {"b.vdb"}, [&] {
        readLevelSetGrid({folder / "b.vdb", ""});
    });
}

TEST_CASE("a transform without an inverse is refused") {
    const TempDir folder;
    for (const double entry : {0.0, std::numeric_limits<double>::quiet_NaN()}) {
        // A rotated transform has the matrix in the file, 16 doubles after the name of its kind;
        // without its first column, space is a plane.
        const auto grid = gridOf<openvdb::FloatGrid>("cost", 2);
        writeVdb(folder / "a.vdb", {grid});
        std::string bytes = bytesOf(folder / "a.vdb");
        const std::string kind = "AffineMap";
        const std::size_t matrix = bytes.find(kind) + kind.size();
        REQUIRE(bytes.find(kind) != std::string::npos);
        for (const std::size_t row : {0, 1, 2})
            std::memcpy(&bytes[matrix + 32 * row], &entry, sizeof entry);
        std::ofstream(folder / "b.vdb", std::ios::binary) << bytes;
        for (const auto& read :
             {std::function<void(const GridSource&)>(readScalarGrid), {readObstacleGrid}})
            expectError(Error::Kind::BadInput, {"b.vdb"}, [&] { read({folder / "b.vdb", ""}); });
    }
}

TEST_CASE("readLevelSetGrid: a tree that two grids share") {
    const TempDir folder;
    const auto first = smallSphere("first");
    const auto second = first->copy();  // shares the tree
    second->setName("second");
    openvdb::io::File(folder / "a.vdb").write({first, second});
    const auto read = readLevelSetGrid({folder / "a.vdb", "second"}).grid;
    CHECK(read->getName() == "second");
    CHECK(read->activeVoxelCount() == first->activeVoxelCount());
}

TEST_CASE("readScalarGrid: takes the grid that is no level set") {
    const TempDir folder;
    const auto fog = gridOf<openvdb::FloatGrid>("cost", 2.5f);
    fog->setGridClass(openvdb::GRID_FOG_VOLUME);
    const auto doubles = gridOf<openvdb::DoubleGrid>("slope", 0.1);
    const auto vectors = gridOf<openvdb::Vec3SGrid>("v", openvdb::Vec3s(1));
    writeVdb(folder / "a.vdb", {smallSphere(), fog, vectors});
    const LoadedGrid a = readScalarGrid({folder / "a.vdb", ""});
    CHECK(a.name == "cost");
    CHECK(!a.isLevelSetClass);
    CHECK(a.grid->tree().getValue({1, 2, 3}) == 2.5f);
    CHECK(a.grid->transform() == fog->transform());
    CHECK(a.file == folder / "a.vdb");
    CHECK(readScalarGrid({folder / "a.vdb", "psi"}).isLevelSetClass);
    // Of class unknown and in double precision; beside two level sets.
    writeVdb(folder / "b.vdb", {smallSphere(), doubles, smallSphere("other")});
    const LoadedGrid b = readScalarGrid({folder / "b.vdb", ""});
    CHECK(b.name == "slope");
    CHECK(b.grid->getName() == "slope");
    CHECK(b.grid->tree().getValue({1, 2, 3}) == 0.1f);
    CHECK(b.grid->transform() == doubles->transform());
    // Alone, a level set is what was meant.
    writeVdb(folder / "c.vdb", {smallSphere(), vectors});
    CHECK(readScalarGrid({folder / "c.vdb", ""}).name == "psi");

    const auto bad = Error::Kind::BadInput;
    writeVdb(folder / "d.vdb", {smallSphere(), fog, doubles});
    expectError(bad, {"2 weight grids", "'cost'", "'slope'", "'psi'", "d.vdb:cost"}, [&] {
        readScalarGrid({folder / "d.vdb", ""});
    });
    expectError(bad, {"no grid 'height'", "'cost'", "'slope'"}, [&] {
        readScalarGrid({folder / "d.vdb", "height"});
    });
    writeVdb(folder / "e.vdb", {vectors});
    expectError(bad, {"no weight grid", "'v' (vec3s", "float or double"}, [&] {
        readScalarGrid({folder / "e.vdb", ""});
    });
    expectError(bad, {"'v' holds vec3s", "a weight grid holds float or double", "e.vdb"}, [&] {
        readScalarGrid({folder / "e.vdb", "v"});
    });
    std::ofstream(folder / "text.vdb") << "no grid at all";
    expectError(bad, {"not a VDB file", "give a weight grid"}, [&] {
        readScalarGrid({folder / "text.vdb", ""});
    });
}

TEST_CASE("readObstacleGrid: bool, mask, float and double grids") {
    const TempDir folder;
    writeVdb(folder / "bool.vdb", {smallSphere(), gridOf<openvdb::BoolGrid>("wall", true)});
    writeVdb(folder / "mask.vdb", {smallSphere(), gridOf<openvdb::MaskGrid>("wall", true)});
    writeVdb(folder / "float.vdb", {smallSphere(), gridOf<openvdb::FloatGrid>("wall", 1)});
    writeVdb(folder / "double.vdb", {smallSphere(), gridOf<openvdb::DoubleGrid>("wall", 1)});
    writeVdb(folder / "psi.vdb", {smallSphere()});
    const auto type = [&](const char* file) {
        const ObstacleGrid read = readObstacleGrid({folder / file, ""});
        CHECK(read.file == folder / file);
        CHECK(read.name == read.grid->getName());
        return read.name + " " + read.grid->type();
    };
    CHECK(type("bool.vdb") == "wall Tree_bool_5_4_3");
    CHECK(type("mask.vdb") == "wall Tree_mask_5_4_3");
    CHECK(type("float.vdb") == "wall Tree_float_5_4_3");
    CHECK(type("double.vdb") == "wall Tree_float_5_4_3");
    CHECK(type("psi.vdb") == "psi Tree_float_5_4_3");

    const auto bad = Error::Kind::BadInput;
    writeVdb(folder / "a.vdb",
             {gridOf<openvdb::BoolGrid>("a", true), gridOf<openvdb::MaskGrid>("b", true)});
    expectError(bad, {"2 obstacle grids", "'a' (bool", "'b' (mask", "a.vdb:a"}, [&] {
        readObstacleGrid({folder / "a.vdb", ""});
    });
    writeVdb(folder / "b.vdb", {gridOf<openvdb::Int32Grid>("n", 1)});
    expectError(bad, {"no obstacle grid", "int32", "bool, mask"}, [&] {
        readObstacleGrid({folder / "b.vdb", ""});
    });
    expectError(bad, {"an obstacle grid holds bool, mask, float or double"}, [&] {
        readObstacleGrid({folder / "b.vdb", "n"});
    });
}

TEST_CASE("readTensorGrids: two grids of vectors, named by what their names begin with") {
    const TempDir folder;
    const auto diagonal = gridOf<openvdb::Vec3SGrid>("diagonal", openvdb::Vec3s(1, 2, 3));
    const auto doubles = gridOf<openvdb::Vec3DGrid>("m_diagonal", openvdb::Vec3d(4, 5, 0.1));
    const auto mixed = gridOf<openvdb::Vec3DGrid>("m_offdiagonal", openvdb::Vec3d(0.1, 0.2, 0.3));
    writeVdb(folder / "a.vdb", {smallSphere(), diagonal, mixed, doubles});
    const openvdb::Coord at(1, 2, 3);
    const TensorGrids plain = readTensorGrids({folder / "a.vdb", ""});
    CHECK(plain.name == "diagonal");
    CHECK(plain.file == folder / "a.vdb");
    CHECK(plain.diagonal->tree().getValue(at) == openvdb::Vec3s(1, 2, 3));
    CHECK(!plain.offdiagonal);
    const TensorGrids m = readTensorGrids({folder / "a.vdb", "m_"});
    CHECK(m.diagonal->tree().getValue(at) == openvdb::Vec3s(4, 5, 0.1f));
    REQUIRE(m.offdiagonal);
    CHECK(m.offdiagonal->tree().getValue(at) == openvdb::Vec3s(0.1f, 0.2f, 0.3f));
    CHECK(m.offdiagonal->transform() == mixed->transform());

    const auto bad = Error::Kind::BadInput;
    expectError(bad, {"no grid 'gdiagonal'", "'m_diagonal' (vec3d", "NAMEdiagonal"}, [&] {
        readTensorGrids({folder / "a.vdb", "g"});
    });
    writeVdb(folder / "b.vdb", {diagonal, gridOf<openvdb::FloatGrid>("offdiagonal", 0)});
    expectError(bad, {"'offdiagonal' holds float", "a tensor holds vec3s or vec3d"}, [&] {
        readTensorGrids({folder / "b.vdb", ""});
    });
    writeVdb(folder / "c.vdb", {});
    expectError(bad, {"holds no grids", "a tensor"}, [&] {
        readTensorGrids({folder / "c.vdb", ""});
    });
    const std::string whole = bytesOf(folder / "a.vdb");
    std::ofstream(folder / "cut.vdb", std::ios::binary) << whole.substr(0, whole.size() - 9);
    expectError(bad, {"cut off"}, [&] { readTensorGrids({folder / "cut.vdb", "m_"}); });
}

TEST_CASE("grids in a file that was written to a stream are found all the same") {
    const TempDir folder;
    const openvdb::GridCPtrVec grids{
        smallSphere(), gridOf<openvdb::FloatGrid>("cost", 3),
        gridOf<openvdb::BoolGrid>("wall", true),
        gridOf<openvdb::Vec3SGrid>("diagonal", openvdb::Vec3s(1)),
        gridOf<openvdb::Vec3SGrid>("offdiagonal", openvdb::Vec3s(0, 0, 0.5f))};
    {
        std::ofstream out(folder / "a.vdb", std::ios::binary);
        openvdb::io::Stream(out).write(grids);
    }
    CHECK(readScalarGrid({folder / "a.vdb", ""}).name == "cost");
    CHECK(readObstacleGrid({folder / "a.vdb", "wall"}).grid->valueType() == "bool");
    CHECK(readTensorGrids({folder / "a.vdb", ""}).offdiagonal->tree().getValue({}).z() == 0.5f);
}

TEST_CASE("writeVdb: says when it cannot write") {
    const TempDir folder;
    expectError(Error::Kind::Io, {"none/a.vdb"},
                [&] { writeVdb(folder / "none/a.vdb", {smallSphere()}); });
    if (const std::string full = testDevice(folder, "full", kFullMinor); !full.empty())
        expectError(Error::Kind::Io, {full, "No space left"},
                    [&] { writeVdb(full, {smallSphere()}); });
    if (const std::string null = testDevice(folder, "null", kNullMinor); !null.empty()) {
        CHECK_NOTHROW(writeVdb(null, {smallSphere()}));
        CHECK(std::filesystem::is_character_file(null));
    }
}

}  // namespace igeo::test
