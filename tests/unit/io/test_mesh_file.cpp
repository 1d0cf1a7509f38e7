#include <igeo/io/detail/file_bytes.h>
#include <igeo/io/mesh_file.h>
#include <support/binary.h>
#include <support/catch.h>
#include <support/expect_error.h>
#include <support/mesh_shapes.h>
#include <support/temp_dir.h>

#include <algorithm>
#include <cctype>
#include <fstream>
#include <iostream>
#include <numeric>
#include <sstream>

namespace igeo {
namespace {

using Kind = Error::Kind;
using test::TempDir;

double volume(const TriangleMesh& mesh) {
    double v = 0;
    for (const auto& [a, b, c] : mesh.triangles)
        v += dot(mesh.points[a], cross(mesh.points[b], mesh.points[c])) / 6;
    return v;
}

TEST_CASE("every format gives the same mesh", "[mesh]") {
    const TempDir dir;
    const TriangleMesh sphere = test::sphereMesh({0.3, -0.2, 0.1}, 1.5, 3);
    struct Case {
        const char* name;
        bool text;
        double scale;
        Vec3d shift;
    };
    for (const Case& c :
         {Case{"a.obj", false, 1, {}}, Case{"a.off", false, 1, {}}, Case{"a.ply", false, 1, {}},
          Case{"b.ply", true, 1, {}}, Case{"a.stl", false, 1, {}}, Case{"b.stl", true, 1, {}},
          Case{"a.gltf", false, 2, {1, 2, 3}}}) {
        INFO(c.name << (c.text ? " as text" : ""));
        test::writeMesh(sphere, dir / c.name, c.text);
        const TriangleMesh mesh = readMesh(dir / c.name);
        CHECK(mesh.file == dir / c.name);
        CHECK(mesh.points.size() == sphere.points.size());
        CHECK(mesh.triangles.size() == sphere.triangles.size());
        CHECK(mesh.dropped == 0);
        CHECK(meshTopology(mesh).closed());
        // Single precision is good to 6e-8 of a coordinate, here at most 8.
        double off = 0;
        for (std::size_t t = 0; t < sphere.triangles.size() && t < mesh.triangles.size(); ++t)
            for (std::size_t k = 0; k < 3; ++k) {
                const Vec3d p = c.scale * sphere.points[sphere.triangles[t][k]] + c.shift;
                off = std::max(off, length(mesh.points[mesh.triangles[t][k]] - p));
            }
        CHECK(off < 2.45e-7);  // measured 1.6e-7
        CHECK(mesh.warnings.empty());
    }
}

TEST_CASE("of faces in both orders one is left", "[mesh]") {
    // Squares, whose ears are equally good, and a hexagon; the second sides begin anywhere.
    const TempDir dir;
    std::ostringstream points, faces;
    constexpr int kSide = 6;
    for (int x = 0; x <= kSide; ++x)
        for (int y = 0; y <= kSide; ++y) points << "v " << x / 7.0 << " " << y / 7.0 << " 0\n";
    auto at = [](int x, int y) { return 1 + x * (kSide + 1) + y; };
    auto add = [&](std::vector<int> corners, int turn) {
        for (int sides = 0; sides < 2; ++sides) {
            faces << "f";
            for (const int c : corners) faces << " " << c;
            faces << "\n";
            std::reverse(corners.begin(), corners.end());
            std::rotate(corners.begin(), corners.begin() + turn, corners.end());
        }
    };
    for (int x = 0; x < kSide; ++x)
        for (int y = 0; y < kSide; ++y)
            add({at(x, y), at(x + 1, y), at(x + 1, y + 1), at(x, y + 1)}, (x + y) % 4);
    for (int k = 0; k < 6; ++k)
        points << "v " << 3 + std::cos(k * M_PI / 3) << " " << std::sin(k * M_PI / 3) << " 0\n";
    const int first = at(kSide, kSide) + 1;
    add({first, first + 1, first + 2, first + 3, first + 4, first + 5}, 2);
    const TriangleMesh mesh = readMesh(dir.write("two.obj", points.str() + faces.str()));
    CHECK(mesh.triangles.size() == 2 * kSide * kSide + 4);
    CHECK(mesh.repeated == mesh.triangles.size());
    CHECK(mesh.dropped == mesh.repeated);
    CHECK(meshTopology(mesh).nonManifoldEdges == 0);
}

TEST_CASE("polygons of many corners are cut, of too many refused", "[mesh]") {
    // A star: every second corner is concave. Its area is that of n triangles of two radii.
    const TempDir dir;
    auto star = [&](int corners) {
        std::ostringstream out;
        for (int k = 0; k < corners; ++k) {
            const double radius = k % 2 == 0 ? 1 : 0.75, angle = 2 * M_PI * k / corners;
            out << "v " << radius * std::cos(angle) << " " << radius * std::sin(angle) << " 0\n";
        }
        out << "f";
        for (int k = 0; k < corners; ++k) out << " " << k + 1;
        return dir.write("star.obj", out.str() + "\n");
    };
    for (const int corners : {6, 200, 2000}) {
        const TriangleMesh mesh = readMesh(star(corners));
        CHECK(mesh.triangles.size() == std::size_t(corners - 2));
        // Written with six digits: each corner is off by 1e-6 at most.
        CHECK(meshArea(mesh) ==
              Approx(0.5 * 0.75 * corners * std::sin(2 * M_PI / corners)).epsilon(1e-5));
    }
    test::expectError(Kind::BadInput, {"star.obj", "20002 corners", "20000"},
                      [&] { readMesh(star(20002)); });
}

TEST_CASE(
    "polygons with corners in one line, and around holes, become triangles that do not overlap",
    "[mesh]") {
    PolygonMesh angle, comb, frame;
    angle.vertices = {{0, 0, 0},   {10, 0, 0},  {20, 0, 0},  {40, 0, 0},  {40, 5, 0},
                      {40, 10, 0}, {25, 10, 0}, {10, 10, 0}, {10, 25, 0}, {10, 40, 0},
                      {5, 40, 0},  {0, 40, 0},  {0, 20, 0}};
    comb.vertices = {{0, 0, 0}, {80, 0, 0}};
    for (double x = 80; x > 0; x -= 10)
        for (const Vec3d& p : {Vec3d{x, 30, 0}, {x - 5, 30, 0}, {x - 5, 6, 0}, {x - 10, 6, 0}})
            comb.vertices.push_back(p);
    // In to the hole and back: the two corners there are twice in the file.
    frame.vertices = {{0, 0, 0},   {40, 0, 0},  {40, 40, 0}, {0, 40, 0},  {0, 0, 0},
                      {10, 10, 0}, {10, 30, 0}, {30, 30, 0}, {30, 10, 0}, {10, 10, 0}};
    const std::array<std::pair<PolygonMesh*, double>, 3> all{
        {{&angle, 700}, {&comb, 1440}, {&frame, 1200}}};
    constexpr int kTurns = 100;
    for (const auto& [polygon, area] : all) {
        int overlap = 0, flat = 0;
        for (int n = 0; n < kTurns; ++n) {
            PolygonMesh turned = *polygon;
            const double a = 0.37 * n, b = 0.61 * n;
            for (Vec3d& p : turned.vertices) {
                p = {std::cos(a) * p.x - std::sin(a) * p.y, std::sin(a) * p.x + std::cos(a) * p.y,
                     0};
                p = {p.x, std::cos(b) * p.y, std::sin(b) * p.y};
            }
            std::vector<std::uint32_t> corners(turned.vertices.size());
            std::iota(corners.begin(), corners.end(), 0);
            turned.addFace(corners);
            const TriangleMesh mesh = meshOf(turned, "polygon");
            overlap += std::abs(meshArea(mesh) - area) > 1e-6;
            for (const auto& [i, j, k] : mesh.triangles)
                flat += length(cross(mesh.points[j] - mesh.points[i],
                                     mesh.points[k] - mesh.points[i])) < 1;
        }
        CAPTURE(area);
        CHECK(overlap == 0);  // before, 5 of the angle, 100 of the frame
        CHECK(flat == 0);     // before, 32, 221 and 36
    }
}

TEST_CASE("polygons become triangles and a mirroring node keeps the outside outside", "[mesh]") {
    const TempDir dir;
    const std::string cube =
        dir.write("cube.OBJ",
                  "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 "
                  "1\nv 0 1 1\nf 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 "
                  "8 7\nf 4 1 5 8\n");
    const TriangleMesh mesh = readMesh(cube);
    CHECK(mesh.points.size() == 8);
    CHECK(mesh.triangles.size() == 12);
    CHECK(volume(mesh) == Approx(1));
    CHECK(meshArea(mesh) == Approx(6));

    // An L, whose corner 5 is in the middle of a fan from corner 1.
    const TriangleMesh bent = readMesh(dir.write(
        "bent.ply",
        "ply\nformat ascii 1.0\nelement vertex 6\nproperty double x\nproperty double y\n"
        "property uchar red\nproperty double z\nelement face 1\nproperty list uchar int "
        "vertex_index\nproperty float quality\nend_header\n0 0 9 1\n3 0 9 1\n3 1 9 1\n1 1 9 1\n"
        "1 3 9 1\n0 3 9 1\n6 1 2 3 4 5 0 0.5\n"));
    CHECK(bent.triangles.size() == 4);
    CHECK(meshArea(bent) == Approx(5));
    CHECK(test::turnedEdges(bent) == 0);

    test::writeMesh(mesh, dir / "mirrored.gltf");
    std::ifstream in(dir / "mirrored.gltf");
    std::stringstream text;
    text << in.rdbuf();
    std::string turned = text.str();
    const std::string scale = "[2,2,2]";
    turned.replace(turned.find(scale), scale.size(), "[-2,2,2]");
    CHECK(volume(readMesh(dir.write("turned.gltf", turned))) == Approx(8));
}

TEST_CASE("vertices keep the numbers of the file", "[mesh]") {
    const TempDir dir;
    // A quad and a triangle; vertex 0 is no corner, 5 is 2 again.
    const std::string faces = "3 1 2 3\n4 5 1 4 2\n";
    const char* const vertices = "9 9 9\n0 0 0\n1 0 0\n0 0.1 0\n1 1 0.1234567890123\n1 0 0\n";
    std::string obj = "# a comment\nmtllib none.mtl\no thing\n";
    std::istringstream each(vertices);
    for (std::string line; std::getline(each, line);) obj += "v " + line + " 1 0 0\n";
    obj += "vt 0 0\nvn 0 0 1\ns off\nf 2/1/1 3//1 4/1\nf -1 \\\n 2 5 3\n";
    for (const std::string& file :
         {dir.write("a.obj", obj), dir.write("a.off", "OFF\n6 2 0\n" + (vertices + faces)),
          dir.write("b.off", "COFF 6 2 0 # counts\n" + (vertices + faces))}) {
        INFO(file);
        const TriangleMesh mesh = readMesh(file);
        REQUIRE(mesh.source);
        REQUIRE(mesh.source->vertices.size() == 6);
        CHECK(mesh.source->vertices[4].z == 0.1234567890123);
        REQUIRE(mesh.source->faces() == 2);
        const auto quad = mesh.source->face(1);
        CHECK(std::vector<std::uint32_t>(quad.begin(), quad.end()) ==
              std::vector<std::uint32_t>{5, 1, 4, 2});
        CHECK(mesh.points.size() == 4);
        CHECK(mesh.pointOfVertex[0] == TriangleMesh::kNoPoint);
        CHECK(mesh.pointOfVertex[5] == mesh.pointOfVertex[2]);
        for (std::size_t v = 1; v < 6; ++v)
            CHECK(mesh.points[mesh.pointOfVertex[v]] == mesh.source->vertices[v]);
    }
    using test::expectError;
    expectError(Kind::BadInput, {"a.obj, line 2", "'1.x'"},
                [&] { readMesh(dir.write("a.obj", "v 0 0 0\nv 1 1.x 0\n")); });
    expectError(Kind::BadInput, {"a.obj", "vertex 4 of 3"},
                [&] { readMesh(dir.write("a.obj", "f 1 2 4\nv 0 0 0\nv 1 0 0\nv 0 1 0\n")); });
    expectError(Kind::BadInput, {"a.obj, line 4", "vertex -4 of 3"},
                [&] { readMesh(dir.write("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 -4\n")); });
    expectError(Kind::BadInput, {"a.off, line 4", "2 of 3 vertices"},
                [&] { readMesh(dir.write("a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n")); });
    expectError(Kind::BadInput, {"a.off", "vertex 3 of 3"}, [&] {
        readMesh(dir.write("a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n"));
    });
    expectError(Kind::BadInput, {"a.off", "4OFF"},
                [&] { readMesh(dir.write("a.off", "4OFF\n1 0 0\n0 0 0 0\n")); });
}

TEST_CASE("what makes no triangle is left out", "[mesh]") {
    const TempDir dir;
    // A point that is off by rounding, a triangle twice, one without area, a line, a lone point.
    const TriangleMesh mesh =
        readMesh(dir.write("odd.obj",
                           "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nv 1.0000002 0 0\nv 7 7 0.5\n"
                           "f 1 2 3\nf 5 4 3\nf 3 2 1\nf 1 2 5\nl 1 4\n"));
    CHECK(mesh.points.size() == 4);
    CHECK(mesh.triangles.size() == 2);
    CHECK(mesh.dropped == 2);
    CHECK(meshTopology(mesh).boundaryEdges == 4);
}

TEST_CASE("coordinates far from the origin are warned of", "[mesh]") {
    const TempDir dir;
    const TriangleMesh far = test::moved(test::sphereMesh({}, 100, 1), [](const Vec3d& p) {
        return p + Vec3d{4.5e6, 0, 0};
    });
    test::writeMesh(far, dir / "far.stl", true);
    const TriangleMesh mesh = readMesh(dir / "far.stl");
    REQUIRE(mesh.warnings.size() == 1);
    CHECK(mesh.warnings[0].find("4.5e+06") != std::string::npos);
    CHECK(mesh.warnings[0].find("origin") != std::string::npos);
}

TEST_CASE("files that are no meshes are refused", "[mesh]") {
    const TempDir dir;
    std::ostringstream printed;
    auto* before = std::cerr.rdbuf(printed.rdbuf());
    auto* beforeOut = std::cout.rdbuf(printed.rdbuf());
    using test::expectError;
    expectError(Kind::Io, {"none.obj", "No such file"}, [&] { readMesh(dir / "none.obj"); });
    expectError(Kind::Io, {"folder"}, [&] { readMesh(dir.path().string()); });
    expectError(Kind::BadInput, {"empty"}, [&] { readMesh(dir.write("empty.ply", "")); });
    expectError(Kind::BadInput, {"a.txt", ".obj", ".glb"},
                [&] { readMesh(dir.write("a.txt", "v 0 0 0\n")); });
    for (const char* name :
         {"junk.obj", "junk.ply", "junk.stl", "junk.off", "junk.gltf", "junk.glb"}) {
        INFO(name);
        std::string junk = "\x01\x02 nothing of the kind \xff\n";
        for (int k = 0; k < 6; ++k) junk += junk;
        expectError(Kind::BadInput, {name}, [&] { readMesh(dir.write(name, junk)); });
    }
    expectError(Kind::BadInput, {"readPointCloud"}, [&] {
        readMesh(
            dir.write("points.ply",
                      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float "
                      "y\nproperty float z\nend_header\n0 0 0\n1 0 0\n0 1 0\n"));
    });
    for (const char* corner : {"3", "-1", "0.5", "nan"})
        expectError(Kind::BadInput, {"corner.ply, byte", corner + std::string(" of 3")}, [&] {
            readMesh(dir.write("corner.ply",
                               "ply\nformat ascii 1.0\nelement face 1\nproperty list uchar float "
                               "vertex_indices\nelement vertex 3\nproperty float x\nproperty float "
                               "y\nproperty float z\nend_header\n3 0 1 " +
                                   std::string(corner) + "\n0 0 0\n1 0 0\n0 1 0\n"));
        });
    expectError(Kind::BadInput, {"readPointCloud"},
                [&] { readMesh(dir.write("points.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n")); });
    for (const char* number : {"nan", "inf", "1e+300", "-1e+300"})
        expectError(Kind::BadInput, {"far.off", "1, " + std::string(number) + ", 0", "1e+30"}, [&] {
            readMesh(dir.write(
                "far.off", std::string("OFF\n3 1 0\n0 0 0\n1 ") + number + " 0\n0 1 0\n3 0 1 2\n"));
        });
    expectError(Kind::BadInput, {"shrunk"},
                [&] { readMesh(dir.write("dot.obj", "v 0 0 0\nv 0 0 0\nv 0 0 0\nf 1 2 3\n")); });
    // Cut off anywhere: an error where the format knows how much there should be, never a crash.
    const TriangleMesh sphere = test::sphereMesh({}, 1, 2);
    for (const char* name : {"cut.ply", "cut.stl", "cut.gltf", "cut.off", "cut.obj"})
        for (int part = 1; part < 8; ++part) {
            INFO(name << ", " << part << " eighths");
            test::writeMesh(sphere, dir / name, part % 2 == 0);
            const auto size = std::filesystem::file_size(dir / name);
            std::filesystem::resize_file(dir / name, size * std::uintmax_t(part) / 8);
            const std::string ending = std::filesystem::path(name).extension().string();
            if (ending == ".obj" || ending == ".off" || (ending == ".stl" && part % 2 == 0)) {
                try {
                    readMesh(dir / name);
                } catch (const Error& e) {
                    CHECK(e.kind() == Kind::BadInput);
                }
            } else {
                expectError(Kind::BadInput, {name}, [&] { readMesh(dir / name); });
            }
        }
    std::cerr.rdbuf(before);
    std::cout.rdbuf(beforeOut);
    CHECK(printed.str().empty());
}

TEST_CASE("a byte order mark before text is skipped", "[mesh]") {
    const TempDir dir;
    const std::string mark = "\xEF\xBB\xBF";
    const std::string corners = "0 0 0\n1 0 0\n0 1 0\n0 0 1\n";
    const std::string ply =
        "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty "
        "float z\nelement face 4\nproperty list uchar int vertex_indices\nend_header\n" +
        corners + "3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n";
    std::string stl = "solid a\n";
    for (const char* facet : {"vertex 0 0 0\nvertex 0 1 0\nvertex 1 0 0\n",
                              "vertex 0 0 0\nvertex 1 0 0\nvertex 0 0 1\n",
                              "vertex 0 0 0\nvertex 0 0 1\nvertex 0 1 0\n",
                              "vertex 1 0 0\nvertex 0 1 0\nvertex 0 0 1\n"})
        stl += std::string("facet normal 0 0 0\nouter loop\n") + facet + "endloop\nendfacet\n";
    stl += "endsolid a\n";
    for (const auto& [name, text] :
         {std::pair<const char*, std::string>(
              "a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"),
          {"a.off", "OFF\n4 4 0\n" + corners + "3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n"},
          {"a.ply", ply},
          {"a.stl", stl}}) {
        for (const bool marked : {false, true}) {
            INFO(name << marked);
            const TriangleMesh mesh = readMesh(dir.write(name, (marked ? mark : "") + text));
            CHECK(mesh.points.size() == 4);
            CHECK(volume(mesh) == Approx(1.0 / 6));
        }
    }
    // Without the first vertex the face would name others.
    const TriangleMesh square =
        readMesh(dir.write("b.obj", mark + "v 9 0 0\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 2 3 4\n"));
    REQUIRE(square.source);
    CHECK(square.source->vertices.size() == 4);
}

TEST_CASE("STL in every form that other programs write", "[mesh]") {
    const TempDir dir;
    const auto facet = [](const char* normal, const char* corners) {
        return std::string("facet normal ") + normal + "\n outer loop\n" + corners +
               " endloop\nendfacet\n";
    };
    const std::string body =
        facet("0 0 -1", "vertex 0 0 0\nvertex 0 1 0\nvertex 1 0 0\n") +
        facet("-nan(ind) -nan(ind) -nan(ind)", "vertex 0 0 0\nvertex 1 0 0\nvertex 0 0 1\n") +
        facet("nan nan 1.#QNAN", "vertex 0 0 0\nvertex 0 0 1\nvertex 0 1 0\n") +
        facet("", "vertex 1 0 0\nvertex 0 1 0\nvertex 0 0 1\n");
    const std::string text = "solid a vertex # 3\n# by hand\n" + body + "endsolid a\n";
    std::string upper = text, oneLine = text, old = text;
    for (char& c : upper) c = char(std::toupper(static_cast<unsigned char>(c)));
    std::replace(oneLine.begin() + 30, oneLine.end(), '\n', ' ');
    std::replace(old.begin(), old.end(), '\n', '\r');
    const TriangleMesh mesh = readMesh(dir.write("a.stl", text));
    test::writeMesh(mesh, dir / "binary.stl");
    std::string binary = fileBytes(dir / "binary.stl");
    binary.replace(0, 10, "solid part");
    const std::size_t cut = body.find("facet normal nan");
    const std::string two =
        "solid\n" + body.substr(0, cut) + "endsolid\nsolid\n" + body.substr(cut) + "endsolid\n";
    for (const auto& [name, bytes] : {std::pair<const char*, std::string>("text.stl", text),
                                      {"upper.STL", upper},
                                      {"line.stl", oneLine},
                                      {"old.stl", old},
                                      {"two.stl", two},
                                      {"solid.stl", binary},
                                      {"more.stl", binary + "trailing bytes of any kind"},
                                      {"text.stl.gz", test::gzipped(text)},
                                      {"binary.stl.gz", test::gzipped(binary)}}) {
        INFO(name);
        const TriangleMesh read = readMesh(dir.write(name, bytes));
        CHECK(read.points == mesh.points);
        CHECK(read.triangles == mesh.triangles);
        CHECK(volume(read) == Approx(1.0 / 6));
        CHECK(!read.source);
    }
    using test::expectError;
    for (const auto& [bytes, says] :
         {std::pair<std::string, const char*>(text.substr(0, text.size() - 12), "endsolid"),
          {"solid a\n" + facet("0 0 1", "vertex 0 0 0\nvertex 1 0 0\n") + "endsolid\n",
           "line 7: a facet has other than three"},
          {"solid a\n" + facet("0 0 1", "vertex 0 0 0\nvertex 1 0\n") + "endsolid\n",
           "line 5: z is missing"},
          {"solid a\nv 0 0 0\nendsolid\n", "line 2: 'v' does not belong"},
          {binary.substr(0, 150), "4 triangles are announced"},
          {std::string("\0\1", 2), "no STL file"},
          {"facet\n", "begins with solid"}})
        expectError(Kind::BadInput, {"bad.stl", says},
                    [&, &bytes = bytes] { readMesh(dir.write("bad.stl", bytes)); });
}

TEST_CASE("OBJ lines may end in carriage returns", "[mesh]") {
    const TempDir dir;
    for (const char* end : {"\r", "\n", "\r\n"}) {
        std::string text;
        for (const char* line : {"# a\tcomment", "v 0 0 0", "\tv\t1 0 0", "v 0 1 0", "f 1 2 3"})
            text += std::string(line) + end;
        CHECK(readMesh(dir.write("a.obj", text)).triangles.size() == 1);
        test::expectError(Kind::BadInput, {"a.obj, line 6"},
                          [&] { readMesh(dir.write("a.obj", text + "f 1 2 x" + end)); });
    }
}

TEST_CASE("OBJ files that count vertices from 0 are refused as such", "[mesh]") {
    const TempDir dir;
    for (const char* face : {"f 0 1 2", "f 1 2 0/1/1", "f 0//1 1//1 2//1"}) {
        const std::string file =
            dir.write("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n" + std::string(face) + "\n");
        test::expectError(Kind::BadInput,
                          {"a.obj, line 4", "vertex 0", "count vertices from 1 on", "add 1"},
                          [&] { readMesh(file); });
    }
}

TEST_CASE("vertices and faces in memory are a mesh as those of a file", "[mesh]") {
    PolygonMesh cube;
    for (int k = 0; k < 8; ++k)
        cube.vertices.push_back({double(k & 1), double(k >> 1 & 1), double(k >> 2 & 1)});
    for (const auto& face : std::vector<std::vector<std::uint32_t>>{
             {0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}})
        cube.addFace(face);
    const TriangleMesh mesh = meshOf(cube, "cube");
    CHECK(mesh.triangles.size() == 12);
    CHECK(volume(mesh) == Approx(1));
    REQUIRE(mesh.source);
    CHECK(mesh.source->vertices.size() == 8);
    test::expectError(Kind::BadInput, {"no faces"}, [&] {
        meshOf({cube.vertices, {}, {}}, "cube");
    });
    cube.corners.back() = 8;
    test::expectError(Kind::BadInput, {"'cube'", "names vertex 8 of 8"},
                      [&] { meshOf(cube, "cube"); });
}

}  // namespace
}  // namespace igeo
