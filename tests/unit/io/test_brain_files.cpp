// Surfaces and values per vertex of brains: GIFTI, FreeSurfer, mz3, and plain tables.
#include <igeo/base/detail/deflate.h>
#include <igeo/io/annotation_file.h>
#include <igeo/io/detail/base64.h>
#include <igeo/io/detail/gifti_reader.h>
#include <igeo/io/mesh_file.h>
#include <igeo/io/point_cloud_file.h>
#include <igeo/io/point_list.h>
#include <igeo/io/vertex_data_file.h>
#include <support/binary.h>
#include <support/catch.h>
#include <support/expect_error.h>
#include <support/temp_dir.h>

#include <cmath>
#include <fstream>
#include <limits>

namespace igeo {
namespace {

using Kind = Error::Kind;
using test::bytesOf;
using test::expectError;
using test::TempDir;

/// A tetrahedron with corners that single precision holds exactly.
const std::vector<double> kPoints{0, 0, 0, 1.5, 0, 0, 0, 2.25, 0, 0, 0, -3.125};
const std::vector<double> kFaces{0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3};

template <typename T>
std::vector<T> as(const std::vector<double>& values) {
    return {values.begin(), values.end()};
}

struct Encoding {
    std::string name = "ASCII";
    bool bigEndian = false, columns = false, isDouble = false;
};

std::vector<double> byColumns(const std::vector<double>& rows) {
    std::vector<double> out;
    for (std::size_t c = 0; c < 3; ++c)
        for (std::size_t k = c; k < rows.size(); k += 3) out.push_back(rows[k]);
    return out;
}

std::string dataArray(const std::string& intent, const std::string& type, const std::string& dims,
                      const Encoding& e, const std::string& data) {
    return "<DataArray Intent=\"" + intent + "\" DataType='" + type + "' ArrayIndexingOrder=\"" +
           (e.columns ? "Column" : "Row") + "MajorOrder\" " + dims + " Encoding=\"" + e.name +
           "\" Endian=\"" + (e.bigEndian ? "Big" : "Little") +
           "Endian\" ExternalFileName=\"\" ExternalFileOffset=\"\">\n"
           "<MetaData><MD><Name><![CDATA[a < b]]></Name></MD></MetaData>\n"
           "<CoordinateSystemTransformMatrix><MatrixData>2 0 0 5 0 2 0 5 0 0 2 5 0 0 0 1"
           "</MatrixData></CoordinateSystemTransformMatrix>\n<Data>" +
           data + "</Data></DataArray>\n";
}

template <typename T>
std::string encoded(const std::vector<double>& values, const Encoding& e) {
    if (e.name == "ASCII") {
        std::string text;
        for (const double v : values) text += std::to_string(v) + "\n ";
        return text;
    }
    const std::string bytes = bytesOf(as<T>(values), e.bigEndian);
    return base64(e.name == "GZipBase64Binary" ? deflated(bytes) : bytes);
}

std::string gifti(const std::string& arrays) {
    return "<?xml version=\"1.0\"?>\n<!DOCTYPE GIFTI SYSTEM \"gifti.dtd\">\n"
           "<!-- <GIFTI> --><GIFTI Version=\"1.0\" NumberOfDataArrays=\"2\">\n" +
           arrays + "</GIFTI>\n";
}

std::string giftiSurface(const Encoding& e) {
    const auto arranged = [&](const std::vector<double>& rows) {
        return e.columns ? byColumns(rows) : rows;
    };
    const std::string dims = "Dimensionality=\"2\" Dim0=\"4\" Dim1=\"3\"";
    return gifti(dataArray("NIFTI_INTENT_POINTSET",
                           e.isDouble ? "NIFTI_TYPE_FLOAT64" : "NIFTI_TYPE_FLOAT32", dims, e,
                           e.isDouble ? encoded<double>(arranged(kPoints), e)
                                      : encoded<float>(arranged(kPoints), e)) +
                 dataArray("NIFTI_INTENT_TRIANGLE", "NIFTI_TYPE_INT32", dims, e,
                           encoded<std::int32_t>(arranged(kFaces), e)));
}

void checkTetrahedron(const TriangleMesh& mesh) {
    REQUIRE(mesh.source);
    REQUIRE(mesh.source->vertices.size() == 4);
    REQUIRE(mesh.source->faces() == 4);
    for (std::size_t v = 0; v < 4; ++v)
        CHECK(mesh.source->vertices[v] ==
              Vec3d{kPoints[3 * v], kPoints[3 * v + 1], kPoints[3 * v + 2]});
    for (std::size_t k = 0; k < 12; ++k) CHECK(mesh.source->corners[k] == kFaces[k]);
    CHECK(meshTopology(mesh).closed());
}

TEST_CASE("GIFTI in every encoding, byte order and order of dimensions", "[brain]") {
    const TempDir dir;
    for (const char* name : {"ASCII", "Base64Binary", "GZipBase64Binary"})
        for (const bool big : {false, true})
            for (const bool columns : {false, true})
                for (const bool isDouble : {false, true}) {
                    INFO(name << " " << big << columns << isDouble);
                    const Encoding e{name, big, columns, isDouble};
                    // A name in capitals, and no transform is applied.
                    checkTetrahedron(readMesh(dir.write("a.surf.GII", giftiSurface(e))));
                }
}

TEST_CASE("GIFTI that is damaged or no surface is refused", "[brain]") {
    const TempDir dir;
    const auto refused = [&](const std::string& bytes, const std::vector<std::string>& says) {
        const std::string file = dir.write("a.gii", bytes);
        expectError(Kind::BadInput, says, [&] { readMesh(file); });
    };
    const std::string good = giftiSurface({"GZipBase64Binary"});
    refused("<html></html>", {"a.gii", "no GIFTI file"});
    for (std::size_t cut = 40; cut < good.size() - 10; cut += 97)
        refused(good.substr(0, cut), {"a.gii"});
    std::string damaged = good;
    damaged[good.find("<Data>") + 30] ^= 1;
    refused(damaged, {"a.gii", "compressed data"});
    const std::string values = dataArray("NIFTI_INTENT_SHAPE", "NIFTI_TYPE_FLOAT32",
                                         "Dimensionality='1' Dim0='4'", {}, "1 2 3 4");
    refused(gifti(values), {"no surface", "POINTSET", ".surf.gii"});
    std::string outside = giftiSurface({});
    outside.replace(outside.find("3.000000"), 8, "4.000000");
    refused(outside, {"vertex 4 of 4"});
    std::string external = good;
    external.replace(external.find("GZipBase64Binary"), 16, "ExternalFileBinary");
    external.replace(external.find("ExternalFileName=\"\""), 19, "ExternalFileName=\"b.bin\"");
    refused(external, {"another file", "b.bin", "GZipBase64Binary"});
    std::string huge = good;
    huge.replace(huge.find("Dim0=\"4\""), 8, "Dim0=\"4000000000\"");
    refused(huge, {"a.gii"});
}

std::string freeSurfer() {
    return "\xff\xff\xfe"
           "created by hand on a day\n\n" +
           bytesOf(std::vector<std::int32_t>{4, 4}, true) + bytesOf(as<float>(kPoints), true) +
           bytesOf(as<std::int32_t>(kFaces), true) + "footer: valid = 1  # volume info valid\n";
}

TEST_CASE("FreeSurfer's triangle files are known by their first bytes", "[brain]") {
    const TempDir dir;
    const std::string file = dir.write("lh.pial", freeSurfer());
    CHECK(isMeshFile(file));
    checkTetrahedron(readMesh(file));
    CHECK_FALSE(isMeshFile(dir.write("lh.text", "some text")));
    for (std::size_t size = 3; size < 3 + 26 + 8 + 48 + 48; size += 5) {
        const std::string cut = dir.write("lh.cut", freeSurfer().substr(0, size));
        expectError(Kind::BadInput, {"lh.cut", "byte"}, [&] { readMesh(cut); });
    }
    std::string outside = freeSurfer();
    outside[3 + 26 + 8 + 48 + 3] = 9;
    const std::string bad = dir.write("lh.bad", outside);
    expectError(Kind::BadInput, {"lh.bad", "vertex 9 of 4"}, [&] { readMesh(bad); });
}

TEST_CASE("FreeSurfer's quadrangle files of both kinds", "[brain]") {
    const TempDir dir;
    const auto int24 = [](const std::vector<std::uint32_t>& values) {
        std::string bytes;
        for (const std::uint32_t v : values)
            for (const unsigned shift : {16u, 8u, 0u}) bytes += char(v >> shift & 0xff);
        return bytes;
    };
    // A cube of 1.5, -2.25 is the other corner.
    std::vector<float> points;
    std::vector<std::uint16_t> hundredths;
    for (const int k : {0, 1, 2, 3, 4, 5, 6, 7})
        for (const int a : {0, 1, 2}) {
            const float x = k >> a & 1 ? 1.5f : -2.25f;
            points.push_back(x), hundredths.push_back(std::uint16_t(std::int16_t(100 * x)));
        }
    const std::vector<std::uint32_t> quads{0, 2, 3, 1, 4, 5, 7, 6, 0, 1, 5, 4,
                                           2, 6, 7, 3, 0, 4, 6, 2, 1, 3, 7, 5};
    const std::string head = int24({8, 6}), faces = int24(quads);
    const std::string old = "\xff\xff\xff" + head + bytesOf(hundredths, true) + faces,
                      with = "\xff\xff\xfd" + head + bytesOf(points, true) + faces;
    for (const std::string& bytes : {old, with}) {
        const std::string file = dir.write("lh.orig", bytes);
        CHECK(isMeshFile(file));
        const TriangleMesh mesh = readMesh(file);
        REQUIRE(mesh.source);
        CHECK(mesh.source->faces() == 6);
        CHECK(mesh.source->corners == quads);
        CHECK(mesh.source->vertices.front() == Vec3d{-2.25, -2.25, -2.25});
        CHECK(mesh.source->vertices[6] == Vec3d{-2.25, 1.5, 1.5});
        CHECK(mesh.triangles.size() == 12);
        for (std::size_t size = 3; size < bytes.size(); size += 7) {
            const std::string cut = dir.write("lh.cut", bytes.substr(0, size));
            expectError(Kind::BadInput, {"lh.cut", "byte"}, [&] { readMesh(cut); });
        }
        std::string outside = bytes;
        outside[bytes.size() - 1] = 9;
        const std::string bad = dir.write("lh.bad", outside);
        expectError(Kind::BadInput, {"lh.bad", "vertex 9 of 8"}, [&] { readMesh(bad); });
    }
    // Morphometry begins alike.
    const std::string curv = dir.write(
        "lh.curv", "\xff\xff\xff" + bytesOf(std::vector<std::int32_t>{163842, 327680, 1}, true) +
                       std::string(4 * 163842, '\0'));
    expectError(Kind::BadInput, {"lh.curv", "no surface", "values per vertex"},
                [&] { readMesh(curv); });
}

namespace {

std::string be(const std::vector<std::int32_t>& values) { return bytesOf(values, true); }

std::string named(const std::string& name) { return be({int(name.size()) + 1}) + name + '\0'; }

/// Six vertices: two in V1, three in A1, one in none; a region without vertices.
std::string annotation(bool older = false) {
    const std::int32_t v1 = 10 + (20 << 8) + (30 << 16), a1 = 200 + (1 << 8);
    const auto entry = [&](int number, const std::string& name, std::vector<std::int32_t> rgbt) {
        return (older ? "" : be({number})) + named(name) + be(rgbt);
    };
    std::string bytes = be({6, 0, v1, 1, a1, 2, 0, 3, v1, 4, a1, 5, a1, 1});
    bytes += older ? be({3}) : be({-2, 3});
    bytes += named("table.ctab") + (older ? "" : be({3}));
    return bytes + entry(0, "nowhere", {9, 9, 9, 0}) + entry(1, "A1", {200, 1, 0, 0}) +
           entry(2, "V1", {10, 20, 30, 0});
}

}  // namespace

TEST_CASE("regions of FreeSurfer's annotations are groups of seeds", "[brain]") {
    const TempDir dir;
    for (const bool older : {false, true}) {
        const std::string file = dir.write("lh.annot", annotation(older));
        CHECK(isAnnotationFile(file));
        const Annotation all = readAnnotation(file);
        CHECK(all.vertices == 6);
        REQUIRE(all.regions.size() == 2);
        CHECK(all.regions[0].name == "A1");
        CHECK(all.regions[0].vertices == std::vector<std::size_t>{1, 4, 5});
        CHECK(all.regions[1].name == "V1");
        CHECK(all.regions[1].vertices == std::vector<std::size_t>{0, 3});
        const AskedSeeds seeds = readSeeds(file);
        CHECK(seeds.points.empty());
        CHECK(seeds.vertices == 6);
        REQUIRE(seeds.groups.size() == 2);
        CHECK(seeds.groups[1].name == "V1");
        REQUIRE(seeds.groups[1].points.size() == 2);
        CHECK(seeds.groups[1].points[1].vertex == "3");
        expectError(Kind::BadInput, {"lh.annot", "groups"}, [&] { readPoints(file); });
        expectError(Kind::BadInput, {"lh.annot", "regions and no values"},
                    [&] { readVertexData(file, 6); });
    }
}

TEST_CASE("annotations that are damaged are refused", "[brain]") {
    const TempDir dir;
    const std::string good = annotation();
    const auto refused = [&](const std::string& bytes, const std::vector<std::string>& says) {
        const std::string file = dir.write("lh.bad.annot", bytes);
        expectError(Kind::BadInput, says, [&] { readAnnotation(file); });
    };
    for (std::size_t size = 0; size < good.size(); size += 3)
        refused(good.substr(0, size), {"lh.bad.annot", "byte"});
    const auto with = [&](std::size_t at, const std::string& bytes) {
        std::string changed = good;
        return changed.replace(at, bytes.size(), bytes);
    };
    refused(with(0, be({-1})), {"-1 vertices"});
    refused(with(0, be({1 << 30})), {"vertices are announced"});
    refused(with(4, be({6})), {"vertex 6 of 6"});
    const std::size_t table = 4 + 6 * 8;
    refused(with(table, be({0})), {"no table"});
    refused(with(table + 4, be({-3})), {"version 3"});
    refused(with(table + 4, be({std::numeric_limits<std::int32_t>::min()})),
            {"version 2147483648"});
    refused(with(table + 8, be({1 << 30})), {"table of 1073741824"});
    const std::size_t entries = table + 12 + 4 + 11;
    refused(with(entries, be({1 << 28})), {"regions are announced"});
    refused(with(entries + 4, be({3})), {"region 3 in a table of 3"});
    refused(with(entries + 12, "no\n"), {"control character"});
    refused(be({2, 0, 0, 1, 0, 1, -2, 1}) + named("") + be({0}), {"no vertex is in a region"});
}

TEST_CASE("mz3 files, raw and compressed", "[brain]") {
    const TempDir dir;
    const auto mz3 = [&](std::uint16_t holds) {
        return "MZ" + bytesOf(std::vector<std::uint16_t>{holds}) +
               bytesOf(std::vector<std::uint32_t>{4, 4, 3}) + "abc" +
               bytesOf(as<std::int32_t>(kFaces)) + bytesOf(as<float>(kPoints));
    };
    checkTetrahedron(readMesh(dir.write("a.mz3", mz3(3))));
    checkTetrahedron(readMesh(dir.write("b.mz3", test::gzipped(mz3(3)))));
    const std::string onlyVertices = dir.write("c.mz3", mz3(2)),
                      cut = dir.write("d.mz3", test::gzipped(mz3(3).substr(0, 60))),
                      damaged = dir.write("e.mz3", test::gzipped(mz3(3)).substr(0, 40));
    expectError(Kind::BadInput, {"c.mz3", "no faces"}, [&] { readMesh(onlyVertices); });
    expectError(Kind::BadInput, {"d.mz3", "bytes are left"}, [&] { readMesh(cut); });
    expectError(Kind::BadInput, {"e.mz3", "cut off"}, [&] { readMesh(damaged); });
}

TEST_CASE("values per vertex from every kind of file", "[brain]") {
    const TempDir dir;
    const std::vector<double> values{0, 1.5, -2, 7};
    const auto check = [&](const std::string& name, const std::string& bytes) {
        INFO(name);
        const std::string file = dir.write(name, bytes);
        CHECK(isVertexDataFile(file));
        CHECK(readVertexData(file, 4) == values);
    };
    const auto npy = [](const std::string& type, const std::string& shape,
                        const std::string& data) {
        const std::string header =
            "{'descr': '" + type + "', 'fortran_order': False, 'shape': " + shape + ", }\n";
        return "\x93NUMPY" + std::string("\1\0", 2) +
               bytesOf(std::vector<std::uint16_t>{std::uint16_t(header.size())}) + header + data;
    };
    for (const bool big : {false, true})
        check("a.func.gii",
              gifti(dataArray("NIFTI_INTENT_NONE", "NIFTI_TYPE_FLOAT32",
                              "Dimensionality='1' Dim0='4'", {"GZipBase64Binary", big},
                              encoded<float>(values, {"GZipBase64Binary", big}))));
    check("a.txt", "0\n1.5\n-2\n7\n");
    check("a.csv", "vertex,distance,label\n3,7,0\n1,1.5,0\n2,-2,-1\n");
    check("a.npy", npy("<f8", "(4,)", bytesOf(values)));
    check("a.npy", npy(">f4", "(4, 1)", bytesOf(as<float>(values), true)));
    check("lh.curv", "\xff\xff\xff" + bytesOf(std::vector<std::int32_t>{4, 9, 1}, true) +
                         bytesOf(as<float>(values), true));
    const std::string label = dir.write("a.label",
                                        "#!ascii label  , from subject\n2\n"
                                        "3  0.0 0 0 0.0\n1 1 2 3 0.5\n");
    CHECK(readVertexData(label, 4) == std::vector<double>{0, 1, 0, 1});
    const std::vector<AskedPoint> seeds = readPoints(label);
    REQUIRE(seeds.size() == 2);
    CHECK(seeds[0].vertex == "3");
    CHECK(seeds[1].vertex == "1");
}

TEST_CASE("values that do not fit the mesh are refused", "[brain]") {
    const TempDir dir;
    const auto refused = [&](const std::string& name, const std::string& bytes,
                             const std::vector<std::string>& says) {
        INFO(name);
        const std::string file = dir.write(name, bytes);
        expectError(Kind::BadInput, says, [&] { readVertexData(file, 4); });
    };
    refused("a.txt", "0\n1\n2\n", {"a.txt", "3 values", "4 vertices"});
    refused("a.txt", "0\n1\n2 2\n", {"a.txt, line 3", "'2 2'"});
    refused("a.csv", "0,0,1\n1,0,1\n", {"a.csv, line 1", "'0,0,1'"});
    refused("a.csv", "vertex,value\n4,1\n", {"a.csv, line 2", "4 is no vertex", "0 to 3"});
    refused("a.npy", "no numpy", {"a.npy", "no .npy file"});
    refused("a.label", "#!ascii label\n3\n1 0 0 0 0\n", {"a.label", "announces 3", "lists 1"});
    refused("a.label", "#!ascii label\n1\n7 0 0 0 0\n", {"a.label", "7 is no vertex", "0 to 3"});
    refused("lh.thickness", "\xff\xff\xff" + bytesOf(std::vector<std::int32_t>{4, 9, 2}, true),
            {"lh.thickness", "2 values per vertex"});
    refused("lh.thickness", "\xff\xff\xff" + bytesOf(std::vector<std::int32_t>{4, 9, 1}, true),
            {"lh.thickness", "bytes are left"});
    refused("a.gii", giftiSurface({}), {"a.gii", "0 arrays of values"});
    // Decimal commas: 1,75 is no value of vertex 1.
    refused("a.txt", "1,25\n0,5\n1,75\n2,5\n",
            {"a.txt, line 3", "'1,75' gives vertex 1", "line 1 does", "decimal comma", "1.5"});
    refused("a.csv", "vertex, value\n2, 5\n3, 1\n2, 6\n",
            {"a.csv, line 4", "'2, 6' gives vertex 2", "line 2 does", "each vertex once"});
    refused("a.csv", "vertex;value\n0;1\n2;1,75\n", {"a.csv, line 3", "decimal commas"});
    refused("a.txt", "2 1,75\n", {"a.txt, line 1", "'2 1,75'", "decimal commas"});
}

TEST_CASE("a byte order mark before values and surfaces is skipped", "[brain]") {
    const TempDir dir;
    const std::string mark = "\xEF\xBB\xBF";
    CHECK(readVertexData(dir.write("a.txt", mark + "5\n6\n"), 2) == std::vector<double>{5, 6});
    CHECK(readVertexData(dir.write("a.csv", mark + "vertex,a,b\n1,6,0\n"), 2) ==
          std::vector<double>{0, 6});
    CHECK(readVertexData(dir.write("a.label", mark + "#!ascii label\n1\n1 0 0 0 0\n"), 2) ==
          std::vector<double>{0, 1});
    CHECK(readMesh(dir.write("a.surf.gii", mark + giftiSurface({}))).triangles.size() == 4);
}

TEST_CASE("pwn clouds in both forms", "[brain]") {
    const TempDir dir;
    for (const char* text : {"2\n0 0 1\n1 0 0\n0 0 1\n1 0 0\n", "0 0 1 0 0 1\n1 0 0 1 0 0\n"}) {
        const PointCloud cloud = readPointCloud(dir.write("a.pwn", text));
        CHECK(cloud.points == std::vector<Vec3d>{{0, 0, 1}, {1, 0, 0}});
        CHECK(cloud.normals == std::vector<Vec3f>{{0, 0, 1}, {1, 0, 0}});
    }
    const std::string cut = dir.write("a.pwn", "2\n0 0 1\n1 0 0\n0 0 1\n");
    expectError(Kind::BadInput, {"a.pwn", "announces 2", "holds 3"}, [&] { readPointCloud(cut); });
}

}  // namespace
}  // namespace igeo
