// Weights, curvature and obstacles from the command line.
#include <fmt/core.h>
#include <openvdb/tools/ValueTransformer.h>
#include <support/catch.h>
#include <support/vdb_file.h>

#include <cmath>
#include <fstream>
#include <limits>

#include "program.h"
#include "vdb_files.h"

namespace igeo::test {
using openvdb::FloatGrid;

namespace {

/// A weight of its own resolution around the unit sphere: value(x, y, z) on a lattice of 0.17,
/// background 0.
FloatGrid::Ptr weightGrid(const std::function<double(const openvdb::Vec3d&)>& value,
                          double reach = 1.4) {
    const auto grid = FloatGrid::create(0);
    grid->setName("weight");
    grid->setTransform(openvdb::math::Transform::createLinearTransform(0.17));
    const int n = int(reach / 0.17);
    grid->denseFill(openvdb::CoordBBox({-n, -n, -n}, {n, n, n}), 1);
    for (auto at = grid->beginValueOn(); at; ++at) at.setValue(1);
    grid->tree().voxelizeActiveTiles();
    for (auto at = grid->beginValueOn(); at; ++at)
        at.setValue(float(value(grid->indexToWorld(at.getCoord()))));
    return grid;
}

/// A desk with the unit sphere of 20 voxels and a constant weight.
struct WeighedSphere : TempWorkspace {
    explicit WeighedSphere(double weight = 1) {
        make("in.vdb", "sphere --voxel-size 0.05");
        writeVdb(*this / "w.vdb", {weightGrid([=](auto&) { return weight; })});
    }
};

}  // namespace

TEST_CASE("a constant weight scales distances and lengths") {
    const WeighedSphere desk(4);
    const std::string query =
        "--sdf in.vdb --seed 0,0,1 --target 0.6,0,-0.8 --report r.json -q --scheme " +
        GENERATE(as<std::string>(), "jet", "godunov");
    requireDone(desk, query + " -o plain.vdb");
    const json plain = reportOf(desk);
    requireDone(desk, query + " -o heavy.vdb --weight w.vdb");
    const json heavy = reportOf(desk);

    const auto a = readDistance(desk / "plain.vdb"), b = readDistance(desk / "heavy.vdb");
    openvdb::tools::foreach (a->beginValueOn(), [](const auto& at) { at.setValue(4 * *at); });
    CHECK(largestDifference(*a, *b) == 0);
    CHECK(b->metaValue<std::string>("geodesic_weight") == "w.vdb");
    const json &before = plain["targets"][0], &after = heavy["targets"][0];
    // Between voxels directions are normalized in single precision.
    CHECK(after["distance"].get<double>() ==
          Approx(4 * before["distance"].get<double>()).epsilon(1e-6));
    CHECK(after["weightedLength"].get<double>() ==
          Approx(4 * before["weightedLength"].get<double>()));
    CHECK(after["length"].get<double>() == Approx(before["length"].get<double>()));
    CHECK(before["weightedLength"] == before["length"]);
    CHECK(heavy["metric"]["weights"] == json({"w.vdb"}));
    CHECK(heavy["metric"]["least"] == 4);
    CHECK(heavy["metric"]["largest"] == 4);
    CHECK(plain["metric"] == json({{"weights", json::array()},
                                   {"obstacles", json::array()},
                                   {"least", 1},
                                   {"largest", 1},
                                   {"blocked", 0}}));
}

TEST_CASE("weights multiply, from the same file by name as well") {
    const TempWorkspace desk;
    desk.make("psi.vdb", "sphere --voxel-size 0.05");
    const auto psi = readVdb(desk / "psi.vdb").get<FloatGrid>("psi");
    const auto two = weightGrid([](auto&) { return 2.0; }),
               three = weightGrid([](auto&) { return 3.0; });
    two->setName("two"), three->setName("three");
    writeVdb(desk / "all.vdb", {psi, two, three});
    requireDone(desk,
                "--sdf all.vdb:psi --seed 0,0,1 --weight all.vdb:two --weight all.vdb:three -q "
                "-o six.vdb --report r.json");
    CHECK(reportOf(desk)["metric"]["least"] == 6);
    CHECK(reportOf(desk)["distance"]["max"].get<double>() == Approx(6 * M_PI).epsilon(2e-3));
    requireRefused(desk, "--sdf all.vdb:psi --seed 0,0,1 --weight all.vdb -o out.vdb", kUnusable,
                   {"all.vdb", "'two'", "'three'"});
    requireRefused(desk, "--sdf all.vdb:psi --seed 0,0,1 --weight all.vdb:four -o out.vdb",
                   kUnusable, {"all.vdb", "'four'", "'three'"});
}

TEST_CASE("a weight that varies makes paths bend, and near queries agree with whole ones") {
    const TempWorkspace desk;
    desk.make("in.vdb", "sphere --voxel-size 0.05");
    // Light near the equator, so that it pays to walk along it.
    writeVdb(desk / "w.vdb",
             {weightGrid([](const openvdb::Vec3d& p) { return 0.5 + 4 * p.z() * p.z(); })});
    const std::string seed = "--sdf in.vdb --weight w.vdb --seed 0.8,0,0.6 -q --report r.json ",
                      query = seed + "--target -0.8,0,0.6 ";
    requireDone(desk, query + "-o whole.vdb --straighten");
    const json path = reportOf(desk)["targets"][0];
    CHECK(path["weightedLength"].get<double>() ==
          Approx(path["distance"].get<double>()).epsilon(5e-3));
    // Over the top it is 2 acos(0.6) = 1.85 long.
    CHECK(path["length"].get<double>() > 2);
    CHECK(reportOf(desk)["accuracy"]["meanRelativeError"].get<double>() < 5e-3);

    requireDone(desk, seed + "-o near.vdb --max-distance 1");
    const auto whole = readDistance(desk / "whole.vdb"), near = readDistance(desk / "near.vdb");
    CHECK(near->activeVoxelCount() > 300);
    CHECK(near->activeVoxelCount() < whole->activeVoxelCount() / 4);
    CHECK(largestDifference(*whole, *near) < 1e-4);
    requireDone(desk, query + "-o stop.vdb --stop-at-targets");
    CHECK(reportOf(desk)["targets"][0]["distance"].get<double>() ==
          Approx(path["distance"].get<double>()));
}

TEST_CASE("weights that are none are refused with value and place") {
    const TempWorkspace desk;
    desk.make("in.vdb", "sphere --voxel-size 0.05");
    struct Bad {
        double value;
        std::string says;
    };
    const Bad bad = GENERATE(Bad{0, "the weight is 0"}, Bad{-2, "the weight is -"},
                             Bad{std::numeric_limits<double>::quiet_NaN(), "nan"},
                             Bad{std::numeric_limits<double>::infinity(), "inf"});
    writeVdb(desk / "w.vdb",
             {weightGrid([&](const openvdb::Vec3d& p) { return p.x() > 0.3 ? bad.value : 1; })});
    requireRefused(desk, "--sdf in.vdb --seed 0,0,1 --weight w.vdb -o out.vdb --report out.json",
                   kUnusable, {"w.vdb", "'weight'", bad.says, "0."});
}

TEST_CASE("a weight that does not cover the surface is refused") {
    const TempWorkspace desk;
    desk.make("in.vdb", "sphere --voxel-size 0.05");
    writeVdb(desk / "small.vdb", {weightGrid([](auto&) { return 1.0; }, 0.7)});
    requireRefused(desk, "--sdf in.vdb --seed 0,0,1 --weight small.vdb -o out.vdb", kUnusable,
                   {"small.vdb", "'weight'", "cover"});
    auto far = weightGrid([](auto&) { return 1.0; });
    far->transform().postTranslate({10, 0, 0});
    writeVdb(desk / "far.vdb", {far});
    requireRefused(desk, "--sdf in.vdb --seed 0,0,1 --weight far.vdb -o out.vdb", kUnusable,
                   {"far.vdb", "'weight'"});
    requireRefused(desk, "--sdf in.vdb --seed 0,0,1 --weight none.vdb -o out.vdb", kUnusable,
                   {"none.vdb", "cannot read"});
    requireRefused(desk, "--sdf - --seed 0,0,1 --weight - -o out.vdb", kUsage,
                   {"standard input", "once"});
    requireRefused(desk, "--sdf in.vdb --seed 0,0,1 --weight small.vdb -o small.vdb", kUsage,
                   {"overwrite", "small.vdb"});
}

TEST_CASE("curvature comes as grids and as a weight") {
    const TempWorkspace desk;
    desk.make("in.vdb", "torus --voxel-size 0.05");
    requireDone(
        desk,
        "--sdf in.vdb --seed 1.4,0,0 --target -1.4,0,0 -q -o out.vdb --report r.json --grids "
        "curvature,weight --weight-curvature crest,eps=0.1,p=1 --curvature-scale 2");
    const VdbFile file = readVdb(desk / "out.vdb");
    const auto most = file.get<FloatGrid>("psi_curvature_max"),
               least = file.get<FloatGrid>("psi_curvature_min"),
               mean = file.get<FloatGrid>("psi_curvature_mean"),
               gaussian = file.get<FloatGrid>("psi_curvature_gaussian"),
               weight = file.get<FloatGrid>("psi_weight");
    CHECK(most->activeVoxelCount() == weight->activeVoxelCount());
    // Tube of 0.4 around a circle of 1: k1 = 1 / 0.4, and k2 = 1 / 1.4 outside, -1 / 0.6 inside.
    auto at = [](const FloatGrid& g, double x) {
        return g.tree().getValue(openvdb::Coord::round(g.worldToIndex({x, 0, 0})));
    };
    CHECK(at(*most, 1.4) == Approx(2.5).epsilon(0.05));
    CHECK(at(*least, 1.4) == Approx(1 / 1.4).epsilon(0.05));
    CHECK(at(*least, 0.6) == Approx(-1 / 0.6).epsilon(0.05));
    CHECK(at(*mean, 1.4) == Approx((2.5 + 1 / 1.4) / 2).epsilon(0.05));
    CHECK(at(*gaussian, 0.6) == Approx(-2.5 / 0.6).epsilon(0.08));
    CHECK(at(*weight, 0.6) > at(*weight, 1.4));
    CHECK(reportOf(desk)["metric"]["weights"] == json({"curvature crest,eps=0.1,p=1"}));

    requireRefused(desk, "--sdf in.vdb --seed 1.4,0,0 --weight-curvature hill -o out.vdb", kUsage,
                   {"hill", "valley, crest"});
    requireRefused(desk, "--sdf in.vdb --seed 1.4,0,0 --weight-curvature valley,eps=0 -o out.vdb",
                   kUsage, {"eps=0", "above 0"});
    requireRefused(desk, "--sdf in.vdb --seed 1.4,0,0 --weight-curvature valley,q=3 -o out.vdb",
                   kUsage, {"q=3"});
}

TEST_CASE("paths lead around obstacles of every kind") {
    const TempWorkspace desk;
    desk.make("in.vdb", "sphere --voxel-size 0.05");
    desk.make("ball.vdb", "sphere --voxel-size 0.02 --param radius=0.4 --param center=1,0,0");
    // The same ball as a mask of coarse voxels.
    const auto mask = openvdb::MaskGrid::create();
    mask->setTransform(openvdb::math::Transform::createLinearTransform(0.04));
    for (int x = 10; x <= 40; ++x)
        for (int y = -12; y <= 12; ++y)
            for (int z = -12; z <= 12; ++z)
                if ((mask->indexToWorld(openvdb::Coord(x, y, z)) - openvdb::Vec3d(1, 0, 0))
                        .length() < 0.4)
                    mask->tree().setValueOn({x, y, z});
    writeVdb(desk / "mask.vdb", {mask});
    const std::string obstacle =
        GENERATE(as<std::string>(), "--obstacle-sphere 1,0,0,0.4", "--obstacle ball.vdb",
                 "--obstacle mask.vdb",
                 "--obstacle-box 0.7,-0.25,-0.25,1.3,0.25,0.25 --obstacle-sphere 1,0,0,0.4");
    const std::string ends = " --seed 0.6,0,0.8 --target 0.6,0,-0.8";
    INFO(obstacle);
    requireDone(desk, "--sdf in.vdb -q --straighten -o out.vdb --report r.json " + obstacle + ends);
    const json r = reportOf(desk);
    // The cap has the angular radius 2 asin(0.2) = 0.403; the ends are 0.927 from its middle.
    const double alpha = 2 * std::asin(0.2), beta = std::acos(0.6),
                 exact = 2 * std::acos(std::cos(beta) / std::cos(alpha)) +
                         std::sin(alpha) * (M_PI - 2 * std::acos(std::tan(alpha) / std::tan(beta)));
    // A quarter of a voxel of 0.05 around the rim, which turns by 0.65: 0.4 %. Voxels of the mask
    // reach half their diagonal, 0.035, further out: 1.2 %.
    const double slack = obstacle.find("mask") == std::string::npos ? 0.004 : 0.016;
    CHECK(r["targets"][0]["distance"].get<double>() == Approx(exact).epsilon(slack));
    CHECK(r["targets"][0]["weightedLength"].get<double>() == Approx(exact).epsilon(slack));
    CHECK(r["metric"]["blocked"] > 100);
    CHECK(r["metric"]["obstacles"].size() >= 1);

    requireRefused(desk,
                   "--sdf in.vdb -o out.vdb --report out.json " + obstacle + " --seed 1,0,0.05",
                   kUsage, {"seed 0", "inside an obstacle", "move it"});
    requireRefused(
        desk, "--sdf in.vdb -o out.vdb --report out.json " + obstacle + ends + " --target 1,0,0.05",
        kUsage, {"target 1", "inside an obstacle"});
}

TEST_CASE("seeds from which no front starts are refused") {
    const TempWorkspace desk;
    desk.make("in.vdb", "sphere --voxel-size 0.05");
    std::ofstream(desk / "line.json") << "[[0.1, 0, 1], [0, 0, 1], [0, 0.1, 1]]";
    const std::string in = "--sdf in.vdb -o out.vdb ";
    requireRefused(desk, in + "--seed-curve line.json --obstacle-sphere 0,0,1,0.4", kUsage,
                   {"line.json", "inside obstacles", "move it"});
    requireDone(desk, in + "-q --seed-curve line.json --obstacle-sphere 0.1,0,1,0.06");
    std::ofstream(desk / "late.csv") << "0,0,1,5\n";
    requireRefused(desk, in + "--seeds late.csv --max-distance 1", kUsage,
                   {"starts at 5", "largest distance, 1", "larger limit"});
}

TEST_CASE("a wall leaves what is behind it unreached") {
    const WeighedSphere desk;
    const Result result = desk.run(
        "--sdf in.vdb --seed 0,0,1 --target 0,0,-1 --obstacle-box -2,-2,-0.01,2,2,0.01 "
        "-o out.vdb --report r.json");
    CHECK(result.exitCode == kUnreached);
    CHECK_THAT(result.err, contains("no path on the surface joins it to a seed"));
    const auto grid = readDistance(desk / "out.vdb");
    for (auto at = grid->cbeginValueOn(); at; ++at)
        if (grid->indexToWorld(at.getCoord()).z() < -0.1) FAIL("a voxel behind the wall");
    CHECK(reportOf(desk)["targets"][0]["status"] == "unreachable");
}

TEST_CASE("what is said of costs and obstacles does not depend on the results asked for") {
    const TempWorkspace desk;
    desk.make("in.vdb", "sphere --voxel-size 0.05");
    writeVdb(
        desk / "w.vdb",
        {weightGrid([](const openvdb::Vec3d& p) { return std::exp(2 * std::sin(20 * p.x())); })});
    std::ofstream(desk / "pairs.csv") << "0,0,1,0,0,-1\n";
    for (const std::string asked :
         {"--seed 0,0,1 -o out.vdb", "--seed 0,0,1 --target 1,0,0 --matrix m.csv",
          "--pairs pairs.csv --pairs-out p.csv"}) {
        INFO(asked);
        const Result idle = desk.run("--sdf in.vdb --obstacle-sphere 9,9,9,1 " + asked);
        CHECK_THAT(idle.err, contains("no obstacle meets the surface"));
        const Result steep = desk.run("--sdf in.vdb --weight w.vdb " + asked);
        CHECK_THAT(steep.err, contains("weights change by more than 40 % per voxel"));
        const Result behind = desk.run("--sdf in.vdb --obstacle-sphere 0,1,0,0.1 " + asked);
        if (asked[2] == 's')
            CHECK_THAT(behind.err, contains("0.2 % of the surface is not reached"));
    }
}

TEST_CASE("a tensor makes one direction more expensive than another") {
    const TempWorkspace desk;
    desk.make("in.vdb", "plane-patch --voxel-size 0.02 --param size=1.6");
    // Along x a step costs three times as much.
    auto tensor = [](const std::string& name, const openvdb::Vec3f& value) {
        const auto grid = openvdb::Vec3SGrid::create(value);
        grid->setName(name);
        grid->setTransform(openvdb::math::Transform::createLinearTransform(0.5));
        grid->denseFill(openvdb::CoordBBox({-3, -3, -3}, {3, 3, 3}), value);
        return grid;
    };
    writeVdb(desk / "g.vdb", {tensor("diagonal", {9, 1, 1}), tensor("offdiagonal", {0, 0, 0})});
    const std::string scheme = GENERATE(as<std::string>(), "jet", "godunov");
    requireDone(desk,
                "--sdf in.vdb --metric g.vdb --seed 0.01,0.01,0 --target 0.51,0.01,0 --target "
                "0.01,0.51,0 --target 0.31,0.41,0 -q -o out.vdb --report r.json --scheme " +
                    scheme);
    const json targets = reportOf(desk)["targets"];
    const double slack = scheme == "jet" ? 2e-3 : 2e-2;
    CHECK(targets[0]["distance"].get<double>() == Approx(1.5).epsilon(slack));
    CHECK(targets[1]["distance"].get<double>() == Approx(0.5).epsilon(slack));
    CHECK(targets[2]["distance"].get<double>() == Approx(std::hypot(0.9, 0.4)).epsilon(slack));
    CHECK(targets[2]["length"].get<double>() == Approx(0.5).epsilon(slack));

    writeVdb(desk / "bad.vdb", {tensor("diagonal", {1, -1, 1})});
    requireRefused(desk, "--sdf in.vdb --metric bad.vdb --seed 0,0,0 -o out.vdb", kUnusable,
                   {"bad.vdb", "positive definite"});
    requireRefused(desk, "--sdf in.vdb --metric in.vdb --seed 0,0,0 -o out.vdb", kUnusable,
                   {"in.vdb", "diagonal"});
}

TEST_CASE("bending around a cylinder is avoided or preferred") {
    const TempWorkspace desk;
    desk.make("in.vdb", "cylinder --voxel-size 0.05");
    // Radius 0.5; a quarter of the circle around, and 0.4 up. With L = 0.5 sqrt(3) bends count
    // twice.
    const std::string query =
        "--sdf in.vdb --seed 0.5,0,0 --target 0,0.5,0 --target 0.5,0,0.4 --target 0,-0.5,0.3 -q -o "
        "out.vdb --report r.json --metric-curvature ";
    auto distances = [&](const std::string& kind) {
        requireDone(desk, query + kind + ",length=0.8660254");
        std::vector<double> d;
        const json all = reportOf(desk);
        for (const json& t : all["targets"]) d.push_back(t["distance"]);
        return d;
    };
    // Curvature is smoothed over 2 voxels of a radius of 10, so 1 % of the cost.
    const double quarter = M_PI / 4, slack = 0.01;
    const auto avoid = distances("avoid");
    CHECK(avoid[0] == Approx(2 * quarter).epsilon(slack));
    CHECK(avoid[1] == Approx(0.4).epsilon(slack));
    CHECK(avoid[2] == Approx(std::hypot(2 * quarter, 0.3)).epsilon(slack));
    const auto prefer = distances("prefer");
    CHECK(prefer[0] == Approx(quarter).epsilon(slack));
    CHECK(prefer[1] == Approx(0.8).epsilon(slack));
    CHECK(prefer[2] == Approx(std::hypot(quarter, 0.6)).epsilon(slack));
    requireRefused(desk, "--sdf in.vdb --seed 0.5,0,0 --metric-curvature love -o out.vdb", kUsage,
                   {"'love'", "avoid", "prefer"});
    requireRefused(desk, "--sdf in.vdb --seed 0.5,0,0 --metric-curvature avoid,length=0 -o out.vdb",
                   kUsage, {"length=0", "above 0"});
    requireRefused(desk,
                   "--sdf in.vdb --seed 0.5,0,0 --metric-curvature avoid --scheme godunov -o "
                   "out.vdb",
                   kUsage, {"diagonal", "jet"});
}

TEST_CASE("costs from curvature on a mesh with wide facets get a warning") {
    const TempWorkspace desk;
    std::string mesh;
    for (int k = 0; k < 12; ++k)
        for (const double z : {0.0, 1.0})
            mesh += fmt::format("v {} {} {}\n", std::cos(k * M_PI / 6), std::sin(k * M_PI / 6), z);
    for (int k = 0; k < 12; ++k) {
        const int a = 2 * k + 1, b = 2 * ((k + 1) % 12) + 1;
        mesh += fmt::format("f {} {} {} {}\n", a, b, b + 1, a + 1);
    }
    writeBytes(desk / "prism.obj", mesh);
    const auto warned = [&](const std::string& options) {
        requireDone(desk,
                    "--mesh prism.obj --voxel-size 0.04 --seed 1,0,0.5 -q -o o.vdb --report "
                    "r.json " +
                        options);
        const std::string all = reportOf(desk)["warnings"].dump();
        return all.find("facets of the mesh are wider than") != std::string::npos;
    };
    CHECK(warned("--metric-curvature avoid"));
    CHECK(warned("--weight-curvature mean"));
    CHECK(!warned("--metric-curvature avoid --curvature-scale 3"));
    CHECK(!warned(""));
}

TEST_CASE("obstacles that are none are refused") {
    const WeighedSphere desk;
    const std::string query = "--sdf in.vdb --seed 0,0,1 -o out.vdb --report out.json ";
    requireRefused(desk, query + "--obstacle-sphere 1,2,3", kUsage, {"1,2,3", "x,y,z,r"});
    requireRefused(desk, query + "--obstacle-sphere 1,2,3,-1", kUsage, {"-1", "not above 0"});
    requireRefused(desk, query + "--obstacle-box 1,2,3,4", kUsage, {"1,2,3,4", "corners"});
    requireRefused(desk, query + "--obstacle none.vdb", kUnusable, {"none.vdb", "cannot read"});
    desk.make("vector.vdb", "bad vector");
    requireRefused(desk, query + "--obstacle vector.vdb", kUnusable, {"vector.vdb", "velocity"});
}

}  // namespace igeo::test
