// Volumes of voxels, slopes, and values per vertex, as users give them.
#include <support/binary.h>
#include <support/catch.h>

#include <cmath>
#include <functional>

#include "exit_code.h"
#include "program.h"

namespace igeo::test {
namespace {

/// An NRRD file of 25^3 voxels of 0.2 units about 1,2,3, left-handed.
std::string nrrd(const std::function<float(double x, double y, double z)>& f) {
    std::vector<float> values;
    for (int k = 0; k < 25; ++k)
        for (int j = 0; j < 25; ++j)
            for (int i = 0; i < 25; ++i)
                values.push_back(f(0.2 * (12 - i), 0.2 * (j - 12), 0.2 * (k - 12)));
    return "NRRD0005\ntype: float\ndimension: 3\nspace: left-posterior-superior\nsizes: 25 25 25\n"
           "space directions: (-0.2,0,0) (0,0.2,0) (0,0,0.2)\nspace origin: (3.4,-0.4,0.6)\n"
           "endian: little\nencoding: gzip\n\n" +
           gzipped(bytesOf(values));
}

float ball(double x, double y, double z) { return 10 - float(std::sqrt(x * x + y * y + z * z)); }

/// The unit square in 10 x 10 cells as OBJ.
std::string square() {
    std::string text;
    for (int j = 0; j <= 10; ++j)
        for (int i = 0; i <= 10; ++i)
            text += "v " + std::to_string(0.1 * i) + " " + std::to_string(0.1 * j) + " 0\n";
    for (int j = 0; j < 10; ++j)
        for (int i = 0; i < 10; ++i) {
            const int a = 11 * j + i + 1;
            for (const auto& [p, q] : {std::pair(a + 1, a + 12), {a + 12, a + 11}})
                text += "f " + std::to_string(a) + " " + std::to_string(p) + " " +
                        std::to_string(q) + "\n";
        }
    return text;
}

double distanceIn(const TempWorkspace& desk, const std::string& report) {
    const json distance = readJson(desk / report)["targets"][0]["distance"];
    return distance.is_number() ? distance.get<double>() : INFINITY;
}

TEST_CASE("a volume of voxels: from its header's world to a VDB there") {
    const TempWorkspace desk;
    writeBytes(desk / "head.nrrd", nrrd(ball));
    const std::string run =
        "--volume head.nrrd --iso 8 --seed 1,2,5 --target 1,2,1 "
        "--report r.json -q";
    requireDone(desk, run);
    CHECK(desk.files().count("head_geodesic.vdb") == 1);
    CHECK(distanceIn(desk, "r.json") == Approx(2 * M_PI).epsilon(6e-3));  // measured 0.4 %
    const json report = readJson(desk / "r.json");
    CHECK(report["surface"]["voxelSize"] == Approx(0.2));
    CHECK(report["surface"]["closed"] == true);
    CHECK(validBySchema(desk, "report.schema.json", "r.json"));
    requireDone(desk, run + " --voxel-size 0.1 -o out.vdb");
    CHECK(readJson(desk / "r.json")["surface"]["voxelSize"] == Approx(0.1));
}

TEST_CASE("a mask has one surface, whatever --iso is, and a warning says so") {
    const TempWorkspace desk;
    writeBytes(desk / "mask.nrrd",
               nrrd([](double x, double y, double z) { return ball(x, y, z) > 8 ? 1.0f : 0.0f; }));
    const std::string run = "--volume mask.nrrd --seed 1,2,5 -o o.vdb --report r.json";
    const std::string says = "--iso changes nothing between 0 and 1";
    CHECK_THAT(desk.run(run).err, contains("is a mask") && !contains("--iso"));
    const std::string bytes = readBytes(desk / "o.vdb");
    for (const std::string iso : {"0.2", "0.5", "1"}) {
        CHECK_THAT(desk.run(run + " --iso " + iso).err, contains(says));
        CHECK((readBytes(desk / "o.vdb") == bytes));
        CHECK_THAT(desk.run("info mask.nrrd --iso " + iso).out, contains(says));
    }
    writeBytes(desk / "head.nrrd", nrrd(ball));
    CHECK_THAT(desk.run("--volume head.nrrd --iso 8 --seed 1,2,5 -o o.vdb").err,
               !contains("changes nothing"));
}

TEST_CASE("info knows volumes of voxels") {
    const TempWorkspace desk;
    writeBytes(desk / "head.nrrd", nrrd(ball));
    const Result undecided = desk.run("info head.nrrd");
    CHECK(undecided.exitCode == kUnusable);
    CHECK(undecided.out.find("NRRD, float32, 25 x 25 x 25 of 0.2 x 0.2 x 0.2") !=
          std::string::npos);
    CHECK(undecided.out.find("--iso") != std::string::npos);
    const Result usable = desk.run("info head.nrrd --iso 8 --json");
    CHECK(usable.exitCode == kDone);
    writeBytes(desk / "survey.json", usable.out);
    CHECK(validBySchema(desk, "info.schema.json", "survey.json"));
    const json survey = parseJson(usable.out);
    CHECK(survey["voxels"]["size"] == json({25, 25, 25}));
    CHECK(survey["surface"]["components"].size() == 1);
    CHECK(survey["mesh"]["closed"] == true);
    writeBytes(desk / "in.obj", square());
    CHECK(parseJson(desk.run("info in.obj --json").out)["voxels"] == nullptr);
    requireRefused(desk, "info in.obj --iso 8", kUsage, {"--iso", "volumes of voxels"});
}

TEST_CASE("volumes of voxels: refusals") {
    const TempWorkspace desk;
    const std::string good = nrrd(ball);
    writeBytes(desk / "head.nrrd", good);
    writeBytes(desk / "cut.nrrd", good.substr(0, good.size() - 99));
    writeBytes(desk / "nan.nrrd",
               nrrd([](double x, double, double) { return x == 0 ? NAN : float(x); }));
    const std::string seed = " --seed 1,2,5";
    requireRefused(desk, "--volume head.nrrd" + seed, kUnusable,
                   {"head.nrrd", "none is said to be the surface", "--iso"});
    requireRefused(desk, "--volume head.nrrd --iso 99" + seed, kUsage,
                   {"no surface has the value 99", "--iso"});
    requireRefused(desk, "--volume cut.nrrd --iso 8" + seed, kUnusable, {"cut.nrrd", "cut off"});
    requireRefused(desk, "--volume nan.nrrd --iso 1" + seed, kUnusable,
                   {"nan.nrrd", "voxel 12,0,0"});
    requireRefused(desk, "--volume none.nii --iso 8" + seed, kUnusable, {"none.nii"});
    requireRefused(desk, "--volume in.vdb --iso 8" + seed, kUsage, {"--sdf in.vdb --rebuild"});
    for (const char* option : {"--sdf", "--mesh", "--points"})
        requireRefused(desk, std::string(option) + " head.nrrd" + seed, kUsage,
                       {option, "--volume head.nrrd --iso V"});
    requireRefused(desk, "--volume head.nrrd --iso 8 --per-vertex a.csv" + seed, kUsage,
                   {"--per-vertex", "--mesh-out"});
    requireRefused(desk, "--volume head.nrrd --mesh in.obj" + seed, kUsage, {"--volume", "--mesh"});
}

TEST_CASE("values per vertex block, weigh and are seeds") {
    const TempWorkspace desk;
    writeBytes(desk / "in.obj", square());
    // The column x = 0.5, but for its lowest two vertices.
    std::string wall, weight, label = "#!ascii label\n2\n";
    for (int v = 0; v < 121; ++v) {
        wall += v % 11 == 5 && v / 11 > 1 ? "1\n" : "0\n";
        weight += "3\n";
    }
    label += "0 0 0 0 0\n11 0 0.1 0 0\n";
    writeBytes(desk / "wall.txt", wall);
    writeBytes(desk / "weight.csv", weight);
    writeBytes(desk / "side.label", label);
    const std::string run =
        "--mesh in.obj --resolution 100 --seed 0.2,0.8,0 --target 0.8,0.8,0 "
        "-o out.vdb --report r.json -q ";
    requireDone(desk, run);
    CHECK(distanceIn(desk, "r.json") == Approx(0.6).epsilon(1e-3));
    requireDone(desk, run + "--obstacle wall.txt");
    CHECK(distanceIn(desk, "r.json") ==
          Approx(2 * std::hypot(0.3, 0.6)).epsilon(0.021));             // measured 1.4 %
    CHECK(desk.run(run + "--obstacle wall.txt:0").exitCode == kUsage);  // the seed is inside
    requireDone(desk, run + "--weight weight.csv");
    requireRefused(
        desk, run + "--weight weight.csv:cost", kUsage,
        {"'weight.csv' holds a value per vertex", "'cost'", "write --weight weight.csv"});
    CHECK(distanceIn(desk, "r.json") == Approx(1.8).epsilon(1e-3));
    const std::string from =
        "--mesh in.obj --resolution 100 --target 0.8,0,0 -o out.vdb --report "
        "r.json -q ";
    for (const char* seeds : {"--seeds side.label", "--seed-mask side.label"}) {
        requireDone(desk, from + seeds);
        CHECK(distanceIn(desk, "r.json") == Approx(0.8).epsilon(3e-3));
    }
}

TEST_CASE("values per vertex: refusals") {
    const TempWorkspace desk;
    writeBytes(desk / "in.obj", square());
    desk.make("in.vdb", "sphere --voxel-size 0.1");
    writeBytes(desk / "few.txt", "1\n0\n");
    std::string none, holes;
    for (int v = 0; v < 121; ++v) {
        none += "0\n";
        holes += v == 7 ? "nan\n" : "1\n";
    }
    writeBytes(desk / "none.txt", none);
    writeBytes(desk / "holes.txt", holes);
    const std::string run = "--mesh in.obj --seed 0.2,0.8,0 ";
    requireRefused(desk, run + "--obstacle few.txt", kUnusable,
                   {"few.txt", "2 values", "121 vertices"});
    requireRefused(desk, run + "--obstacle none.txt", kUnusable, {"blocks no vertex", "in.obj"});
    requireRefused(desk, "--mesh in.obj --seed-mask none.txt", kUnusable,
                   {"region has no vertex", "in.obj", "inside by a value"});
    requireRefused(desk, run + "--obstacle holes.txt", kUnusable,
                   {"vertex 7", "holes.txt", "NaN", "holes.txt:nan"});
    requireRefused(desk, run + "--obstacle none.txt:x", kUsage, {"'x'", "none.txt"});
    requireRefused(desk, run + "--weight none.txt", kUnusable, {"vertex 0", "none.txt", "above 0"});
    requireRefused(desk, run + "--weight missing.npy", kUnusable, {"missing.npy"});
    requireRefused(desk, "--sdf in.vdb --seed 0,0,1 --obstacle none.txt", kUsage,
                   {"none.txt", "values per vertex", "--mesh"});
    requireDone(desk, run + "--obstacle holes.txt:nan -q -o out.vdb");
}

TEST_CASE("slopes that are too steep leave a seed without a path") {
    const TempWorkspace desk;
    desk.make("in.vdb", "sphere --voxel-size 0.05");
    const std::string run =
        "--sdf in.vdb --seed 0,0,1 --target 0.4,0,0.9 --snap 0.1 -q -o out.vdb "
        "--report r.json ";
    requireDone(desk, run + "--weight-slope up=z,max=45deg");
    // The integral of 1 + tan^2 a over a meridian, up to the target's angle.
    CHECK(distanceIn(desk, "r.json") == Approx(std::tan(std::atan2(0.4, 0.9))).epsilon(0.01));
    CHECK(readJson(desk / "r.json")["metric"]["weights"][0] == "slope up=z,max=45deg");
    const Result blocked = desk.run(run + "--weight-slope max=20deg");
    CHECK(blocked.exitCode == kUsage);
    CHECK(blocked.err.find("obstacle") != std::string::npos);
}

TEST_CASE("results do not overwrite the data beside a header, and documents name them") {
    const TempWorkspace desk;
    const std::string all = nrrd(ball);
    const std::size_t data = all.find("\n\n") + 2;
    writeBytes(desk / "head.nhdr", all.substr(0, data - 1) + "data file: data.ply\n");
    writeBytes(desk / "data.ply", all.substr(data));
    writeBytes(desk / "p.gltf",
               R"({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}], "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3",
                       "min": [0, 0, 0], "max": [1, 1, 0]}],
        "bufferViews": [{"buffer": 0, "byteLength": 36}],
        "buffers": [{"uri": "p%71.ply", "byteLength": 36}]})");
    writeBytes(desk / "pq.ply", bytesOf(std::vector<float>{0, 0, 0, 1, 0, 0, 0, 1, 0}));
    requireRefused(desk, "--volume head.nhdr --iso 8 --seed 1,2,5 -o o.vdb --mesh-out data.ply",
                   kUsage, {"data.ply would overwrite the input"});
    requireRefused(desk, "--mesh p.gltf --seed 0.2,0.2,0 -o o.vdb --mesh-out pq.ply", kUsage,
                   {"pq.ply would overwrite the input"});
    requireDone(desk, "--volume head.nhdr --iso 8 --seed 1,2,5 -o o.vdb --report r.json -q");
    const json inputs = readJson(desk / "r.json")["inputs"];
    REQUIRE(inputs.size() == 2);
    CHECK(inputs[1]["file"] == "data.ply");
    CHECK(inputs[1]["digest"].is_string());
}

}  // namespace
}  // namespace igeo::test
