// What runs and info say of surfaces that are not quite what they seem: faces that cross or are
// given twice, plates and folds narrower than voxels, rims.
#include <igeo/io/triangle_mesh.h>
#include <openvdb/tools/MeshToVolume.h>
#include <support/catch.h>
#include <support/clouds.h>
#include <support/errors.h>
#include <support/exact.h>
#include <support/mesh_shapes.h>
#include <support/shapes.h>
#include <support/vdb_file.h>

#include <algorithm>
#include <cmath>
#include <sstream>

#include "program.h"

namespace igeo::test {
using igeo::Vec3d;

namespace {

TriangleMesh boxFrom(const Vec3d& low, const Vec3d& size) {
    return moved(boxMesh(size), [&](const Vec3d& p) { return p + low; });
}

std::string pointRows(const std::vector<Vec3d>& points) {
    std::ostringstream text;
    text.precision(17);
    for (const Vec3d& p : points) text << p.x << " " << p.y << " " << p.z << "\n";
    return text.str();
}

/// Two slabs on a floor with a slot between them, 20 deep.
TriangleMesh slabsOnFloor(double slot) {
    const double t = 10, right = 2 * t + slot, top = 30;
    TriangleMesh mesh = prismMesh({{0, 0},
                                   {right, 0},
                                   {right, top},
                                   {t + slot, top},
                                   {t + slot, t},
                                   {t, t},
                                   {t, top},
                                   {0, top}},
                                  24, [](double x, double y, double z) {
                                      return Vec3d{x, y, z};
                                  });
    for (const auto& [a, b, c] : std::vector<TriangleMesh::Triangle>{
             {0, 1, 4}, {0, 4, 5}, {1, 2, 3}, {1, 3, 4}, {0, 5, 6}, {0, 6, 7}}) {
        mesh.triangles.push_back({2 * a, 2 * b, 2 * c});
        mesh.triangles.push_back({2 * a + 1, 2 * c + 1, 2 * b + 1});
    }
    return mesh;
}

/// As OpenVDB converts a mesh, voxels of 1 in general position.
openvdb::FloatGrid::Ptr convertedMesh(const TriangleMesh& mesh) {
    const auto transform = rotatedTransform(1, {1, 2, 3}, 40, {0.1, 0.2, 0.3});
    std::vector<openvdb::Vec3s> points;
    std::vector<openvdb::Vec3I> triangles;
    for (const Vec3d& p : mesh.points) points.emplace_back(openvdb::Vec3d(p.x, p.y, p.z));
    for (const auto& t : mesh.triangles) triangles.emplace_back(t[0], t[1], t[2]);
    const auto grid =
        openvdb::tools::meshToLevelSet<openvdb::FloatGrid>(*transform, points, triangles);
    grid->setName("psi");
    return grid;
}

}  // namespace

TEST_CASE("off the rim of an open sheet, runs speak of meshes and points") {
    const TempWorkspace desk;
    const auto incline = [](const Vec3d& p) { return Vec3d{p.x, p.y, 0.1 * p.x}; };
    writeMesh(sheet(20, 20,
                    [&](double u, double v) {
                        return incline({u, v, 0});
                    }),
              desk / "in.obj");
    PointCloud cloud = movedCloud(squareCloud(40, 1.0 / 40), incline);
    writeBytes(desk / "in.xyz", pointRows(cloud.points));
    // Another sheet two and a half spacings above it.
    cloud = joinedClouds(cloud, movedCloud(cloud, [](const Vec3d& p) {
                             return p + Vec3d{0, 0, 2.5 / 40};
                         }));
    writeBytes(desk / "two.xyz", pointRows(cloud.points));
    for (const std::string surface : {"in.obj --resolution 80", "in.xyz", "two.xyz"}) {
        const bool mesh = surface.find("obj") != std::string::npos;
        for (const std::string result :
             {"-v --shoot 0.5,0.5,0.05,10,1,1,2", "--grids surface,engraved,curvature --extend",
              "--image x.png --image-size 64x48 --mesh-out m.ply --isolines i.json",
              "--scheme godunov -v"}) {
            INFO(surface << " " << result);
            const Result run =
                desk.run((mesh ? "--mesh " : "--points ") + surface +
                         " --seed -0.02,0.5,0 --target 1.01,1.02,0.1 -o o.vdb " + result);
            INFO(run.err);
            CHECK(run.exitCode == 0);
            for (const std::string word : {"psi", "|grad", "edge of the volume"})
                CHECK((run.out + run.err).find(word) == std::string::npos);
            if (result.find("--shoot") != std::string::npos)
                CHECK(run.err.find("where the surface ends") != std::string::npos);
            if (surface == "two.xyz") CHECK(run.err.find("another sheet") != std::string::npos);
        }
        const std::string info = desk.run("info " + surface).out;
        CHECK(info.find("rim") != std::string::npos);
        CHECK(info.find("psi") == std::string::npos);
    }
}

TEST_CASE("faces of a mesh that cross are counted, by a run and info") {
    const TempWorkspace desk;
    // A bar through one triangle of a plate's top and one of its bottom: two of the bar's triangles
    // on each side cross both.
    writeMesh(together(boxFrom({0, 0, 0}, {1, 1, 0.2}), boxFrom({0.5, 0.2, -0.5}, {0.1, 0.1, 1.2})),
              desk / "in.obj");
    const std::string words = "16 pairs of faces cross";
    const Result run = requireDone(
        desk, "--mesh in.obj --resolution 40 --seed 0.1,0.1,0.2 --target 0.8,0.1,0.2 -o o.vdb");
    CHECK(run.err.find("warning: " + words + ": the mesh passes through itself") !=
          std::string::npos);
    const Result info = desk.run("info in.obj --resolution 40");
    CHECK(info.exitCode == 0);
    CHECK(info.out.find(words) != std::string::npos);
    CHECK(parseJson(desk.run("info in.obj --resolution 40 --json").out)["mesh"]["crossingPairs"] ==
          16);
}

TEST_CASE("a mesh is split where vertices lie in its edges, and its faces stay") {
    const TempWorkspace desk;
    // Two squares side by side, the second in three strips.
    const TriangleMesh one = sheet(1, 1,
                                   [](double u, double v) {
                                       return Vec3d{u, v, 0};
                                   }),
                       three = sheet(1, 3, [](double u, double v) {
                           return Vec3d{1 + u, v, 0};
                       });
    const TriangleMesh mesh = together(one, three);
    writeMesh(mesh, desk / "in.obj");
    const Result run = requireDone(desk,
                                   "in.obj --resolution 40 --seed 0.1,0.5,0 -o o.vdb "
                                   "--per-vertex out.obj");
    // Two along each side in common, and one and three at the ends.
    CHECK(run.err.find("warning: the mesh is open: 8 boundary edges in 1 hole") !=
          std::string::npos);
    CHECK(run.err.find("parts of the mesh meet") == std::string::npos);
    const auto written = lines(readBytes(desk / "out.obj"));
    CHECK(std::count_if(written.begin(), written.end(), [](const std::string& line) {
              return line[0] == 'f';
          }) == std::ptrdiff_t(mesh.triangles.size()));
    CHECK(desk.run("info in.obj --resolution 40").out.find("edges split at 2 points in them") !=
          std::string::npos);
    CHECK(parseJson(desk.run("info in.obj --resolution 40 --json").out)["mesh"]["junctions"] == 2);
}

TEST_CASE("faces given twice are dropped, and distances are those without them") {
    const TempWorkspace desk;
    const TriangleMesh once = together(sphereMesh({}, 1, 2), boxFrom({2, 0, 0}, {1, 0.7, 0.5}));
    TriangleMesh twice = once;
    for (const auto& [a, b, c] : once.triangles) twice.triangles.push_back({b, a, c});
    writeMesh(once, desk / "once.obj");
    writeMesh(twice, desk / "twice.obj");
    const std::string asked =
        " --voxel-size 0.06 --seed vertex:0 --seed vertex:162 -o o.vdb --per-vertex ";
    CHECK(requireDone(desk, "--mesh once.obj" + asked + "once.csv").err.find("repeat") ==
          std::string::npos);
    const std::string words = std::to_string(once.triangles.size()) +
                              " triangles repeat others, in the same or the "
                              "opposite order of corners";
    CHECK(requireDone(desk, "--mesh twice.obj" + asked + "twice.csv").err.find(words) !=
          std::string::npos);
    CHECK(readBytes(desk / "twice.csv") == readBytes(desk / "once.csv"));
    CHECK(lines(readBytes(desk / "once.csv")).size() == once.points.size() + 1);
    CHECK(desk.run("info twice.obj --voxel-size 0.06").out.find(words) != std::string::npos);
}

TEST_CASE("targets and samples on both sides of a plate a third of a voxel thick") {
    const TempWorkspace desk;
    const openvdb::Vec3d half(0.5, 0.3, 0.0035);
    const auto turn = rotatedTransform(1, {1, 2, 3}, 40, {0.1, 0.2, 0.3});
    const auto turned = [&](const Vec3d& p) {
        return fromVdb(turn->indexToWorld(openvdb::Vec3d(p.x, p.y, p.z)));
    };
    writeMesh(moved(boxFrom(-1 * fromVdb(half), 2 * fromVdb(half)), turned), desk / "in.obj");
    std::vector<Vec3d> targets;
    for (const double side : {-half.z(), half.z()})
        for (int k = 0; k < 40; ++k)
            targets.push_back(turned(
                {0.9 * std::sin(7.0 * k) * half.x(), 0.9 * std::cos(3.0 * k) * half.y(), side}));
    writeBytes(desk / "seed.txt", pointRows({turned({-0.38, -0.17, half.z()})}));
    writeBytes(desk / "targets.txt", pointRows(targets));
    requireDone(desk,
                "--mesh in.obj --voxel-size 0.02 --seeds seed.txt --targets targets.txt -q "
                "-o o.vdb --report r.json --samples s.csv");
    double off = 0, error = 0, path = 0, sampled = 0;
    // Back on the box before it was turned, without rounding.
    const auto onPlate = [&](const Vec3d& world) {
        openvdb::Vec3d p = turn->worldToIndex({world.x, world.y, world.z});
        double out = 0, least = kInfinity;
        for (int a = 0; a < 3; ++a) {
            const double beyond = std::abs(p[a]) - half[a];
            out = std::max(out, beyond), least = std::min(least, std::abs(beyond));
            if (std::abs(beyond) < 1e-8) p[a] = std::copysign(half[a], p[a]);
        }
        off = std::max({off, out, least});
        return p;
    };
    const auto exactTo = [&](const openvdb::Vec3d& p) {
        return geodesicOnBox({0, 0, 0}, half, {-0.38, -0.17, half.z()}, p);
    };
    const json report = reportOf(desk);
    REQUIRE(report["targets"].size() == targets.size());
    for (std::size_t k = 0; k < targets.size(); ++k) {
        const json &t = report["targets"][k], &p = t["target"]["position"];
        const double exact = exactTo(onPlate({p[0], p[1], p[2]}));
        CHECK(length(Vec3d{p[0], p[1], p[2]} - targets[k]) < 1e-9);
        error = std::max(error, std::abs(t["distance"].get<double>() - exact));
        path = std::max(path, std::abs(t["length"].get<double>() - exact));
    }
    const std::vector<std::string> rows = lines(readBytes(desk / "s.csv"));
    CHECK(rows.size() > 2000);
    for (std::size_t k = 1; k < rows.size(); ++k) {
        std::vector<double> row;
        std::istringstream line(rows[k]);
        for (std::string word; std::getline(line, word, ',');) row.push_back(std::stod(word));
        const double exact = exactTo(onPlate({row[0], row[1], row[2]}));
        sampled = std::max(sampled, std::abs(row[6] - exact));
    }
    std::printf(
        "plate of 0.35 voxels: positions %.2g off its triangles, targets %.3f voxels, paths %.2g, "
        "samples %.3f voxels\n",
        off, error / 0.02, path / 0.02, sampled / 0.02);
    CHECK(off < 1.5e-9);           // measured 9.8e-10
    CHECK(error < 0.059 * 0.02);   // measured 0.039 voxels
    CHECK(path < 5.4e-8 * 0.02);   // measured 3.6e-8 voxels, as printed
    CHECK(sampled < 0.46 * 0.02);  // measured 0.306 voxels
}

TEST_CASE("a fold that a conversion closed is said with its share, by a run and info") {
    const TempWorkspace desk;
    for (const double slot : {0.9, 4.0}) {
        INFO("slot of " << slot << " voxels");
        writeVdb(desk / "in.vdb", {convertedMesh(slabsOnFloor(slot))});
        const Result run = requireDone(
            desk, "--sdf in.vdb --seed 0,12,20 --target 5,12,30 -o o.vdb --report r.json");
        const std::string info = desk.run("info in.vdb").out;
        const double share = reportOf(desk)["unresolved"]["closedShare"];
        const std::string begin = "psi contradicts itself next to ";
        const std::size_t at = run.err.find(begin);
        std::printf("slot of %.1f voxels: closed next to %.3g %% of the surface\n", slot,
                    100 * share);
        REQUIRE((at != std::string::npos) == (slot < 1));
        CHECK((info.find(begin) != std::string::npos) == (slot < 1));
        if (slot > 1) continue;
        const std::string sentence = run.err.substr(at, run.err.find('\n', at) - at);
        CHECK(sentence.find("folds or gaps of up to two voxels were closed") != std::string::npos);
        CHECK(std::stod(sentence.substr(begin.size())) == Approx(100 * share).epsilon(0.05));
        CHECK(sentence.find(" % of the surface") != std::string::npos);
        CHECK(info.find(sentence) != std::string::npos);
    }
}

TEST_CASE("paths with long steps are warned of on level sets, not on the mesh itself") {
    const TempWorkspace desk;
    const auto warns = [&](const std::string& surface, double thickness) {
        const std::string z = std::to_string(thickness / 2);
        requireDone(desk, surface + " --seed 0.1,0.2," + z + " --target 0.1,0.2,-" + z +
                              " --target -0.4,0.1," + z + " --target 0.5,-0.3,-" + z +
                              " -o o.vdb --report r.json");
        const json report = reportOf(desk);
        for (const json& w : report["warnings"])
            if (w.get<std::string>().find("a step of more than 2.5 voxels") != std::string::npos)
                return true;
        return false;
    };
    // Voxels of 0.04. Through a plate of a fifth of a voxel paths step from one side to the other.
    for (const double thickness : {0.008, 0.04}) {
        INFO(thickness);
        const Vec3d size{1.6, 1.2, thickness};
        desk.make("in.vdb",
                  "thin-sheet --voxel-size 0.04 --rotate 1,2,3,20 --translate 0.01,0.02,0.013 "
                  "--param thickness=" +
                      std::to_string(thickness));
        writeMesh(boxFrom(-0.5 * size, size), desk / "in.obj");
        CHECK(warns("--sdf in.vdb", thickness) == (thickness < 0.01));
        CHECK_FALSE(warns("--mesh in.obj --voxel-size 0.04", thickness));
    }
}

}  // namespace igeo::test
