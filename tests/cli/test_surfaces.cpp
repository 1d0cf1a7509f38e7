// Surfaces that are no level sets: meshes, points, and volumes to be rebuilt.
#include <support/catch.h>
#include <support/mesh_shapes.h>

#include <openvdb/tools/ChangeBackground.h>
#include <cmath>
#include <limits>
#include <sstream>

#include "program.h"
#include "vdb_files.h"

namespace igeo::test {
using igeo::Vec3d;

namespace {

/// A square of n^2 quads in the plane z = 0.1 x, of side 1 along y; without those for which `hole`.
template <typename Hole>
std::string sheet(int n, const Hole& hole) {
    std::ostringstream obj;
    for (int i = 0; i <= n; ++i)
        for (int j = 0; j <= n; ++j)
            obj << "v " << double(i) / n << " " << double(j) / n << " " << 0.1 * i / n << "\n";
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j)
            if (!hole((i + 0.5) / n, (j + 0.5) / n))
                obj << "f " << i * (n + 1) + j + 1 << " " << (i + 1) * (n + 1) + j + 1 << " "
                    << (i + 1) * (n + 1) + j + 2 << " " << i * (n + 1) + j + 2 << "\n";
    return obj.str();
}

/// Points spread evenly over the unit sphere, on a spiral.
std::string spherePoints(int n) {
    std::ostringstream xyz;
    for (int k = 0; k < n; ++k) {
        const double z = 1 - (2 * k + 1.0) / n, t = k * M_PI * (3 - std::sqrt(5.0));
        const double r = std::sqrt(1 - z * z);
        xyz << r * std::cos(t) << " " << r * std::sin(t) << " " << z << "\n";
    }
    return xyz.str();
}

double distanceOf(const TempWorkspace& desk, std::size_t target) {
    return reportOf(desk)["targets"][target]["distance"];
}

}  // namespace

TEST_CASE("the same sphere as level set, mesh and points: the same distances") {
    const TempWorkspace desk;
    desk.make("in.vdb", "sphere --voxel-size 0.02");
    writeBytes(desk / "in.xyz", spherePoints(8000));
    const std::string asked =
        " --seed 0,0,1 --target 1,0,0 --target 0,0.6,-0.8 -q -o out.vdb "
        "--report r.json";
    requireDone(desk, "--sdf in.vdb --mesh-out in.ply" + asked);
    const double quarter = distanceOf(desk, 0), far = distanceOf(desk, 1);
    CHECK(quarter == Approx(M_PI / 2).epsilon(5e-4));
    for (const std::string surface : {"--mesh in.ply --voxel-size 0.02", "--points in.xyz"}) {
        INFO(surface);
        requireDone(desk, surface + asked + " --paths p.json");
        CHECK(validBySchema(desk, "report.schema.json", "r.json"));
        CHECK(validBySchema(desk, "geodesics.schema.json", "p.json"));
        // The mesh cuts (dx / R)^2 / 8 of the radius off, the spiral's fits far less.
        CHECK(distanceOf(desk, 0) == Approx(quarter).epsilon(5e-4));
        CHECK(distanceOf(desk, 1) == Approx(far).epsilon(5e-4));
        CHECK(reportOf(desk)["surface"]["activeVoxels"].is_null());
        const bool mesh = surface[2] == 'm';
        CHECK(reportOf(desk)["surface"]["kind"] == (mesh ? "mesh" : "points"));
        CHECK(reportOf(desk)["surface"]["closed"] == (mesh ? json(true) : json(nullptr)));
        const VdbFile file = readVdb(desk / "out.vdb");
        file.get<openvdb::FloatGrid>("in_geodesic");
    }
}

TEST_CASE("an open mesh: paths lead around its hole, and every result is there") {
    const TempWorkspace desk;
    writeBytes(desk / "in.obj", sheet(40, [](double x, double y) {
                   return std::abs(x - 0.5) < 0.1 && std::abs(y - 0.5) < 0.3;
               }));
    requireDone(desk,
                "--mesh in.obj --resolution 120 --seed 0.2,0.5,0.02 --target 0.8,0.5,0.08 "
                "--straighten -q -o out.vdb --report r.json --mesh-out m.ply --isolines i.json "
                "--image p.png --image-size 80x60 --grids surface,label,color,engraved,curvature "
                "--extend");
    // Around the corners of the hole, at |x - 0.5| = 0.1, |y - 0.5| = 0.3.
    const double slope = std::hypot(1, 0.1);
    const double around = 2 * std::hypot(0.2 * slope, 0.3) + 0.2 * slope;
    CHECK(distanceOf(desk, 0) == Approx(around).margin(1.5 / 120));
    CHECK(validBySchema(desk, "isolines.schema.json", "i.json"));
    CHECK(validBySchema(desk, "report.schema.json", "r.json"));
    CHECK(readBytes(desk / "p.png").size() > 100);
    CHECK(readVdb(desk / "out.vdb").get<openvdb::FloatGrid>("in")->getGridClass() ==
          openvdb::GRID_LEVEL_SET);
}

TEST_CASE("runs on meshes speak of meshes, whatever they write") {
    const TempWorkspace desk;
    writeBytes(desk / "open.obj", sheet(20, [](double x, double y) {
                   return std::abs(x - 0.5) < 0.1 && std::abs(y - 0.5) < 0.1;
               }));
    // A slab of one voxel, of which no level set of that voxel size is a distance.
    writeBytes(desk / "thin.obj",
               "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 0.01\nv 1 0 0.01\nv 1 1 0.01\n"
               "v 0 1 0.01\nf 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n");
    for (const std::string mesh : {"open.obj", "thin.obj"})
        for (const std::string result :
             {"", " --grids surface,engraved", " --image x.png --image-size 64x48",
              " --scheme godunov"}) {
            INFO(mesh << result);
            const Result run = desk.run("--mesh " + mesh +
                                        " --resolution 100 --seed 0.1,0.5,0 -o out.vdb" + result);
            INFO(run.err);
            CHECK(run.exitCode == 0);
            for (const std::string word : {"psi", "|grad", "edge of the volume"})
                CHECK(run.err.find(word) == std::string::npos);
            CHECK((run.err.find("warning: the mesh is open: 96 boundary edges in 2 holes") !=
                   std::string::npos) == (mesh == "open.obj"));
        }
    const std::string info = desk.run("info thin.obj --resolution 100").out;
    CHECK(info.find("|grad psi|") == std::string::npos);
}

TEST_CASE("what the voxels do not show is said, by a run, its report and info") {
    const TempWorkspace desk;
    const auto said = [&](const std::string& surface, const std::string& seed,
                          const std::string& warning, const std::string& key) {
        INFO(surface);
        const Result run =
            requireDone(desk, surface + " --seed " + seed + " -o out.vdb --report r.json");
        CHECK((run.err.find(warning) != std::string::npos) == !key.empty());
        const json j = reportOf(desk);
        CHECK(validBySchema(desk, "report.schema.json", "r.json"));
        const Result info = desk.run("info " + surface.substr(surface.find(' ')) + " --json");
        writeBytes(desk / "i.json", info.out);
        CHECK(validBySchema(desk, "info.schema.json", "i.json"));
        const json of = parseJson(info.out)["surface"]["unresolved"];
        if (key.empty()) return;
        CHECK(j["unresolved"][key] != 0);
        CHECK(of[key] == j["unresolved"][key]);
        CHECK(info.out.find(warning) != std::string::npos);
    };
    // Walls of one and of two voxels.
    desk.make("thin.vdb", "thin-sheet --param thickness=0.05");
    said("--sdf thin.vdb", "0,0,0.025", "thinner than 1.1 voxels", "thinShare");
    said("--sdf thin.vdb", "0,0,0.025", "bends or folds within 1.7 voxels on 100 % of it",
         "bentShare");
    desk.make("thick.vdb", "thin-sheet --param thickness=0.1");
    said("--sdf thick.vdb", "0,0,0.05", "thinner than 1.1 voxels", "");
    // A plate with a tunnel of 0.4 and of 4 voxels.
    writeMesh(moved(plateWithTunnel(0.4),
                    [](const Vec3d& p) {
                        return Vec3d{0.8 * p.x - 0.6 * p.y + 0.123, 0.6 * p.x + 0.8 * p.y + 0.321,
                                     p.z + 0.3 * p.x + 0.2 * p.y};
                    }),
              desk / "plate.obj");
    said("--mesh plate.obj --voxel-size 1", "vertex:8", "tunnels or gaps", "eulerDifference");
    said("--mesh plate.obj --voxel-size 0.1", "vertex:8", "tunnels or gaps", "");
}

TEST_CASE("pieces of a mesh that do not touch are unreachable, unless gaps are joined") {
    const TempWorkspace desk;
    // A slit across the middle, 1/40 wide: three quarters of a voxel.
    writeBytes(desk / "in.obj",
               sheet(41, [](double x, double) { return std::abs(x - 0.5) < 0.3 / 41; }));
    const std::string asked =
        "--mesh in.obj --resolution 30 --seed 0.2,0.5,0.02 --target 0.8,0.5,0.08 -o out.vdb "
        "--report r.json";
    const Result apart = desk.run(asked);
    CHECK(apart.exitCode == 4);
    CHECK(reportOf(desk)["targets"][0]["distance"].is_null());
    CHECK(reportOf(desk)["surface"]["joints"].is_null());
    const Result joined = desk.run(asked + " --join-gaps 0.03");
    CHECK(joined.exitCode == 0);
    CHECK(joined.err.find("1 pair of components") != std::string::npos);
    CHECK(distanceOf(desk, 0) == Approx(0.6 * std::hypot(1, 0.1)).margin(0.5 / 30));
    CHECK(reportOf(desk)["surface"]["joints"] == 1);
    CHECK(validBySchema(desk, "report.schema.json", "r.json"));
    const Result none = desk.run(asked + " --join-gaps 0.001");
    CHECK(none.exitCode == 4);
    CHECK(none.err.find("joins nothing") != std::string::npos);
    CHECK(desk.run(asked + " --join-gaps 9").exitCode == kUsage);
    CHECK(desk.run(asked + " --join-gaps 0.03 --scheme godunov").exitCode == kUsage);
}

TEST_CASE("gaps between the rims of one component are joined, and closed rings are not") {
    const TempWorkspace desk;
    // A slit over seven tenths, from one side on.
    writeBytes(desk / "in.obj", sheet(41, [](double x, double y) {
                   return std::abs(x - 0.5) < 0.3 / 41 && y < 0.7;
               }));
    const std::string run =
        "--mesh in.obj --resolution 30 --seed 0.2,0.3,0.02 --target 0.8,0.3,0.08 -o out.vdb "
        "--report r.json";
    CHECK(desk.run(run).exitCode == 0);
    CHECK(distanceOf(desk, 0) > 0.9);
    const Result joined = desk.run(run + " --join-gaps 0.03");
    CHECK_THAT(joined.err, contains("1 pair of components of the mesh, or of rims of one, joined"));
    std::printf("across a slit: %.4f voxels off\n",
                30 * std::abs(distanceOf(desk, 0) - 0.6 * std::hypot(1, 0.1)));
    CHECK(distanceOf(desk, 0) == Approx(0.6 * std::hypot(1, 0.1)).margin(0.5 / 30));

    // A ring of square section with a cut; its ends have no rim.
    std::ostringstream ring;
    const int n = 95;
    for (int k = 0; k <= n; ++k)
        for (const auto& [r, z] : {std::pair{2, 0}, {3, 0}, {3, 1}, {2, 1}}) {
            const double t = 2 * M_PI * (k + 0.5) / (n + 1);
            ring << "v " << r * std::cos(t) << " " << r * std::sin(t) << " " << z << "\n";
        }
    for (int k = 0; k < n; ++k)
        for (int c = 0; c < 4; ++c) {
            const int a = 4 * k + c + 1, b = 4 * k + (c + 1) % 4 + 1;
            ring << "f " << a << " " << a + 4 << " " << b + 4 << " " << b << "\n";
        }
    ring << "f 1 2 3 4\nf " << 4 * n + 4 << " " << 4 * n + 3 << " " << 4 * n + 2 << " " << 4 * n + 1
         << "\n";
    writeBytes(desk / "ring.obj", ring.str());
    CHECK_THAT(
        desk.run("--mesh ring.obj --resolution 60 --seed 2.5,0.2,1 -o out.vdb "
                 "--join-gaps 0.3")
            .err,
        contains("joins nothing") && contains("a closed ring with a cut, is not joined to itself"));
}

TEST_CASE("a mesh by its own vertices: seeds, targets, pairs and results") {
    const TempWorkspace desk;
    const int n = 20, row = n + 1;
    writeBytes(desk / "in.obj", sheet(n, [](double, double) { return false; }));
    requireDone(desk,
                "--mesh in.obj --resolution 60 --seed vertex:0 --target +x --target center "
                "--per-vertex d.csv -q -o o.vdb --report r.json");
    const std::vector<std::string> table = lines(readBytes(desk / "d.csv"));
    REQUIRE(table.size() == std::size_t(row * row + 1));
    auto exact = [&](int v) {
        return std::hypot(std::hypot(1, 0.1) * (v / row) / n, double(v % row) / n);
    };
    for (const int v : {0, 5, row, 7 * row + 3, row * row - 1}) {
        const std::string& line = table[std::size_t(v + 1)];
        CHECK(std::stod(line.substr(line.find(',') + 1)) == Approx(exact(v)).margin(1e-4));
    }
    CHECK(distanceOf(desk, 0) == Approx(exact(n * row)).margin(1e-4));
    CHECK(distanceOf(desk, 1) == Approx(exact(n / 2 * row + n / 2)).margin(1e-4));
    CHECK(validBySchema(desk, "report.schema.json", "r.json"));

    // Seeds and pairs from lists of vertices.
    writeBytes(desk / "s.csv", "vertex\n0\n");
    writeBytes(desk / "p.csv", "0," + std::to_string(row * row - 1) + "\n");
    requireDone(desk,
                "--mesh in.obj --resolution 60 --seeds s.csv --pairs p.csv --pairs-out q.csv "
                "--per-vertex e.csv -q -o o.vdb");
    CHECK(readBytes(desk / "e.csv") == readBytes(desk / "d.csv"));
    CHECK(std::stod(lines(readBytes(desk / "q.csv"))[1].substr(2)) ==
          Approx(exact(row * row - 1)).margin(1e-4));
    for (const char* name : {"d.npy", "d.ply", "d.obj"})
        requireDone(desk, std::string("--mesh in.obj --resolution 60 --seed vertex:0 -q -o o.vdb "
                                      "--per-vertex ") +
                              name);

    const std::string on = "--mesh in.obj --resolution 60 -o none.vdb ";
    requireRefused(desk, on + "--seed vertex:441", kUsage, {"441", "0 to 440"});
    requireRefused(desk, on + "--seed vertex:x", kUsage, {"vertex:x", "vertex:123"});
    desk.make("ball.vdb", "sphere --voxel-size 0.1");
    requireRefused(desk, "--sdf ball.vdb --seed +x -o none.vdb", kUsage, {"+x", "level set"});
    requireRefused(desk, "--sdf ball.vdb --seed 0,0,1 --per-vertex d.csv", kUsage,
                   {"--per-vertex", "--mesh"});
}

TEST_CASE("points by their numbers in the file") {
    const TempWorkspace desk;
    writeBytes(desk / "in.xyz", spherePoints(4000));
    requireDone(desk,
                "--points in.xyz --seed vertex:0 --target vertex:3999 --target -z -q -o o.vdb "
                "--report r.json");
    // Both are as far from their poles, and somewhere around them.
    const double z = 1 - 1.0 / 4000, turn = 3999 * M_PI * (3 - std::sqrt(5.0));
    const double exact = std::acos((1 - z * z) * std::cos(turn) - z * z);
    CHECK(distanceOf(desk, 0) == Approx(exact).epsilon(1e-3));
    CHECK(distanceOf(desk, 1) == distanceOf(desk, 0));
    requireRefused(desk, "--points in.xyz --seed vertex:4000 -o n.vdb", kUsage,
                   {"4000", "0 to 3999"});
}

TEST_CASE("meshes and points: godunov, pairs and walks") {
    const TempWorkspace desk;
    writeBytes(desk / "in.xyz", spherePoints(4000));
    writeBytes(desk / "in.obj", sheet(10, [](double, double) { return false; }));
    writeBytes(desk / "p.csv", "0.1,0.2,0.01,0.7,0.9,0.07\n");
    const Result pairs = desk.run("--mesh in.obj --resolution 60 --pairs p.csv -q");
    CHECK(pairs.exitCode == 0);
    CHECK(std::stod(lines(pairs.out)[1].substr(2)) ==
          Approx(std::hypot(0.6 * std::hypot(1, 0.1), 0.7)).epsilon(1e-3));
    const Result walk = desk.run("--mesh in.obj --resolution 60 --shoot 0.5,0.5,0.05,0,1,0,0.3");
    CHECK(walk.err.find("0.3 long, ends at 0.5,0.8,0.05") != std::string::npos);
    // The paper's union of balls: percents off.
    for (const std::string surface : {"--points in.xyz", "--mesh in.obj --resolution 60"}) {
        const std::string ends =
            surface[2] == 'p' ? " --seed 0,0,1 --target 1,0,0" : " --seed 0,0,0 --target 1,1,0.1";
        requireDone(desk, surface + " --scheme godunov -q -o out.vdb --report r.json" + ends);
        CHECK(
            distanceOf(desk, 0) ==
            Approx(surface[2] == 'p' ? M_PI / 2 : std::hypot(std::hypot(1, 0.1), 1)).epsilon(0.03));
    }
}

TEST_CASE("rebuild: fog volumes, other values and unsigned distances") {
    const TempWorkspace desk;
    // Positive inside and twice as steep as a distance.
    desk.make("in.vdb", "sphere --voxel-size 0.04 --half-width 6");
    const auto grid = readVdb(desk / "in.vdb").get<openvdb::FloatGrid>("psi");
    auto write = [&](const std::string& name, openvdb::GridClass c, const auto& value) {
        const auto copy = grid->deepCopy();
        for (auto at = copy->beginValueAll(); at; ++at) at.setValue(float(value(*at)));
        openvdb::tools::changeBackground(copy->tree(), float(value(grid->background())));
        copy->setGridClass(c);
        openvdb::io::File file(desk / name);
        file.write({copy});
        file.close();
    };
    write("fog.vdb", openvdb::GRID_FOG_VOLUME,
          [](float psi) { return std::clamp(0.5 - psi / 0.2, 0.0, 1.0); });
    write("steep.vdb", openvdb::GRID_UNKNOWN, [](float psi) { return 3 * psi + 0.1; });
    write("unsigned.vdb", openvdb::GRID_UNKNOWN, [](float psi) { return std::abs(psi); });
    // At an inactive voxel, where no check of level sets looks.
    grid->tree().setValueOff({0, 0, 0}, std::numeric_limits<float>::infinity());
    write("infinite.vdb", openvdb::GRID_UNKNOWN, [](float psi) { return psi; });
    const std::string ends = " --snap 0.3 --seed 0,0,1 --target 1,0,0 -o out.vdb --report r.json";
    for (const auto& [given, radius] : {std::pair("fog.vdb --rebuild", 1.0),
                                        {"fog.vdb --rebuild --iso 0.25", 1.05},
                                        {"steep.vdb --rebuild --iso 0.1", 1.0},
                                        {"unsigned.vdb --rebuild --iso 0.1", 1.1}}) {
        INFO(given);
        const Result result = desk.run(std::string("--sdf ") + given + ends);
        CHECK(result.exitCode == 0);
        CHECK(result.err.find("warning: psi was rebuilt") != std::string::npos);
        // Triangles between voxels: a hundredth of a voxel.
        CHECK(distanceOf(desk, 0) == Approx(radius * M_PI / 2).epsilon(2e-3));
    }
    requireRefused(desk, "--sdf fog.vdb --seed 0,0,1", kUnusable, {"fog volume", "--rebuild"});
    requireRefused(desk, "--sdf steep.vdb --seed 0,0,1", kUnusable, {"3 per unit", "--rebuild"});
    requireRefused(desk, "--sdf unsigned.vdb --seed 0,0,1", kUnusable, {"positive everywhere"});
    requireRefused(desk, "--sdf fog.vdb --rebuild --iso 7 --seed 0,0,1", kUnusable,
                   {"no surface has the value 7", "from 0 to 1", "fog.vdb", "--iso"});
    requireRefused(desk, "--sdf infinite.vdb --rebuild --seed 0,0,1", kUnusable,
                   {"index 0,0,0 is inf", "infinite.vdb"});
    requireRefused(desk, "--sdf fog.vdb --iso 0.5 --seed 0,0,1", kUsage, {"--iso", "--rebuild"});
}

TEST_CASE("surfaces that are none: refusals") {
    const TempWorkspace desk;
    desk.make("in.vdb", "sphere --voxel-size 0.1");
    writeBytes(desk / "in.obj", sheet(10, [](double, double) { return false; }));
    writeBytes(desk / "broken.ply", "ply\nformat ascii 1.0\nelement vertex 3\n");
    writeBytes(desk / "few.xyz", "0 0 0\n1 0 0\n0 1 0\n");
    writeBytes(desk / "in.txt", "hello\n");
    const std::string seed = " --seed 0,0,1";
    requireRefused(desk, "--seed 0,0,1", kUsage, {"no surface", "--sdf", "--mesh", "--points"});
    requireRefused(desk, "--mesh in.obj --sdf in.vdb" + seed, kUsage, {"--mesh", "--sdf"});
    requireRefused(desk, "--mesh none.obj" + seed, kUnusable, {"none.obj"});
    requireRefused(desk, "--mesh broken.ply" + seed, kUnusable, {"broken.ply"});
    requireRefused(desk, "--mesh in.txt" + seed, kUnusable, {"in.txt"});
    requireRefused(desk, "--points few.xyz" + seed, kUnusable, {"few.xyz", "3"});
    requireRefused(desk, "--points in.txt" + seed, kUnusable, {"in.txt"});
    requireRefused(desk, "--mesh in.obj --voxel-size 1e-7" + seed, kUsage, {"voxels"});
    requireRefused(desk, "--mesh in.obj --voxel-size 1 --resolution 9" + seed, kUsage,
                   {"--resolution", "--voxel-size"});
    requireRefused(desk, "--sdf in.vdb --resolution 64" + seed, kUsage, {"--resolution"});
    requireRefused(desk, "--mesh in.obj --seed 0.5,0.5,3", kUsage, {"seed 0", "--snap"});
    requireRefused(desk, "--mesh in.obj -o o.vdb --report in.obj --seed 0.5,0.5,0.05", kUsage,
                   {"would overwrite the input"});
}

TEST_CASE("a band that needs too much memory is refused with a voxel size that fits") {
    const TempWorkspace desk;
    desk.make("in.vdb", "sphere --voxel-size 0.02");
    writeBytes(desk / "in.obj", sheet(10, [](double, double) { return false; }));
    writeBytes(desk / "in.xyz", spherePoints(4000));
    for (const char* surface : {"--sdf in.vdb --seed 0,0,1", "--points in.xyz --seed 0,0,1",
                                "--mesh in.obj --resolution 1000 --seed 0.5,0.5,0.05"})
        requireRefused(desk, std::string(surface) + " --memory-limit 0.001", kUsage,
                       {"GiB of memory, 0.001 are allowed", "--memory-limit", "voxels of "});
    requireRefused(desk, "--mesh in.obj --voxel-size 4e-5 --seed 0.5,0.5,0.05", kUsage, {"voxels"});
    requireDone(desk, "--sdf in.vdb --seed 0,0,1 --memory-limit 0.1 -q -o out.vdb");
}

}  // namespace igeo::test
