// The subcommand info: what it finds out of good files and of bad ones.
#include <igeo/io/vdb_write.h>
#include <openvdb/tools/MeshToVolume.h>
#include <support/catch.h>
#include <support/clouds.h>
#include <support/mesh_shapes.h>
#include <support/point_grid.h>

#include <cmath>
#include <sstream>

#include "program.h"
#include "vdb_files.h"

namespace igeo::test {

namespace {

/// The JSON, valid by its schema; the words for people end with its verdict.
json surveyed(const TempWorkspace& desk, const std::string& source, int exitCode) {
    const Result asJson = desk.run("info " + source + " --json");
    const Result words = desk.run("info " + source);
    INFO(source << "\n" << words.out << asJson.err << words.err);
    REQUIRE(asJson.exitCode == exitCode);
    CHECK(words.exitCode == exitCode);
    CHECK(asJson.err.empty());
    CHECK(words.err.empty());
    writeBytes(desk / "survey.json", asJson.out);
    CHECK(validBySchema(desk, "info.schema.json", "survey.json"));
    const json j = parseJson(asJson.out);
    CHECK(lines(words.out).back() == j["verdict"].get<std::string>());
    return j;
}

std::string xyz(const igeo::PointCloud& cloud) {
    std::ostringstream text;
    text.precision(17);
    for (const igeo::Vec3d& p : cloud.points) text << p.x << " " << p.y << " " << p.z << "\n";
    return text.str();
}

/// Two squares of side 1, `gap` apart, that look away from each other.
igeo::TriangleMesh plates(double gap) {
    const auto upper = [=](double u, double v) { return igeo::Vec3d{u, v, gap}; };
    const auto lower = [](double u, double v) { return igeo::Vec3d{v, u, 0}; };
    return together(sheet(20, 20, upper), sheet(20, 20, lower));
}

}  // namespace

TEST_CASE("info: shapes are what they are") {
    const TempWorkspace desk;
    struct Case {
        std::string shape;
        std::vector<int> genus, rims;
        std::string verdict;
    };
    const auto& [shape, genus, rims, verdict] =
        GENERATE(Case{"sphere", {0}, {0}, "usable: closed surface, 1 component, genus 0, resolved"},
                 Case{"torus --rotate 1,2,3,40 --translate 1,2,3",
                      {1},
                      {0},
                      "usable: closed surface, 1 component, genus 1, resolved"},
                 Case{"two-spheres --double",
                      {0, 0},
                      {0, 0},
                      "usable: closed surface, 2 components, genus 0 together, resolved"},
                 Case{"plane-patch", {0}, {1}, "usable with care: surface with a rim, 1 component"},
                 Case{"thin-sheet --param thickness=0.1",
                      {0},
                      {0},
                      "usable with care: closed surface, 1 component, genus 0; the surface bends "
                      "or folds within 1.7 voxels on 100 % of it"});
    desk.make("in.vdb", shape);
    const json j = surveyed(desk, "in.vdb", 0);
    CHECK(j["usable"] == true);
    CHECK(j["refusal"].is_null());
    CHECK_THAT(j["verdict"].get<std::string>(), startsWith(verdict));
    CHECK(j["levelSet"]["grid"] == "psi");
    CHECK(j["levelSet"]["voxelSize"].get<double>() == Approx(0.05));
    std::vector<int> foundGenus, foundRims;
    for (const json& component : j["surface"]["components"]) {
        foundGenus.push_back(component["genus"]);
        foundRims.push_back(component["rims"]);
    }
    CHECK(foundGenus == genus);
    CHECK(foundRims == rims);
}

TEST_CASE("info: what it says of the surface is what a run says") {
    const TempWorkspace desk;
    desk.make("in.vdb", "torus");
    const json survey = surveyed(desk, "in.vdb", 0), &s = survey["surface"];
    requireDone(desk, "--sdf in.vdb --seed 1.4,0,0 -q -o out.vdb --report r.json --grids label");
    const json report = readJson(desk / "r.json");
    CHECK(s["band"]["nodes"] == report["band"]["nodes"]);
    CHECK(s["band"]["jetVoxels"] == report["parameters"]["bandVoxels"]);
    CHECK(s["band"]["boundsVoxels"] == report["parameters"]["bandBoundsVoxels"]);
    CHECK(s["curvature"]["percentile95"] == report["surface"]["largestCurvature"]);
    CHECK(s["area"].get<double>() == Approx(report["cells"]["area"].get<double>()).epsilon(1e-9));
    CHECK(survey["levelSet"]["activeVoxels"] == report["surface"]["activeVoxels"]);
    CHECK(survey["grids"][0]["activeVoxels"] == report["surface"]["activeVoxels"]);
    requireDone(desk, "--sdf in.vdb --seed 1.4,0,0 -q -o out.vdb --report g.json --scheme godunov");
    const json godunov = readJson(desk / "g.json");
    CHECK(s["band"]["godunovVoxels"] == godunov["parameters"]["bandVoxels"]);

    Command piped = desk.command("info - --json");
    piped.stdinFile = desk / "in.vdb";
    json fromStream = parseJson(run(piped).out);
    CHECK(fromStream["file"] == "standard input");
    CHECK(fromStream["inputs"][0]["digest"].is_null());
    fromStream["file"] = "in.vdb";
    CHECK(contentOf(fromStream) == contentOf(survey));
}

TEST_CASE("info: whether OpenVDB made a level set from a mesh") {
    const TempWorkspace desk;
    const auto transform = openvdb::math::Transform::createLinearTransform(0.02);
    const std::vector<openvdb::Vec3s> corners{{1, 0, 0},  {-1, 0, 0}, {0, 1, 0},
                                              {0, -1, 0}, {0, 0, 1},  {0, 0, -1}};
    const std::vector<openvdb::Vec3I> octahedron{{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4},
                                                 {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
    const auto grid =
        openvdb::tools::meshToLevelSet<openvdb::FloatGrid>(*transform, corners, octahedron);
    writeVdb(desk / "made.vdb", {grid});
    desk.make("exact.vdb", "box --voxel-size 0.03");
    CHECK(surveyed(desk, "made.vdb", 0)["levelSet"]["conversionUndone"] == true);
    CHECK(surveyed(desk, "exact.vdb", 0)["levelSet"]["conversionUndone"] == false);
    const auto saysSo = [&](const std::string& file) {
        return desk.run("info " + file).out.find("of a mesh by OpenVDB") != std::string::npos;
    };
    CHECK(saysSo("made.vdb"));
    CHECK(!saysSo("exact.vdb"));
}

TEST_CASE("info: a mesh, closed or open") {
    const TempWorkspace desk;
    const double dx = 0.05;
    writeMesh(igeo::test::sphereMesh({1, 2, 3}, 1, 4), desk / "in.ply");
    const json ball = surveyed(desk, "in.ply --voxel-size 0.05", 0);
    CHECK(ball["grids"].empty());
    CHECK(ball["levelSet"].is_null());
    CHECK(ball["points"].is_null());
    CHECK(ball["mesh"]["triangles"] == 20 * 256);
    CHECK(ball["mesh"]["points"] == 10 * 256 + 2);
    CHECK(ball["mesh"]["closed"] == true);
    CHECK(ball["mesh"]["components"] == 1);
    CHECK(ball["verdict"] == "usable: closed surface, 1 component, genus 0, resolved");
    const json &s = ball["surface"], &clearance = s["clearance"];
    CHECK(s["voxelSize"].get<double>() == Approx(dx));
    // Of the flat triangles, edges 0.08 long: short by their square over 8 in the radius.
    CHECK(s["area"].get<double>() == Approx(4 * M_PI).epsilon(0.002));
    // Balls grow to the sphere itself; they stop a twentieth before.
    CHECK(clearance["radius95"].get<double>() == Approx(1).epsilon(0.06));
    CHECK(clearance["resolvingVoxelSize"].get<double>() ==
          Approx(1 / std::sqrt(3.0)).epsilon(0.06));
    // What a run of it says.
    requireDone(desk, "--mesh in.ply --voxel-size 0.05 --seed 1,2,4 -q -o out.vdb --report r.json");
    CHECK(s["band"]["nodes"] == readJson(desk / "r.json")["band"]["nodes"]);
    // By default 256 voxels across.
    CHECK(surveyed(desk, "in.ply", 0)["surface"]["voxelSize"].get<double>() ==
          Approx(2.0 / 256).epsilon(0.01));
    CHECK(surveyed(desk, "in.ply --resolution 20", 0)["surface"]["voxelSize"].get<double>() ==
          Approx(0.1).epsilon(0.01));
    for (const char* threads : {"1", "2"})
        CHECK(contentOf(parseJson(
                  desk.run(std::string("info in.ply --voxel-size 0.05 --json --threads ") + threads)
                      .out)) == contentOf(ball));

    const auto plane = [](double u, double v) { return igeo::Vec3d{u, v, 0.1 * u}; };
    const auto frame = [](double u, double v) {
        return std::abs(u - 0.5) > 0.2 || std::abs(v - 0.5) > 0.2;
    };
    writeMesh(igeo::test::sheet(20, 20, plane, frame), desk / "open.obj");
    const json open = surveyed(desk, "open.obj", 0);
    CHECK(open["mesh"]["closed"] == false);
    // Twenty edges along each side, eight along each side of the hole.
    CHECK(open["mesh"]["boundaryEdges"] == 4 * 20 + 4 * 8);
    CHECK(open["surface"]["components"][0]["rims"] == 2);
    CHECK(open["surface"]["components"][0]["genus"] == 0);
    CHECK(open["surface"]["clearance"]["radius95"].is_null());
    CHECK_THAT(open["verdict"].get<std::string>(),
               startsWith("usable: surface with a rim, 1 component, genus 0"));
}

TEST_CASE("info: which voxels would tell the sheets of a mesh apart") {
    const TempWorkspace desk;
    writeMesh(plates(0.1), desk / "in.ply");
    // M&S (14): half the gap is at least sqrt(3) voxels.
    const double wanted = 0.05 / std::sqrt(3.0);
    const json coarse = surveyed(desk, "in.ply --voxel-size 0.05", 0);
    const json& clearance = coarse["surface"]["clearance"];
    CHECK(clearance["facingRadius99"].get<double>() == Approx(0.05).epsilon(0.06));
    CHECK(clearance["resolvingVoxelSize"].get<double>() == Approx(wanted).epsilon(0.06));
    CHECK_THAT(coarse["verdict"].get<std::string>(), startsWith("usable with care"));
    CHECK(coarse["surface"]["facingShare"] > 0.5);
    const std::string size = std::to_string(0.9 * clearance["resolvingVoxelSize"].get<double>());
    const json fine = surveyed(desk, "in.ply --voxel-size " + size, 0);
    CHECK(fine["surface"]["facingShare"] == 0);
    CHECK(fine["surface"]["components"].size() == 2);
    CHECK_THAT(fine["verdict"].get<std::string>(), startsWith("usable: surface with a rim"));
}

TEST_CASE("info: points, as text, PLY and in a volume") {
    const TempWorkspace desk;
    const igeo::PointCloud cloud = igeo::test::sphereCloud(1000, 1, {0, 0, 0});
    writeBytes(desk / "in.xyz", xyz(cloud));
    const json text = surveyed(desk, "in.xyz", 0);
    CHECK(text["mesh"].is_null());
    CHECK(text["levelSet"].is_null());
    CHECK(text["points"]["points"] == 1000);
    CHECK(text["points"]["components"] == 1);
    const double spacing = text["points"]["spacing"];
    CHECK(text["surface"]["voxelSize"].get<double>() == Approx(spacing / 2));
    CHECK(text["surface"]["components"].size() == 1);
    CHECK(text["surface"]["clearance"]["radius95"].get<double>() == Approx(1).epsilon(0.06));

    // Without faces a .ply is no mesh.
    std::string ply =
        "ply\nformat ascii 1.0\nelement vertex 1000\nproperty double x\n"
        "property double y\nproperty double z\nend_header\n";
    writeBytes(desk / "in.ply", ply + xyz(cloud));
    json same = surveyed(desk, "in.ply", 0);
    same["file"] = "in.xyz";
    CHECK(contentOf(same) == contentOf(text));

    openvdb::io::File(desk / "in.vdb").write({pointGrid(cloud, "scan")});
    const json volume = surveyed(desk, "in.vdb", 0);
    REQUIRE(volume["grids"].size() == 1);
    CHECK(volume["grids"][0]["points"] == true);
    CHECK(volume["grids"][0]["surface"] == false);
    CHECK(volume["points"]["points"] == 1000);
    CHECK_THAT(desk.run("info in.vdb").out, contains("for --points"));
}

TEST_CASE("info: bad files are distinguished, and what can be known of them is said") {
    const TempWorkspace desk;
    const auto refused = [&](const std::string& kind, const std::string& says) {
        desk.make("in.vdb", "bad " + kind);
        const json j = surveyed(desk, "in.vdb", 3);
        INFO(kind << "\n" << j.dump(2));
        CHECK_THAT(j["verdict"].get<std::string>(), startsWith("not usable: "));
        CHECK_THAT(j["verdict"].get<std::string>(), contains(says));
        CHECK(j["usable"] == false);
        CHECK(j["surface"].is_null());
        // The words of the main job.
        const Result run = desk.run("--sdf in.vdb --seed 1,0,0 -q -o out.vdb");
        CHECK(run.err == "implicit-geodesic: error: " + j["refusal"]["what"].get<std::string>() +
                             "\n  " + j["refusal"]["remedy"].get<std::string>() + "\n");
        return j;
    };
    const json fog = refused("fog", "fog volume");
    CHECK(fog["levelSet"].is_null());
    REQUIRE(fog["grids"].size() == 1);
    CHECK(fog["grids"][0]["name"] == "density");
    CHECK(fog["grids"][0]["class"] == "fog volume");
    CHECK(fog["grids"][0]["surface"] == false);
    CHECK(fog["grids"][0]["weight"] == true);
    CHECK(fog["grids"][0]["obstacle"] == true);

    const json whole = refused("int", "int32");
    CHECK(whole["grids"][0]["surface"] == false);
    CHECK(whole["grids"][0]["weight"] == false);
    CHECK(refused("vector", "holds no level set")["grids"][0]["type"] == "vec3s");
    CHECK(refused("no-grids", "holds no grids")["grids"].empty());
    CHECK(refused("two-level-sets", "name one")["grids"].size() == 2);

    const json nan = refused("nan", "NaN");
    CHECK(nan["levelSet"]["badVoxels"] > 0);
    CHECK(nan["levelSet"].count("gradient") == 0);
    const json sheared = refused("sheared", "shears");
    CHECK(sheared["levelSet"].size() == 1);  // its name
    const json hollow = refused("hollow", "hollow");
    CHECK(hollow["levelSet"]["gradient"]["median"] > 0.9);
    // psi in voxels of 0.01: 100, of which the histogram takes up to 4.
    CHECK(refused("scaled-values", "not a distance")["levelSet"]["gradient"]["median"] > 3.9);
    CHECK(refused("empty", "no active voxels")["levelSet"].count("activeVoxels") == 0);

    for (const char* file : {"missing.vdb", "missing.obj", "missing.xyz"})
        CHECK(surveyed(desk, file, 3)["grids"].empty());
    writeBytes(desk / "broken.ply", "ply\nformat ascii 1.0\nelement vertex 3\n");
    writeBytes(desk / "few.xyz", "0 0 0\n1 0 0\n0 1 0\n");
    CHECK_THAT(surveyed(desk, "broken.ply", 3)["verdict"].get<std::string>(),
               contains("broken.ply"));
    CHECK_THAT(surveyed(desk, "few.xyz", 3)["verdict"].get<std::string>(), contains("16"));
    writeBytes(desk / "text.vdb", "v 0 0 0\n");
    CHECK_THAT(surveyed(desk, "text.vdb", 3)["verdict"].get<std::string>(),
               contains("not a VDB file"));
}

TEST_CASE("info: a grid that is named is chosen, as by --sdf") {
    const TempWorkspace desk;
    desk.make("in.vdb", "bad two-level-sets");
    const json j = surveyed(desk, "in.vdb:psi_b", 0);
    CHECK(j["levelSet"]["grid"] == "psi_b");
    CHECK(j["grids"].size() == 2);
    CHECK(surveyed(desk, "in.vdb:psi_c", 3)["grids"].size() == 2);
    const std::string words = desk.run("info in.vdb:psi_b").out;
    CHECK_THAT(words, contains("psi_b: float, level set"));
    CHECK_THAT(words, contains("(chosen)"));
}

TEST_CASE("info: unreliable places as a volume") {
    const TempWorkspace desk;
    desk.make("in.vdb", "box --name shell");
    const Result result = desk.run("info in.vdb --json --unreliable out.vdb");
    INFO(result.err);
    REQUIRE(result.exitCode == 0);
    CHECK_THAT(result.err, contains("in out.vdb"));
    CHECK(desk.run("info in.vdb --unreliable out.vdb -q").err.empty());
    const json unreliable = parseJson(result.out)["surface"]["unreliable"];
    const auto grid = readVdb(desk / "out.vdb").get<openvdb::FloatGrid>("shell_unreliable");
    const auto psi = readVdb(desk / "in.vdb").get<openvdb::FloatGrid>("shell");
    CHECK(grid->activeVoxelCount() == unreliable["nodes"].get<std::uint64_t>());
    CHECK(grid->activeVoxelCount() > 0);
    CHECK(grid->transform() == psi->transform());
    // Not in the middle of a face, on edges only: two coordinates near the half sides.
    for (auto it = grid->cbeginValueOn(); it; ++it) {
        const auto p = grid->indexToWorld(it.getCoord());
        const int near = (std::abs(std::abs(p.x()) - 0.9) < 0.2) +
                         (std::abs(std::abs(p.y()) - 0.7) < 0.2) +
                         (std::abs(std::abs(p.z()) - 0.5) < 0.2);
        if (near < 2 || *it < 1) FAIL("a doubt of " << *it << " at " << p.str());
    }
    // A refused file leaves what is there.
    desk.make("bad.vdb", "bad nan");
    const std::string before = readBytes(desk / "out.vdb");
    CHECK(desk.run("info bad.vdb --unreliable out.vdb").exitCode == 3);
    CHECK((readBytes(desk / "out.vdb") == before));
}

TEST_CASE("info: wrong usage") {
    const TempWorkspace desk;
    desk.make("in.vdb", "sphere --voxel-size 0.1");
    requireRefused(desk, "info", 2, {"required"});
    requireRefused(desk, "info in.vdb --seed 0,0,1", 2, {"--seed"});
    requireRefused(desk, "--seed 0,0,1 info in.vdb", 2, {"info goes before", "--seed"});
    requireRefused(desk, "--sdf in.vdb info in.vdb", 2, {"info goes before", "--sdf"});
    requireRefused(desk, "info in.vdb --voxel-size 0.1", 2, {"--voxel-size", "meshes"});
    writeBytes(desk / "in.xyz", xyz(igeo::test::sphereCloud(400, 1, {0, 0, 0})));
    requireRefused(desk, "info in.xyz --voxel-size 1e-5", 2, {"1.5e-05", "larger voxels"});
    requireRefused(desk, "info in.xyz --voxel-size 1e-4", 2, {"GiB of memory", "would fit"});
    requireRefused(desk, "info in.vdb --unreliable -", 2, {"--unreliable", "stdout"});
    requireRefused(desk, "info in.vdb --unreliable in.vdb", 2, {"overwrite"});
    requireRefused(desk, "info in.vdb --unreliable none/out.vdb", 2, {"no folder 'none'"});
    // A name is no subcommand.
    CHECK(desk.run("--sdf in.vdb --seed 0,0,1 --name info -o out.vdb -q").exitCode == 0);
    CHECK(desk.run("info -help").out == desk.run("info --help").out);
    CHECK_THAT(desk.run("info --help").out, contains("--unreliable"));
}

}  // namespace igeo::test
