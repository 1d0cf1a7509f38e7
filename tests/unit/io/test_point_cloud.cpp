// Files of points: what is read, and what is refused with words that help.
#include <igeo/io/point_cloud_file.h>
#include <igeo/io/point_list.h>
#include <support/clouds.h>
#include <support/expect_error.h>
#include <support/openvdb.h>
#include <support/point_grid.h>
#include <support/temp_dir.h>

#include <algorithm>
#include <cstring>
#include <fstream>
#include <limits>

namespace igeo::test {
namespace {

using Kind = Error::Kind;

void write(const std::string& file, const std::string& bytes) {
    std::ofstream(file, std::ios::binary) << bytes;
}

template <typename T>
std::string bytesOf(T value, bool bigEndian) {
    std::string bytes(sizeof value, '\0');
    std::memcpy(bytes.data(), &value, sizeof value);
    const std::uint16_t one = 1;
    if ((*reinterpret_cast<const char*>(&one) == 0) != bigEndian)
        std::reverse(bytes.begin(), bytes.end());
    return bytes;
}

/// Coordinates of a survey: a float would round them to 0.03.
PointCloud surveyed() {
    CloudOptions options;
    options.normals = true;
    return sphereCloud(40, 1.7, {431234.567891, 5412345.678, 312.25}, options);
}

std::string text(double value) {
    char buffer[32];
    std::snprintf(buffer, sizeof buffer, "%.17g", value);
    return buffer;
}

std::string row(const PointCloud& cloud, std::size_t i, const std::string& between) {
    const Vec3d p = cloud.points[i], n(cloud.normals[i]);
    return text(p.x) + between + text(p.y) + between + text(p.z) + between + text(n.x) + between +
           text(n.y) + between + text(n.z);
}

void checkSame(const PointCloud& read, const PointCloud& cloud) {
    REQUIRE(read.points.size() == cloud.points.size());
    REQUIRE(read.normals.size() == cloud.normals.size());
    CHECK(read.points == cloud.points);
    CHECK(read.normals == cloud.normals);
}

/// A PLY with an element before the vertices, lists, other properties and faces after.
std::string ply(const PointCloud& cloud, const std::string& format) {
    const bool big = format == "binary_big_endian", ascii = format == "ascii";
    std::string bytes = "ply\r\nformat " + format +
                        " 1.0\ncomment made by a test\nelement camera 1\nproperty list uchar int "
                        "ids\nproperty float64 zoom\nelement vertex " +
                        std::to_string(cloud.points.size()) +
                        "\nproperty double x\nproperty uchar red\nproperty float64 y\nproperty "
                        "double z\nproperty list uint8 int16 tags\nproperty float nx\nproperty "
                        "float ny\nproperty float32 nz\nelement face 1\nproperty list uchar int "
                        "vertex_indices\nend_header\n";
    auto put = [&](auto value) {
        if (ascii)
            bytes += text(double(value)) + (value > 100 ? "\n" : " ");
        else
            bytes += bytesOf(value, big);
    };
    put(std::uint8_t(2)), put(std::int32_t(-7)), put(std::int32_t(8)), put(1.5);
    for (std::size_t i = 0; i < cloud.points.size(); ++i) {
        put(cloud.points[i].x), put(std::uint8_t(200)), put(cloud.points[i].y);
        put(cloud.points[i].z), put(std::uint8_t(1)), put(std::int16_t(-3));
        for (int a = 0; a < 3; ++a) put(cloud.normals[i][a]);
    }
    put(std::uint8_t(3)), put(std::int32_t(0)), put(std::int32_t(1)), put(std::int32_t(2));
    return bytes;
}

}  // namespace

TEST_CASE("Clouds come back from every kind of file to the last bit") {
    const TempDir dir;
    const PointCloud cloud = surveyed();
    for (const char* format : {"ascii", "binary_little_endian", "binary_big_endian"}) {
        INFO(format);
        write(dir / "a.PLY", ply(cloud, format));
        checkSame(readPointCloud(dir / "a.PLY"), cloud);
    }
    for (const std::string& between : std::vector<std::string>{" ", ",", " ,\t", ";"}) {
        std::string lines = "\xEF\xBB\xBF# a comment\nx" + between + "y" + between + "z\r\n\n";
        for (std::size_t i = 0; i < cloud.points.size(); ++i)
            lines += row(cloud, i, between) + (i % 2 ? " # and more\n" : "\r\n");
        for (const char* name : {"a.xyz", "a.csv", "a.txt"}) {
            write(dir / name, lines);
            checkSame(readPointCloud(dir / name), cloud);
        }
    }
    std::string obj = "o cloud\n";
    for (std::size_t i = 0; i < cloud.points.size(); ++i) obj += "v " + row(cloud, i, " ") + "\n";
    write(dir / "a.obj", obj);
    PointCloud bare = cloud;
    bare.normals.clear();  // six numbers after `v` are a position and a color
    checkSame(readPointCloud(dir / "a.obj"), bare);
}

TEST_CASE("Clouds are read from VDB grids of points") {
    const TempDir dir;
    const PointCloud cloud = sphereCloud(500, 2, {1, 2, 3});
    openvdb::io::File file(dir / "a.vdb");
    file.write({pointGrid(cloud, "points"), openvdb::FloatGrid::create()});
    file.close();

    for (const std::string& name : {dir / "a.vdb", dir / "a.vdb:points"}) {
        const PointCloud read = readPointCloud(name);
        REQUIRE(read.points.size() == 500);
        // Positions are floats within a voxel of 0.1: off by 2^-25 of it, and rounding at 5.
        for (const Vec3d& p : read.points) {
            double nearest = kInfinity;
            for (const Vec3d& q : cloud.points) nearest = std::min(nearest, length(p - q));
            CHECK(nearest < 3.5e-9);  // measured 2.3e-9
        }
    }
    expectError(Kind::BadInput, {"a.vdb' has no grid 'other'", "'points'"},
                [&] { readPointCloud(dir / "a.vdb:other"); });
    openvdb::io::File(dir / "b.vdb").write({openvdb::FloatGrid::create()});
    expectError(Kind::BadInput, {"b.vdb' holds no point grid", "float"},
                [&] { readPointCloud(dir / "b.vdb"); });
    write(dir / "c.vdb", "no grid");
    expectError(Kind::BadInput, {"c.vdb"}, [&] { readPointCloud(dir / "c.vdb"); });
}

TEST_CASE("Broken files of points are refused with the place") {
    const TempDir dir;
    auto refused = [&](const std::string& name, const std::string& bytes,
                       const std::vector<std::string>& phrases) {
        INFO(name << ": " << bytes.substr(0, 200));
        write(dir / name, bytes);
        expectError(Kind::BadInput, phrases, [&] { readPointCloud(dir / name); });
    };
    refused("a.xyz", "1 2 3\n4 5\n", {"a.xyz, line 2", "'4 5'", "x y z"});
    refused("a.xyz", "1 2 3\n4 5 6 0 0 1\n", {"line 2", "has 6 numbers", "have 3"});
    refused("a.xyz", "1 2 3\n4 5 six\n", {"line 2", "'4 5 six'"});
    refused("a.xyz", "1 2 3 4\n", {"line 1", "neither"});
    refused("a.xyz", "1 2 3\n4,5,\n", {"line 2"});
    refused("a.xyz", "x y z\nx y z\n", {"line 2"});
    refused("a.xyz", "# nothing\n", {"holds no points"});
    refused("a.xyz", "1 2 3\n4 nan 6\n", {"point 2 of 2", "not finite"});
    refused("a.csv", "1,2,3\n4,5,1e999\n", {"line 2"});
    refused("a.csv", "1,2,3,0,0,0\n", {"point 1 of 1", "zero"});
    refused("a.obj", "v 1 2\n", {"line 1", "three numbers"});
    refused("a.obj", "f 1 2 3\n", {"holds no points"});
    refused("a.stl", "solid\n", {"'.stl' is no ending", ".ply"});
    refused("noending", "1 2 3\n", {"is no ending"});

    const std::string good = ply(surveyed(), "binary_little_endian");
    refused("a.ply", good.substr(0, good.size() - 200), {"a.ply, byte", "ends before"});
    refused("a.ply", good.substr(0, 100), {"header does not end"});
    refused("a.ply", "plx\n", {"begins with 'ply'"});
    refused("a.ply", "ply\nformat binary 1.0\n", {"format 'binary' is unknown"});
    const std::string head = "ply\nformat ascii 1.0\n",
                      xyz = "property float x\nproperty float y\n";
    refused("a.ply", head + "element vertex 1\n" + xyz + "end_header\n1 2\n", {"lack x, y or z"});
    refused("a.ply", head + "element vertex many\n", {"has no count"});
    refused("a.ply", head + "element face 0\nend_header\n", {"no element 'vertex'"});
    refused("a.ply", head + "element vertex 1\nproperty half x\n",
            {"'half' is no type", "uchar", "double"});
    refused("a.ply", head + "element vertex 1\nproperty int64 x\n", {"'int64' is no type", "int"});
    refused("a.ply",
            head + "element vertex 99999999999\n" + xyz + "property float z\nend_header\n1 2 3\n",
            {"99999999999 of 'vertex' are announced"});
    refused("a.ply", head + "element vertex 1\n" + xyz + "property float z\nend_header\n1 two 3\n",
            {"'two' is no number"});
    refused("a.ply", good.substr(0, good.size() - 1), {"ends before"});  // within the face
    refused("a.ply", head + "element vertex 1\nelement vertex 1\n", {"'vertex' is there twice"});
    for (const char* count : {"-1", "1.5", "nan", "1e300"})
        refused("a.ply",
                head + "element vertex 1\n" + xyz +
                    "property float z\nproperty list double int tags\nend_header\n1 2 3 " + count +
                    " 4\n",
                {"a list", " entries"});
    expectError(Kind::Io, {"none.ply", "No such file"}, [&] { readPointCloud(dir / "none.ply"); });
    expectError(Kind::Io, {"none.csv:1", "No such file"},
                [&] { readPointCloud(dir / "none.csv:1"); });
    expectError(Kind::Io, {"none.vdb"}, [&] { readPointCloud(dir / "none.vdb"); });
    std::filesystem::create_directory(dir / "folder.xyz");
    expectError(Kind::Io, {"folder"}, [&] { readPointCloud(dir / "folder.xyz"); });
}

TEST_CASE("decimal commas in files of points are refused") {
    const TempDir dir;
    for (const char* line : {"258,2;0,0;9996,7", "1,5 2,5 3,5", "1,5\t2,5\t3,5", "  1,5 2 ",
                             "1;2;3,5", "1,2 3,4", "-1,5; 2; 3", "1e2,5 2"}) {
        INFO(line);
        for (const char* name : {"a.xyz", "a.csv", "a.pwn"}) {
            write(dir / name, std::string("# points\n") + line + "\n");
            expectError(Kind::BadInput,
                        {name + std::string(", line 2: '"), "decimal commas", "decimal points"},
                        [&] { readPointCloud(dir / name); });
        }
        write(dir / "a.obj", "v 0 0 0\nv " + std::string(line) + "\n");
        expectError(Kind::BadInput, {"a.obj, line 2", "decimal commas"},
                    [&] { readPointCloud(dir / "a.obj"); });
    }
    for (const char* line : {"1,2,3", "1, 2, 3", " 1,2, 3 ", "1 ,2\t,3", "1;2;3", "1; 2; 3",
                             "1 2 3", "1.0,2.,3", "1., 2 3"}) {
        INFO(line);
        write(dir / "a.csv", line + std::string("\r\n"));
        CHECK(readPointCloud(dir / "a.csv").points == std::vector<Vec3d>{{1, 2, 3}});
    }
}

TEST_CASE("a header of a file of points that names other columns is refused") {
    const TempDir dir;
    for (const auto& [header, says] : {std::pair("y,x,z", "column 1 'y', which is read as x"),
                                       {"x;z;y", "column 2 'z', which is read as y"},
                                       {"Z Y X", "column 1 'z', which is read as x"},
                                       {"nx,ny,nz,x,y,z", "column 1 'nx', which is read as x"},
                                       {"id,x,y,z,nx,ny", "column 2 'x', which is read as y"},
                                       {"x,y,z,r1,g1,b1", "column 4 'r1', which is read as nx"},
                                       {"x,y,z,u,v,w", "column 4 'u', which is read as nx"},
                                       {"x,y,z,nx,ny,c", "column 6 'c', which is read as nz"},
                                       {"a,b,c,d,e", "names 5 columns"}}) {
        INFO(header);
        write(dir / "a.csv", header + std::string("\n1,2,3,0,0,1\n"));
        expectError(Kind::BadInput, {"a.csv, line 1", header, says, "order x,y,z,nx,ny,nz"},
                    [&] { readPointCloud(dir / "a.csv"); });
    }
    for (const char* header :
         {"x,y,z", "X Y Z NX NY NZ", "east,north,up", "pos x,pos y,pos z", "a,b,c"}) {
        INFO(header);
        write(dir / "a.csv", header + std::string("\n1,2,3,0,0,1\n"));
        CHECK(readPointCloud(dir / "a.csv").points == std::vector<Vec3d>{{1, 2, 3}});
    }
}

TEST_CASE("columns that a header of a file of points names as colors are skipped") {
    const TempDir dir;
    const std::vector<Vec3d> points{{1, 2, 3}, {4, 5, 6}};
    for (const char* text :
         {"x,y,z,r,g,b\n1,2,3,255,0,10\n4,5,6,0,0,0\n", "//X Y Z R G B\n1 2 3 9 9 9\n4 5 6 0 0 0\n",
          "\"X\", \"Y\", \"Z\", \"Red\", \"Green\", \"Blue\"\n1,2,3,1,0,0\n4,5,6,0.5,0,0\n",
          "red,x,y,z\n7,1,2,3\n7,4,5,6\n", "x y z intensity\n1 2 3 0.1\n4 5 6 0.2\n"}) {
        INFO(text);
        write(dir / "a.txt", text);
        const PointCloud cloud = readPointCloud(dir / "a.txt");
        CHECK(cloud.points == points);
        CHECK(cloud.normals.empty());
    }
    // Normals may have any length where they have names.
    for (const char* text :
         {"x y z r g b nx ny nz\n1 2 3 9 8 7 0 0 5\n4 5 6 9 8 7 0 3 0\n",
          "x y z nx ny nz red green blue\n1 2 3 0 0 5 9 8 7\n4 5 6 0 3 0 9 8 7\n",
          "x y z nx ny nz\n1 2 3 0 0 5\n4 5 6 0 3 0\n"}) {
        INFO(text);
        write(dir / "a.txt", text);
        const PointCloud cloud = readPointCloud(dir / "a.txt");
        CHECK(cloud.points == points);
        CHECK(cloud.normals == std::vector<Vec3f>{{0, 0, 5}, {0, 3, 0}});
    }
    write(dir / "a.txt", "x y z r g b\n1 2 3 4 5 6\n1 2 3\n");
    expectError(Kind::BadInput, {"a.txt, line 3", "does not hold 6 numbers"},
                [&] { readPointCloud(dir / "a.txt"); });
    write(dir / "a.txt", "x y z r g b ny nx nz\n1 2 3 4 5 6 7 8 9\n");
    expectError(Kind::BadInput, {"a.txt, line 1", "'ny', which is read as nx"},
                [&] { readPointCloud(dir / "a.txt"); });
}

TEST_CASE("six columns without names hold unit normals") {
    const TempDir dir;
    write(dir / "a.xyz", "1 2 3 0 0 1\n4 5 6 0.7 0.7 0\n");
    CHECK(readPointCloud(dir / "a.xyz").normals.size() == 2);
    write(dir / "a.xyz", "1 2 3 0 0 1\n4 5 6 255 128 0\n");
    expectError(Kind::BadInput,
                {"a.xyz, line 2", "no name for columns 4 to 6", "285.3, not 1", "x y z r g b"},
                [&] { readPointCloud(dir / "a.xyz"); });
}

TEST_CASE("OBJ points with any blanks, and lines that end in carriage returns") {
    const TempDir dir;
    const std::vector<Vec3d> points{{1, 2, 3}, {4, 5, 6}};
    write(dir / "a.obj", "v\t1\t2 3\nvn\t0 0 1\n  v 4 5 6\n\tvn 0 1 0\nvt 1 2 3\nv\n");
    expectError(Kind::BadInput, {"a.obj, line 6", "three numbers"},
                [&] { readPointCloud(dir / "a.obj"); });
    write(dir / "a.obj", "v\t1\t2 3\nvn\t0 0 1\n  v 4 5 6\n\tvn 0 1 0\nvt 1 2 3\n");
    CHECK(readPointCloud(dir / "a.obj").points == points);
    CHECK(readPointCloud(dir / "a.obj").normals == std::vector<Vec3f>{{0, 0, 1}, {0, 1, 0}});
    for (const char* end : {"\r", "\n", "\r\n"}) {
        INFO(end);
        write(dir / "a.obj", std::string("v 1 2 3") + end + "v 4 5 6" + end);
        CHECK(readPointCloud(dir / "a.obj").points == points);
        write(dir / "a.csv", std::string("x,y,z") + end + "1,2,3" + end + "4,5,6");
        CHECK(readPointCloud(dir / "a.csv").points == points);
        CHECK(readPoints(dir / "a.csv").size() == 2);
        write(dir / "b.csv", std::string("1,2,3") + end + "4,5" + end);
        expectError(Kind::BadInput, {"line 2"}, [&] { readPointCloud(dir / "b.csv"); });
        expectError(Kind::BadInput, {"line 2"}, [&] { readPoints(dir / "b.csv"); });
    }
}

TEST_CASE("a byte order mark before points is skipped") {
    const TempDir dir;
    const std::string mark = "\xEF\xBB\xBF";
    for (const auto& [name, text] :
         {std::pair("a.xyz", "1 2 3\n"),
          {"a.csv", "1,2,3\n"},
          {"a.pwn", "1\n1 2 3\n0 0 1\n"},
          {"a.obj", "v 1 2 3\n"},
          {"a.ply",
           "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n"
           "property float z\nend_header\n1 2 3\n"}}) {
        INFO(name);
        write(dir / name, mark + text);
        CHECK(readPointCloud(dir / name).points == std::vector<Vec3d>{{1, 2, 3}});
    }
}

}  // namespace igeo::test
