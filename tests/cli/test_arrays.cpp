// Groups of seeds, columns, tables of targets: what the program says of them. What their files hold
// is in tests/consumers.
#include <fmt/core.h>
#include <support/catch.h>
#include <support/mesh_shapes.h>

#include <numbers>

#include "program.h"

namespace igeo::test {

namespace {

/// Two spheres, 642 vertices each.
struct Spheres : TempWorkspace {
    Spheres() {
        igeo::test::writeMesh(together(sphereMesh({0, 0, 0}, 1, 3), sphereMesh({3, 0, 0}, 1, 3)),
                              *this / "in.obj");
        writeBytes(*this / "g.json", R"({"groups": {"pole": [0, 1], "other": [300]}})");
    }
    const std::string in = "--mesh in.obj --voxel-size 0.1 -o out.vdb ";
};

/// Vertices from `first` on, a line each.
std::string vertexList(int first, int count) {
    std::string text;
    for (int v = first; v < first + count; ++v) text += std::to_string(v) + "\n";
    return text;
}

}  // namespace

TEST_CASE("groups of seeds: a label and a place in report and matrix each") {
    const Spheres desk;
    requireDone(desk, desk.in +
                          "--seed vertex:100 --seeds g.json -q --grids label --report r.json "
                          "--matrix m.json");
    CHECK(validBySchema(desk, "report.schema.json", "r.json"));
    CHECK(validBySchema(desk, "matrix.schema.json", "m.json"));
    const json seeds = readJson(desk / "r.json")["seeds"];
    REQUIRE(seeds.size() == 3);
    CHECK(seeds[1]["of"] == "group 'pole'");
    CHECK(seeds[1]["segments"] == 2);
    const json matrix = readJson(desk / "m.json");
    CHECK(matrix["seeds"][0].contains("position"));
    CHECK(matrix["targets"][1] == json({{"group", "pole"}, {"points", 2}}));
    CHECK(matrix["distance"].size() == 3);
}

TEST_CASE("many targets have one line, and paths only where a result has them") {
    const Spheres desk;
    writeBytes(desk / "t.csv", vertexList(1, 600));
    const Result many = desk.run(desk.in + "--seed vertex:0 --targets t.csv --matrix t2.csv -v");
    CHECK(many.exitCode == 0);
    CHECK(many.err.find("600 targets: distances from ") != std::string::npos);
    CHECK(many.err.find("target 3: distance") == std::string::npos);
    CHECK(many.err.find("trace") == std::string::npos);
    CHECK(lines(readBytes(desk / "t2.csv")).size() == 601);
    CHECK(many.err.find("... 600 targets in all") != std::string::npos);

    writeBytes(desk / "t.csv", vertexList(630, 30));  // 18 of the other sphere
    const Result lost = desk.run(desk.in + "--seed vertex:0 --targets t.csv --paths p.json");
    CHECK(lost.exitCode == kUnreached);
    CHECK(lost.err.find("18 of 30 targets, target 12 the first, are unreachable") !=
          std::string::npos);
    CHECK(readJson(desk / "p.json")["paths"].size() == 30);

    writeBytes(desk / "t.csv", vertexList(1, 3));
    const Result few = desk.run(desk.in + "--seed vertex:0 --targets t.csv");
    CHECK(few.err.find("target 2: distance ") != std::string::npos);
}

TEST_CASE("points that triangles join to a seed and voxels do not: a warning by every output") {
    // Three pages from one edge, half a degree apart: the middle one lies in the voxels of both.
    const TempWorkspace desk;
    TriangleMesh pages;
    for (const double degrees : {0.3, 0.8, 1.3}) {
        const double x = 30 * std::cos(degrees * std::numbers::pi / 180),
                     z = 30 * std::sin(degrees * std::numbers::pi / 180);
        pages = together(pages, sheet(10, 10, [=](double u, double v) {
                             return Vec3d{u * x, 30 * v, u * z};
                         }));
    }
    igeo::test::writeMesh(pages, desk / "in.obj");
    const Vec3d a = pages.points[120], b = pages.points[200];
    writeBytes(desk / "p.csv", fmt::format("{},{},{},{},{},{}\n", a.x, a.y, a.z, b.x, b.y, b.z));
    const std::string in = "--mesh in.obj --voxel-size 1 --seed vertex:120 ",
                      lost = "have no distance, though triangles join them to a seed";
    auto warned = [&](const std::string& options) {
        const Result r = desk.run(options);
        INFO(options << "\n" << r.err);
        return r.err.find(lost) != std::string::npos;
    };
    CHECK(warned(in + "-o out.vdb"));
    CHECK(warned(in + "--image out.png"));
    CHECK(warned(in + "--per-vertex out.csv"));
    CHECK(warned(in + "--seed vertex:230 --per-vertex out.csv --per-seed"));
    CHECK(warned("--mesh in.obj --voxel-size 1 --pairs p.csv"));
    CHECK_FALSE(
        warned("--mesh in.obj --voxel-size 0.02 --seed vertex:0 --max-distance 1 -o o.vdb"));
}

TEST_CASE("groups, columns and samples: refusals") {
    const Spheres desk;
    const std::string one = desk.in + "--seed vertex:0 ", groups = desk.in + "--seeds g.json ";
    requireRefused(desk, one + "--per-seed", kUsage, {"--per-seed", "--per-vertex"});
    requireRefused(desk, one + "--per-seed --per-vertex v.obj", kUsage, {"--per-seed", ".npy"});
    requireRefused(desk, one + "--per-vertex v.xyz", kUsage, {"v.xyz", ".gii", ".npz"});
    requireRefused(desk, one + "--mesh-out m.stl", kUsage, {"m.stl", ".vtp .glb"});
    requireRefused(desk, one + "--mesh-out m.ply --up z", kUsage, {"--up", ".glb"});
    requireRefused(desk, one + "--samples s.vtp", kUsage, {"s.vtp", ".npz"});
    requireRefused(desk, one + "--samples s.npz --scheme godunov", kUsage, {"--samples", "jet"});
    requireRefused(desk, groups + "--grids logmap", kUsage, {"logmap", "groups"});
    requireRefused(desk, one + "--targets g.json", kUnusable, {"g.json", "groups"});
    writeBytes(desk / "g.json", R"({"groups": {"pole": [0, 1284]}})");
    requireRefused(desk, groups, kUsage, {"g.json, group 'pole'", "1284", "0 to 1283"});
    writeBytes(desk / "g.json", R"({"groups": {"pole": [[9, 9, 9]]}})");
    requireRefused(desk, groups, kUsage, {"seed 0 of group 'pole'", "--snap"});
    writeBytes(desk / "g.json", R"({"groups": {"pole": []}})");
    requireRefused(desk, groups, kUnusable, {"g.json, group 'pole'", "no points"});
    writeBytes(desk / "g.json", R"({"groups": {"pole": [1, )");
    requireRefused(desk, groups, kUnusable, {"g.json"});
}

}  // namespace igeo::test
