// Which level sets are taken, and what the grids that come out hold.
#include <support/catch.h>

#include <openvdb/io/File.h>
#include <support/march_cases.h>

#include <cmath>
#include <limits>

#include "program.h"
#include "vdb_files.h"

namespace igeo::test {
using openvdb::FloatGrid;

namespace {

/// Active values are distances; everything else is inactive and holds the largest of them.
void requireSoundDistance(const FloatGrid& grid, const FloatGrid& psi, std::size_t reached) {
    CHECK(grid.getGridClass() == openvdb::GRID_UNKNOWN);
    CHECK(grid.transform() == psi.transform());
    CHECK(grid.activeVoxelCount() == reached);
    float largest = 0;
    bool finite = true, alike = true;
    for (auto value = grid.cbeginValueOn(); value; ++value) {
        finite = finite && std::isfinite(*value) && *value >= 0 && value.isVoxelValue() &&
                 *value < std::numeric_limits<float>::max();
        largest = std::max(largest, *value);
    }
    for (auto value = grid.cbeginValueOff(); value; ++value)
        alike = alike && *value == grid.background();
    CHECK(finite);
    CHECK(alike);
    CHECK(grid.background() == largest);
    CHECK(grid.metaValue<float>("geodesic_max") == largest);
}

/// "band: ..., <band> nodes; <reached> reached", of -v
std::pair<std::size_t, std::size_t> counts(const std::string& err) {
    const auto words = split(err);
    const auto nodes = std::find(words.begin(), words.end(), "nodes;");
    REQUIRE(nodes != words.end());
    return {std::stoul(*(nodes + 1)), std::stoul(*(nodes - 1))};
}

}  // namespace

TEST_CASE("the distance grid has the surface's transform, active where a distance is known") {
    const TempWorkspace desk;
    desk.make("in.vdb", "two-spheres --rotate 1,1,1,40 --translate 0.3,0.2,0.1");
    const auto psi = readVdb(desk / "in.vdb").get<FloatGrid>("psi");
    const Result result = desk.run(
        "--sdf in.vdb --seed 0.7,0,0.5 --seed 0.7,0,-0.5 --band 0.1 -o out.vdb --scheme godunov "
        "-v");
    INFO(result.err);
    REQUIRE(result.exitCode == 0);
    const auto [reached, all] = counts(result.err);
    CHECK(reached < all);

    const VdbFile file = readVdb(desk / "out.vdb");
    REQUIRE(file.grids.size() == 1);
    const auto grid = file.get<FloatGrid>("psi_geodesic");
    requireSoundDistance(*grid, *psi, reached);
    const std::string version = split(desk.run("--version").out).at(1);
    CHECK(file.metadata["creator"]->str() == "implicit-geodesic " + version);
    CHECK_THAT(grid->metaValue<std::string>("geodesic_scheme"), startsWith("godunov"));
    CHECK(grid->metaValue<float>("geodesic_band") == Approx(0.1));
    CHECK(grid->metaValue<std::int32_t>("geodesic_seed_count") == 2);
    CHECK(grid->metaValue<std::int64_t>("geodesic_unreached") == std::int64_t(all - reached));
    CHECK(grid->metaValue<std::string>("geodesic_weight") == "1");

    // Only the piece with the seeds: positive x in the world.
    for (auto value = grid->cbeginValueOn(); value; ++value)
        if (grid->indexToWorld(value.getCoord()).x() < 0) FAIL("a voxel of the other sphere");
}

TEST_CASE("a stray voxel with a huge value decides neither snap nor the reach of grooves") {
    const TempWorkspace desk;
    desk.make("sound.vdb", "sphere --voxel-size 0.1");
    const auto psi = readVdb(desk / "sound.vdb").get<FloatGrid>("psi");
    psi->tree().setValueOn({20, 3, 4}, -50.0f);
    openvdb::io::File(desk / "in.vdb").write({psi});
    const Result done = desk.run(
        "--sdf in.vdb --seed 0,0,1 --grids engraved --levels 3 -o out.vdb --report r.json");
    INFO(done.err);
    CHECK(done.exitCode == 0);
    for (const char* part : {"warning: 1 of", "500 voxels", "20,3,4", "left out"})
        CHECK(done.err.find(part) != std::string::npos);
    requireRefused(desk, "--sdf in.vdb --seed 0,0,50.9", 2, {"49.9", "0.3 is allowed", "--snap"});
}

TEST_CASE("a name that gives two grids one name is refused") {
    const TempWorkspace desk;
    desk.make("in.vdb", "sphere --voxel-size 0.1 --name shell");
    const std::string line = "--sdf in.vdb --seed 0,0,1 -o out.vdb -q ";
    for (const std::string bad :
         {"--name shell --grids surface", "--name shell_label --grids gradient,label",
          "--name shell_curvature_max --grids curvature",
          "--name shell_engraved --grids engraved --levels 2"}) {
        const std::string name = split(bad)[1];
        requireRefused(desk, line + bad, 2,
                       {"--name " + name, "two grids", "'" + name + "'", "--grids"});
    }
    desk.make("odd.vdb", "sphere --voxel-size 0.1 --name d_gradient");
    requireRefused(desk, "--sdf odd.vdb --seed 0,0,1 --name d --grids surface,gradient", 2,
                   {"'d_gradient'", "two grids"});
    requireDone(desk, line + "--name shell --grids gradient");
    requireDone(desk, line + "--name shell_label --grids surface");
}

TEST_CASE("more grids come in a fixed order, the surface first") {
    const TempWorkspace desk;
    desk.make("in.vdb", "sphere --voxel-size 0.1 --name shell");
    requireDone(desk, "--sdf in.vdb --seed 0,0,1 --grids gradient,surface --name d -o out.vdb -q");
    // A stream gives the grids as they lie in the file, io::File sorts them by name.
    const VdbFile file = readVdbBytes(readBytes(desk / "out.vdb"));
    REQUIRE(file.grids.size() == 3);
    CHECK(file.grids[0]->getName() == "shell");
    CHECK(file.grids[1]->getName() == "d");
    CHECK(file.grids[2]->getName() == "d_gradient");

    const auto psi = file.get<FloatGrid>("shell");
    const auto original = readVdb(desk / "in.vdb").get<FloatGrid>("shell");
    CHECK(psi->getGridClass() == openvdb::GRID_LEVEL_SET);
    CHECK(psi->activeVoxelCount() == original->activeVoxelCount());
    CHECK(largestDifference(*psi, *original) == 0);

    const auto distance = file.get<FloatGrid>("d");
    const auto gradient = file.get<openvdb::Vec3SGrid>("d_gradient");
    CHECK(gradient->getVectorType() == openvdb::VEC_COVARIANT);
    CHECK(gradient->transform() == distance->transform());
    CHECK(gradient->tree().hasSameTopology(distance->tree()));
    for (auto value = gradient->cbeginValueOn(); value; ++value)
        if (!(value->length() < 2)) FAIL("a gradient of length " << value->length());

    // By their own names they sort the same way: vdb_render takes the first float grid.
    requireDone(desk, "--sdf in.vdb --seed 0,0,1 --grids gradient,surface -o out.vdb -q");
    std::vector<std::string> names;
    for (const auto& grid : readVdb(desk / "out.vdb").grids) names.push_back(grid->getName());
    CHECK(names == std::vector<std::string>{"shell", "shell_geodesic", "shell_geodesic_gradient"});
}

TEST_CASE("float, double and half grids give the same distances") {
    const TempWorkspace desk;
    desk.make("float.vdb", "sphere --voxel-size 0.1");
    desk.make("double.vdb", "sphere --voxel-size 0.1 --double");
    desk.make("half.vdb", "sphere --voxel-size 0.1 --half");
    for (const std::string type : {"float", "double", "half"})
        requireDone(desk, "--sdf " + type + ".vdb --seed 0,0,1 -q -o " + type + "_d.vdb");
    const auto expected = readDistance(desk / "float_d.vdb");
    CHECK((readBytes(desk / "double_d.vdb") == readBytes(desk / "float_d.vdb")));
    // Half floats round |psi| <= 0.3 by up to 2^-13: by 0.0012 voxels, which may move a voxel in or
    // out of the band. A voxel's width is far beyond the change of a distance over the sphere.
    const auto halved = readDistance(desk / "half_d.vdb");
    CHECK(double(halved->activeVoxelCount()) ==
          Approx(double(expected->activeVoxelCount())).epsilon(0.02));
    CHECK(largestDifference(*halved, *expected) < 0.1);
}

TEST_CASE("rotated voxels, active tiles and a grid of class unknown are taken") {
    const TempWorkspace desk;
    desk.make("rotated.vdb", "sphere --rotate 1,2,3,40 --translate 5,6,7");
    desk.make("tiles.vdb", "bad tiles");
    desk.make("unknown.vdb", "sphere --grid-class unknown");
    desk.make("plain.vdb", "sphere");
    const std::string rest = " --seed 0,0,1 --target 0,0,-1 -q -o out.vdb --paths out.json";
    requireDone(desk, "--sdf plain.vdb" + rest);
    const std::string plain = readBytes(desk / "out.vdb");
    const double largest = readDistance(desk / "out.vdb")->background();
    requireDone(desk, "--sdf rotated.vdb" + rest);
    // Errors depend on the direction of the lattice: by less than the voxel of 0.05 here.
    CHECK(readDistance(desk / "out.vdb")->background() == Approx(largest).margin(0.05));
    for (const std::string same : {"tiles", "unknown"}) {
        requireDone(desk, "--sdf " + same + ".vdb" + rest);
        CHECK((readBytes(desk / "out.vdb") == plain));
    }
    const Result warned = desk.run("--sdf unknown.vdb --seed 0,0,1 -o out.vdb");
    CHECK_THAT(warned.err, contains("warning: the grid's class is not 'level set'"));
}

TEST_CASE("a surface that the volume's edge cuts gives a warning") {
    const TempWorkspace desk;
    desk.make("cut.vdb", "bad cut");
    const Result result = requireDone(desk, "--sdf cut.vdb --seed 1,0,0 -o out.vdb");
    CHECK_THAT(result.err, startsWith("implicit-geodesic: warning: ") &&
                               contains("voxels of the surface lie at the edge"));
}

TEST_CASE("a thin level set is widened with a warning") {
    const int halfWidth = GENERATE(1, 2);
    const TempWorkspace desk;
    desk.make("thin.vdb", "sphere --half-width " + std::to_string(halfWidth));
    desk.make("plain.vdb", "sphere");
    const Result result =
        requireDone(desk, "--sdf thin.vdb --seed 0,0,1 --band-voxels 2.5 -o thin_d.vdb");
    CHECK_THAT(result.err,
               contains("warning: the level set is ") && contains("widened by fast sweeping"));
    requireDone(desk, "--sdf plain.vdb --seed 0,0,1 --band-voxels 2.5 -q -o plain_d.vdb");
    // Fast sweeping is first order: the widened psi is off by some tenths of a voxel at most.
    CHECK(largestDifference(*readDistance(desk / "thin_d.vdb"),
                            *readDistance(desk / "plain_d.vdb")) < 0.05);
}

TEST_CASE("a level set 2^30 voxels from its origin gives the distances of one at it") {
    const TempWorkspace desk;
    const auto write = [&](const std::string& name, std::int32_t at) {
        const auto grid = mapVoxels(*torusGrid(), [&](const igeo::Ijk& v) {
            return v + igeo::Ijk{at, -at, 0};
        });
        grid->setName("psi");
        openvdb::io::File(desk / name).write({grid});
    };
    const auto place = [](int x, std::int32_t at) {
        return std::to_string(x + at) + "," + std::to_string(-5 - at) + ",1";
    };
    const std::int32_t at = (1 << 30) - 40;
    write("near.vdb", 0);
    write("far.vdb", at);
    write("beyond.vdb", 1 << 30);
    requireDone(desk, "--sdf near.vdb --seed " + place(23, 0) + " -o near_d.vdb");
    requireDone(desk, "--sdf far.vdb --seed " + place(23, at) + " --target " + place(-17, at) +
                          " -o far_d.vdb --paths far.obj --mesh-out far.ply --report far.json");
    const auto near = readDistance(desk / "near_d.vdb"), far = readDistance(desk / "far_d.vdb");
    CHECK(near->activeVoxelCount() == far->activeVoxelCount());
    for (auto it = near->cbeginValueOn(); it; ++it)
        // Positions are rounded to 2^-23, which may tip a decision of jet.
        REQUIRE(far->tree().getValue(it.getCoord().offsetBy(at, -at, 0)) ==
                Approx(*it).margin(0.01));
    requireRefused(desk, "--sdf beyond.vdb --seed 0,0,0 -o out.vdb", 3, {"beyond.vdb", "2^30"});
}

}  // namespace igeo::test
