// Files of curves, byte by byte where they are text.
#include <igeo/results/curve_files.h>
#include <support/catch.h>
#include <support/meshed.h>
#include <support/two_isolines.h>

namespace igeo::test {
namespace {

Similarity halved() {
    Similarity t;
    t.dx = 0.5;
    t.origin = {10, 20, 30};
    return t;
}

/// A path of two vertices, one without, one of one vertex.
std::vector<NamedCurve> paths() {
    NamedCurve path{
        "target_0", 0,     false, {{1.0 / 3, 0, 0}, {1, 0, 0.5}}, {{0, 0, 1}, {0, 1, 0}},
        {0, 2},     {3, 1}};
    NamedCurve none{"target_1", 1, false, {}, {}, {}, {}};
    NamedCurve point{"pair_0", 2, false, {{5, 5, 5}}, {{1, 0, 0}}, {0}, {0}};
    return {path, none, point};
}

std::string isolines(const std::string& ending) {
    std::vector<Isoline> lines = twoLines();
    lines.push_back(lines[1]);  // another of the same level
    return curveFile(ending, CurveKind::Isoline, namedCurves(lines, halved()));
}

}  // namespace

TEST_CASE("curveFile: paths as CSV, with the doubles as they are") {
    CHECK(curveFile(".csv", CurveKind::Path, paths()) ==
          "path,vertex,x,y,z,arcLength,distance,nx,ny,nz\n"
          "0,0,0.33333333333333331,0,0,0,3,0,0,1\n"
          "0,1,1,0,0.5,2,1,0,1,0\n"
          "2,0,5,5,5,0,0,1,0,0\n");
}

TEST_CASE("curveFile: isolines as CSV; closed ones come back") {
    CHECK(isolines(".csv") ==
          "line,level,vertex,x,y,z,arcLength,nx,ny,nz\n"
          "0,2,0,10,20,30,0,0,0,1\n"
          "0,2,1,10.5,20,30,0.5,0,0,1\n"
          "0,2,2,10,20.5,30,1.2071067811865475,0,0,1\n"
          "0,2,3,10,20,30,1.7071067811865475,0,0,1\n"
          "1,3,0,10,20,30.5,0,1,0,0\n"
          "1,3,1,10,20,31,0.5,1,0,0\n"
          "2,3,0,10,20,30.5,0,1,0,0\n"
          "2,3,1,10,20,31,0.5,1,0,0\n");
}

TEST_CASE("curveFile: OBJ has an object per level and an edge per segment") {
    CHECK(isolines(".obj") ==
          "# isolines of the geodesic distance, world units; the normal vn of each vertex v\n"
          "o isoline_2\n"
          "v 10 20 30\nvn 0 0 1\nv 10.5 20 30\nvn 0 0 1\nv 10 20.5 30\nvn 0 0 1\n"
          "l 1 2\nl 2 3\nl 3 1\n"
          "o isoline_3\n"
          "v 10 20 30.5\nvn 1 0 0\nv 10 20 31\nvn 1 0 0\n"
          "v 10 20 30.5\nvn 1 0 0\nv 10 20 31\nvn 1 0 0\n"
          "l 4 5\nl 6 7\n");
    CHECK(curveFile(".obj", CurveKind::Path, paths()) ==
          "# geodesics, world units; the normal vn of each vertex v\n"
          "o target_0\n"
          "v 0.33333333333333331 0 0\nvn 0 0 1\nv 1 0 0.5\nvn 0 1 0\n"
          "l 1 2\n");
}

TEST_CASE("curveFile: PLY has vertices and edges") {
    const Ply ply = parsePly(isolines(".ply"));
    using Rows = std::vector<std::vector<double>>;
    const Rows& vertex = ply.rows.at("vertex");
    REQUIRE(vertex.size() == 7);
    CHECK(vertex[1] == std::vector<double>{10.5, 20, 30, 0, 0, 1, 2, 0.5, 0});
    CHECK(vertex[6] == std::vector<double>{10, 20, 31, 1, 0, 0, 3, 0.5, 2});
    CHECK(ply.properties.at("vertex") == std::vector<std::string>{"x", "y", "z", "nx", "ny", "nz",
                                                                  "distance", "arcLength", "line"});
    CHECK(ply.rows.at("edge") == Rows{{0, 1}, {1, 2}, {2, 0}, {3, 4}, {5, 6}});
    CHECK(ply.properties.at("edge") == std::vector<std::string>{"vertex1", "vertex2"});
    const Ply path = parsePly(curveFile(".ply", CurveKind::Path, paths()));
    CHECK(path.value("vertex", 0, "x") == 1.0 / 3);
    CHECK(path.rows.at("edge") == Rows{{0, 1}});
    CHECK(parsePly(curveFile(".ply", CurveKind::Path, {})).rows.at("vertex").empty());
}

TEST_CASE("curveFile: USD has a prim per level, with names of its own") {
    const std::string text = isolines(".usda");
    CHECK(text.substr(0, 10) == "#usda 1.0\n");
    for (const char* part :
         {"defaultPrim = \"isolines\"", "def BasisCurves \"isoline_2\"",
          "def BasisCurves \"isoline_3\"", "uniform token type = \"linear\"",
          "int[] curveVertexCounts = [4]\n", "int[] curveVertexCounts = [2, 2]\n",
          "point3f[] points = [(10, 20, 30), (10.5, 20, 30), (10, 20.5, 30), (10, 20, 30)]\n",
          "normal3f[] normals = [(1, 0, 0), (1, 0, 0), (1, 0, 0), (1, 0, 0)] (\n",
          "float[] primvars:distance = [2, 2, 2, 2] (\n",
          "float[] primvars:arcLength = [0, 0.5, 0, 0.5] (\n",
          "float3[] extent = [(10, 20, 30.5), (10, 20, 31)]\n"}) {
        INFO(part);
        CHECK(text.find(part) != std::string::npos);
    }
    // Levels whose names USD cannot tell apart.
    std::vector<Isoline> lines = twoLines();
    lines[0].level = 2e-5, lines[1].level = 2e5;
    const std::string two =
        curveFile(".usda", CurveKind::Isoline, namedCurves(lines, Similarity{}));
    CHECK(two.find("\"isoline_2e_05\"") != std::string::npos);
    CHECK(two.find("\"isoline_200000\"") != std::string::npos);
    lines[0].level = 1e-20, lines[1].level = 1e20;
    CHECK(curveFile(".usda", CurveKind::Isoline, namedCurves(lines, Similarity{}))
              .find("\"isoline_1e_20_2\"") != std::string::npos);
}

}  // namespace igeo::test
