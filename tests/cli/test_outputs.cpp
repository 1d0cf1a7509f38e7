// Pictures, meshes, isolines, matrices and the grids of --grids, as the program writes them.
#include <support/catch.h>

#include <cmath>
#include <cstring>

#include "program.h"
#include "vdb_files.h"

namespace igeo::test {

namespace {

/// The number after a word of a PLY header.
std::size_t countOf(const std::string& ply, const std::string& word) {
    const auto at = ply.find("element " + word + " ");
    REQUIRE(at != std::string::npos);
    return std::stoul(ply.substr(at + word.size() + 9));
}

unsigned bigEndian(const std::string& bytes, std::size_t at) {
    unsigned value = 0;
    for (std::size_t k = at; k < at + 4; ++k) value = value << 8 | (unsigned char)(bytes[k]);
    return value;
}

}  // namespace

TEST_CASE("one run writes picture, mesh, isolines, matrix and all grids") {
    const TempWorkspace desk;
    desk.make("in.vdb", "sphere --voxel-size 0.05");
    requireDone(desk,
                "--sdf in.vdb --seed 0,0,1 --seed 0,0.6,-0.8 --target 1,0,0 -q -o out.vdb "
                "--image p.png --image-size 160x120 --background transparent --unit \u00b5m "
                "--up -z --mesh-out m.ply --isolines i.json --spacing "
                "0.25 --matrix d.json --report r.json --grids "
                "surface,gradient,label,color,logmap,weight,curvature,engraved");
    const std::string png = readBytes(desk / "p.png");
    CHECK(png.substr(1, 3) == "PNG");
    CHECK(bigEndian(png, 16) == 160);
    CHECK(bigEndian(png, 20) == 120);
    CHECK(png[25] == 6);  // red, green, blue and alpha

    const std::string ply = readBytes(desk / "m.ply");
    // A closed surface of genus 0: twice as many triangles as vertices, less 4.
    CHECK(countOf(ply, "face") == 2 * countOf(ply, "vertex") - 4);

    CHECK(validBySchema(desk, "isolines.schema.json", "i.json"));
    CHECK(validBySchema(desk, "matrix.schema.json", "d.json"));
    CHECK(validBySchema(desk, "report.schema.json", "r.json"));
    const json isolines = readJson(desk / "i.json");
    for (const json& line : isolines["isolines"]) {
        CHECK(line["closed"] == true);
        // Multiples of the spacing; circles of radius sin(d) while the cells do not meet.
        const double d = line["level"];
        CHECK(std::abs(d / 0.25 - std::round(d / 0.25)) < 1e-9);
        if (d < 1)
            CHECK(line["length"].get<double>() == Approx(2 * M_PI * std::sin(d)).epsilon(5e-3));
    }
    CHECK(isolines["isolines"].size() >= 8);

    const VdbFile file = readVdb(desk / "out.vdb");
    CHECK(file.grids.size() == 12);
    const auto label = file.get<openvdb::FloatGrid>("psi_label");
    auto labelAt = [&](double x, double y, double z) {
        return label->tree().getValue(openvdb::Coord::round(label->worldToIndex({x, y, z})));
    };
    CHECK(labelAt(0.1, 0, 1) == 0);
    CHECK(labelAt(0, 0.5, -0.85) == 1);
    const auto map = file.get<openvdb::Vec3SGrid>("psi_logmap");
    const auto distance = file.get<openvdb::FloatGrid>("psi_geodesic");
    for (auto at = map->cbeginValueOn(); at; ++at)
        if (std::abs(at->length() - distance->tree().getValue(at.getCoord())) > 1e-4)
            FAIL("the logarithmic map is not as long as the distance");
    CHECK(file.get<openvdb::FloatGrid>("psi_engraved")->getGridClass() == openvdb::GRID_LEVEL_SET);
    file.get<openvdb::Vec3SGrid>("psi_geodesic_color");

    const json outputs = readJson(desk / "r.json")["outputs"];
    CHECK(outputs["image"] == "p.png");
    CHECK(outputs["mesh"] == "m.ply");
}

TEST_CASE("a volume without a name is written alone, or for what it should hold") {
    const std::string run = "--sdf in.vdb --seed 0,0,1 -q ", volume = "in_geodesic.vdb";
    const auto writesVolume = [&](const std::string& more) {
        const TempWorkspace desk;
        desk.make("in.vdb", "sphere --voxel-size 0.1");
        requireDone(desk, run + more);
        return desk.files().count(volume) == 1;
    };
    CHECK(writesVolume(""));
    CHECK(writesVolume("--target 1,0,0"));
    CHECK(writesVolume("--report r.json"));
    CHECK(writesVolume("--grids label --isolines i.json"));
    CHECK(writesVolume("--extend --isolines i.json"));
    CHECK(writesVolume("--name d --isolines i.json"));
    CHECK_FALSE(writesVolume("--isolines i.json"));
    CHECK_FALSE(writesVolume("--target 1,0,0 --paths p.json --report r.json"));
    CHECK_FALSE(writesVolume("--mesh-out m.ply -o other.vdb"));
}

TEST_CASE("samples are seeds, and their distances a symmetric matrix") {
    const TempWorkspace desk;
    desk.make("in.vdb", "sphere --voxel-size 0.05");
    const Result result = desk.run(
        "--sdf in.vdb --sample 6 --obstacle-sphere 3,0,0,1 --matrix - -o out.vdb --report r.json "
        "-q "
        "--threads 2");
    REQUIRE(result.exitCode == 0);
    CHECK(validBySchema(desk, "report.schema.json", "r.json"));
    CHECK(readJson(desk / "r.json")["seeds"].size() == 6);
    const auto rows = lines(result.out);
    REQUIRE(rows.size() == 7);
    CHECK(rows[0] ==
          "target,x,y,z,distance_0,distance_1,distance_2,distance_3,distance_4,distance_5");
    double least = 10;
    for (std::size_t i = 1; i < rows.size(); ++i) {
        std::stringstream row(rows[i]);
        std::string cell;
        for (int k = 0; k < 4; ++k) std::getline(row, cell, ',');
        for (std::size_t j = 0; std::getline(row, cell, ','); ++j)
            if (i != j + 1)
                least = std::min(least, std::stod(cell));
            else
                CHECK(std::stod(cell) == 0);
    }
    // Six points as far apart as can be: the greedy choice ends with an octahedron.
    CHECK(least == Approx(M_PI / 2).epsilon(0.05));
}

TEST_CASE("output options that cannot work are refused before any work") {
    const TempWorkspace desk;
    desk.make("in.vdb", "sphere --voxel-size 0.1");
    const std::string query = "--sdf in.vdb --seed 0,0,1 -o out.vdb --report out.json ";
    requireRefused(desk, query + "--image p.jpg", kUsage, {"p.jpg", ".png"});
    requireRefused(desk, query + "--image p.png --image-size 10", kUsage, {"'10'", "1280x960"});
    requireRefused(desk, query + "--image p.png --image-size 0x10", kUsage, {"0x10", "16384"});
    requireRefused(desk, query + "--image p.png --camera 1,2", kUsage, {"1,2", "x,y,z"});
    requireRefused(desk, query + "--image p.png --color-map jet", kUsage, {"jet", "viridis"});
    requireRefused(desk, query + "--mesh-out m.stl", kUsage, {"m.stl", ".ply"});
    requireRefused(desk, query + "--isolines i.txt", kUsage, {"i.txt", ".json", ".usda"});
    requireRefused(desk, query + "--matrix d.txt", kUsage, {"d.txt", ".npy"});
    requireRefused(desk, query + "--isolines x.obj --mesh-out x.obj", kUsage,
                   {"x.obj", "one place"});
    requireRefused(desk, query + "--grids label --scheme godunov", kUsage, {"label", "jet"});
    requireRefused(desk, query + "--levels 3 --spacing 1 --isolines i.obj", kUsage, {"--levels"});
}

}  // namespace igeo::test
