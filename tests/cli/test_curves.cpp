// Files of paths and isolines, and the options that make them.
#include <support/catch.h>

#include <algorithm>
#include <cmath>
#include <sstream>

#include "program.h"

namespace igeo::test {
namespace {

/// A box of 2 by 3 by 1.
void makeBox(const TempWorkspace& desk) {
    writeBytes(desk / "box.obj",
               "v 0 0 0\nv 2 0 0\nv 2 3 0\nv 0 3 0\nv 0 0 1\nv 2 0 1\nv 2 3 1\nv 0 3 1\n"
               "f 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n");
}
const std::string kBox = "--mesh box.obj --resolution 40 -q ";

std::vector<std::vector<double>> rowsOf(const std::string& csv) {
    std::vector<std::vector<double>> rows;
    const std::vector<std::string> all = lines(csv);
    for (std::size_t k = 1; k < all.size(); ++k) {
        rows.emplace_back();
        std::istringstream in(all[k]);
        for (std::string cell; std::getline(in, cell, ',');) rows.back().push_back(std::stod(cell));
    }
    return rows;
}

json documentOf(const TempWorkspace& desk, const std::string& file) {
    return readJson(desk / file);
}

}  // namespace

TEST_CASE("every kind of path is in JSON and CSV with the same numbers") {
    const TempWorkspace desk;
    makeBox(desk);
    writeBytes(desk / "pairs.csv", "1,1,1,1,1,0\n0,0,0,2,3,1\n");
    writeBytes(desk / "belt.csv", "1,0.5,1\n2,0.5,0.5\n1,0.5,0\n0,0.5,0.5\n1,0.5,1\n");
    const std::string run = kBox +
                            "--seed 1,1,1 --target 1,1,0 --shoot 1,1,1,0,1,0,2 --pairs pairs.csv "
                            "--pairs-out d.csv --via vertex:0;2,0,1 --via belt.csv -o o.vdb "
                            "--straighten --paths ";
    requireDone(desk, run + "p.json");
    requireDone(desk, run + "p.csv");
    CHECK(validBySchema(desk, "geodesics.schema.json", "p.json"));
    const json document = documentOf(desk, "p.json");
    CHECK(document["pairs"][1]["pair"] == 1);
    CHECK(document["pairs"][0]["length"].get<double>() == Approx(3).epsilon(1e-12));
    CHECK(document["via"][0]["length"].get<double>() == Approx(std::sqrt(5.0)).epsilon(1e-12));
    CHECK(document["via"][1]["length"].get<double>() == Approx(6).epsilon(1e-12));
    CHECK(document["via"][1]["closed"] == true);
    std::vector<std::vector<double>> expected;
    double number = 0;
    for (const char* kind : {"paths", "walks", "pairs", "via"})
        for (const json& path : document[kind]) {
            const json& v = path["vertices"];
            for (std::size_t k = 0; k < v["position"].size(); ++k) {
                std::vector<double> row{number, double(k)};
                for (const json& x : v["position"][k]) row.push_back(x);
                row.push_back(v["arcLength"][k]);
                row.push_back(v["distance"][k]);
                for (const json& x : v["normal"][k]) row.push_back(x);
                expected.push_back(row);
            }
            ++number;
        }
    CHECK(number == 6);
    CHECK((rowsOf(readBytes(desk / "p.csv")) == expected));
}

TEST_CASE("isolines in CSV and JSON, with the normals of a turned sphere") {
    const TempWorkspace desk;
    desk.make("in.vdb", "sphere --voxel-size 0.05 --rotate 1,2,3,40");
    const std::string run = "--sdf in.vdb --seed 0,0,1 --spacing 0.5 -o o.vdb -q --isolines ";
    requireDone(desk, run + "i.json");
    requireDone(desk, run + "i.csv");
    CHECK(validBySchema(desk, "isolines.schema.json", "i.json"));
    const json document = documentOf(desk, "i.json");
    const auto rows = rowsOf(readBytes(desk / "i.csv"));
    std::size_t row = 0, line = 0;
    double off = 0;
    for (const json& isoline : document["isolines"]) {
        const std::size_t n = isoline["position"].size();
        for (std::size_t k = 0; k < n + std::size_t(isoline["closed"] == true); ++k, ++row) {
            const std::vector<double> p = isoline["position"][k % n], m = isoline["normal"][k % n];
            REQUIRE(rows.at(row).size() == 10);
            CHECK(rows[row][0] == double(line));
            CHECK(rows[row][1] == isoline["level"].get<double>());
            CHECK(std::vector(rows[row].begin() + 3, rows[row].begin() + 6) == p);
            CHECK(std::vector(rows[row].begin() + 7, rows[row].end()) == m);
            for (std::size_t a = 0; a < 3; ++a) off = std::max(off, std::abs(p[a] - m[a]));
        }
        CHECK(rows[row - 1][6] == Approx(isoline["length"].get<double>()).epsilon(1e-12));
        ++line;
    }
    CHECK(row == rows.size());
    CHECK(off < 2e-3);  // positions are normals here
}

TEST_CASE("options --path-step and --path-offset") {
    const TempWorkspace desk;
    makeBox(desk);
    const std::string run = kBox + "--seed 1,1,1 --target 1,1,0 --straighten -o o.vdb --paths ";
    requireDone(desk, run + "p.csv --path-step 0.3 --path-offset 0.1");
    const auto rows = rowsOf(readBytes(desk / "p.csv"));
    REQUIRE(rows.size() == 11);  // over 3
    for (std::size_t k = 0; k < rows.size(); ++k) {
        const auto& r = rows[k];
        CHECK(r[5] == Approx(0.3 * double(k)).margin(1e-9));
        CHECK(r[6] == Approx(3 - 0.3 * double(k)).margin(1e-9));
        // A tenth above the face that the vertex is on.
        const double above = std::max({-r[2], r[2] - 2, -r[3], r[3] - 3, -r[4], r[4] - 1});
        CHECK(above == Approx(0.1).margin(1e-9));
    }
    requireDone(desk, run + "q.csv --path-step 0.3 --path-offset -0.1");
    for (const auto& r : rowsOf(readBytes(desk / "q.csv")))
        CHECK(std::max({-r[2], r[2] - 2, -r[3], r[3] - 3, -r[4], r[4] - 1}) ==
              Approx(-0.1).margin(1e-9));
    requireRefused(desk, run + "p.csv --path-step 1e-9", 2, {"--path-step", "1e7"});
    requireRefused(desk, run + "p.csv --path-step 0", 2, {"--path-step"});
}

TEST_CASE("paths through points: what goes wrong is said") {
    const TempWorkspace desk;
    desk.make("in.vdb", "two-spheres");
    writeBytes(desk / "apart.csv", "1.2,0,0\n-1.2,0,0\n");
    writeBytes(desk / "cap.json", "[[0.9,0.1,0.45],[0.9,-0.1,0.45],[0.6,0,0.49],[0.9,0.1,0.45]]");
    writeBytes(desk / "off.csv", "1.2,0,0\n9,9,9\n");
    writeBytes(desk / "one.csv", "1.2,0,0\n");
    const std::string run = "--sdf in.vdb --paths p.json --via ";
    Result result = desk.run(run + "apart.csv");
    CHECK(result.exitCode == 4);
    CHECK(result.err.find("no path on the surface joins its points") != std::string::npos);
    CHECK(documentOf(desk, "p.json")["via"][0]["status"] == "unreachable");
    CHECK(validBySchema(desk, "geodesics.schema.json", "p.json"));
    result = desk.run(run + "cap.json --straighten");
    CHECK(result.exitCode == 4);
    CHECK(result.err.find("contracts to a point") != std::string::npos);
    CHECK(documentOf(desk, "p.json")["via"][0]["status"] == "stalled");
    requireRefused(desk, run + "off.csv", 2, {"--via off.csv", "point 1", "from the surface"});
    requireRefused(desk, run + "one.csv", 2, {"--via one.csv", "1 points", "2 or more"});
    requireRefused(desk, run + "none.csv", 3, {"none.csv"});
    writeBytes(desk / "bad.json", "[[1,0,0],[1,0]]");
    requireRefused(desk, run + "bad.json", 3, {"bad.json", "entry 1"});
    requireRefused(desk, run + "1.2,0,0", 2, {"1.2,0,0", "one point", "with blanks"});
    requireRefused(desk, run + "1.2,0,0;points.csv", 2, {"'points.csv'"});
    requireRefused(desk, run + "p.json", 2, {"p.json", "overwrite"});
    requireRefused(desk, "--sdf in.vdb --seed 1.2,0,0 -o o.vdb --path-step 1", 2,
                   {"--path-step", "--paths"});
    requireRefused(desk, "--sdf in.vdb --seed 1.2,0,0 -o o.vdb --paths p.ply", 2,
                   {"--paths", "--via"});
}

}  // namespace igeo::test
