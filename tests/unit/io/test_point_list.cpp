#include <igeo/io/point_list.h>
#include <support/catch.h>
#include <support/expect_error.h>
#include <support/temp_dir.h>

#include <clocale>
#include <cstdio>
#include <fstream>

namespace igeo::test {
namespace {

/// Reads `content` from a file of this name.
std::vector<AskedPoint> read(const std::string& name, const std::string& content) {
    const TempDir folder;
    return readPoints(folder.write(name, content));
}

void refuse(const std::string& name, const std::string& content,
            const std::vector<std::string>& phrases) {
    INFO(content);
    expectError(Error::Kind::BadInput, phrases, [&] { read(name, content); });
}

}  // namespace

TEST_CASE("parsePoint: three finite numbers") {
    CHECK(parsePoint("1,2,3").position == Vec3d{1, 2, 3});
    CHECK(parsePoint(" -1.5 , 2e-3 ,+.25 ").position == Vec3d{-1.5, 2e-3, 0.25});
    CHECK(parsePoint("0.1,0.2,0.3").start == 0);
    for (const char* bad : {"", "1", "1,2", "1,2,3,4", "1,2,", ",1,2", "1,,2", "1,2,3,", "a,b,c",
                            "1,2,3x", "nan,0,0", "0,inf,0", "1e999,0,0", "1 2 3", "1;2;3"})
        expectError(Error::Kind::InvalidArgument, {"'" + std::string(bad) + "'", "0.1,0.2,0.3"},
                    [&] { parsePoint(bad); });
}

TEST_CASE("points by vertex") {
    CHECK(parsePoint("vertex:12").vertex == "12");
    CHECK(parsePoint("-y").vertex == "-y");
    CHECK(parsePoint("center").vertex == "center");
    CHECK(parsePoint("1,2,3").vertex.empty());
    for (const char* bad : {"vertex:", "vertex:-1", "vertex:1.5", "+w", "middle"})
        expectError(Error::Kind::InvalidArgument, {bad, "vertex:123"}, [&] { parsePoint(bad); });
    const TempDir folder;
    auto write = [&](const std::string& name, const std::string& content) {
        std::ofstream(folder / name) << content;
        return folder / name;
    };
    for (const std::string& file :
         {write("a.csv", "vertex\n12\n0\n"), write("a.json", "[12, {\"vertex\": 0}]")}) {
        const std::vector<AskedPoint> points = readPoints(file);
        REQUIRE(points.size() == 2);
        CHECK(points[0].vertex == "12");
        CHECK(points[1].vertex == "0");
    }
    CHECK(readPoints(write("b.json", R"([{"vertex": 3, "start": 0.5}])"))[0].start == 0.5);
    for (const std::string& file : {write("c.csv", "3,4\n"), write("c.json", "[[3, 4]]")}) {
        const std::vector<AskedPair> pairs = readPairs(file);
        REQUIRE(pairs.size() == 1);
        CHECK(pairs[0].source.vertex == "3");
        CHECK(pairs[0].target.vertex == "4");
    }
    for (const std::string& file :
         {write("d.csv", "1.5\n"), write("e.csv", "-1\n"), write("d.json", "[-1]"),
          write("e.json", "[1.5]"), write("f.json", R"([{"vertex": 1, "position": [0, 0, 0]}])")})
        expectError(Error::Kind::BadInput, {"vertex"}, [&] { readPoints(file); });
    expectError(Error::Kind::BadInput, {"curve"}, [&] { readCurves(folder / "a.csv"); });
}

TEST_CASE("readSeeds: groups in the order of the file, or points") {
    const TempDir folder;
    auto write = [&](const std::string& content) {
        std::ofstream(folder / "g.json") << content;
        return folder / "g.json";
    };
    const AskedSeeds named = readSeeds(
        write(R"({"groups": {"V2": [12, [1, 2, 3]], "A1": [{"vertex": 4, "start": 1}]}})"));
    CHECK(named.points.empty());
    REQUIRE(named.groups.size() == 2);
    CHECK(named.groups[0].name == "V2");
    REQUIRE(named.groups[0].points.size() == 2);
    CHECK(named.groups[0].points[0].vertex == "12");
    CHECK(named.groups[0].points[1].position == Vec3d{1, 2, 3});
    CHECK(named.groups[1].name == "A1");
    CHECK(named.groups[1].points[0].start == 1);
    const AskedSeeds numbered = readSeeds(write(R"({"groups": [[1, 2], [3]]})"));
    REQUIRE(numbered.groups.size() == 2);
    CHECK(numbered.groups[1].name.empty());
    CHECK(readSeeds(write("[1, 2]")).points.size() == 2);

    expectError(Error::Kind::BadInput, {"groups", "points"},
                [&] { readPoints(write(R"({"groups": [[1, 2]]})")); });
    for (const auto& [content, says] :
         {std::pair(R"({"groups": {}})", "groups"),
          {R"({"groups": 5})", "groups"},
          {R"({"groups": {"a": [1], "a": [2]}})", "'a' is twice"},
          {R"({"groups": [[1], 5]})", "group 1"},
          {R"({"groups": {"a": []}})", "group 'a'"},
          {R"({"groups": {"a": [1, "b"]}})", "group 'a', entry 1"},
          {R"({"groups": {"": [1]}})", "name of group 0"},
          {R"({"groups": {"a\u0007": [1]}})", "name of group 0"},
          {R"({"groups": {"a": [{"vertex": 1, "start": -2}]}})", "-2"},
          {R"({"regions": [[1]]})", "list of points"}}) {
        INFO(content);
        const std::string file = write(content);
        expectError(Error::Kind::BadInput, {"g.json", says}, [&] { readSeeds(file); });
    }
}

TEST_CASE("readPoints: text") {
    const auto points = read("p.csv",
                             "x, y, z, start\n"
                             "# a comment\n"
                             "1,2,3\n"
                             "\n"
                             "  -4 , 5e1, .5 , 7.5  # and one behind\r\n"
                             "\t\r\n"
                             "0,0,0");
    REQUIRE(points.size() == 3);
    CHECK(points[0].position == Vec3d{1, 2, 3});
    CHECK(points[0].start == 0);
    CHECK(points[1].position == Vec3d{-4, 50, 0.5});
    CHECK(points[1].start == 7.5);
    CHECK(points[2].position == Vec3d{0, 0, 0});
    // Any ending but .json; a byte order mark as spreadsheets write it; digits in a header.
    CHECK(read("points", "1,2,3\n").size() == 1);
    CHECK(read("p.csv",
               "\xEF\xBB\xBF"
               "1,2,3\n4,5,6\n")
              .size() == 2);
    CHECK(read("p.csv", "x1,y1,z1\n4,5,6\n").size() == 1);
}

TEST_CASE("readPoints: text that is no points") {
    refuse("p.csv", "1,2,3\n4,5\n", {"line 2", "'4,5'", "x,y,z,start"});
    refuse("p.csv", "1,2,3\nx,y,z\n", {"line 2"});
    refuse("p.csv", "# nothing\n\n1,2,3\n1,2,3,4,5\n", {"line 4"});
    refuse("p.csv", "1,2,3\n1,nan,3\n", {"line 2"});
    refuse("p.csv", "1,2,3\n1,2,3,-1\n", {"start value", "negative"});
    refuse("p.csv", "", {"holds no points"});
    refuse("p.csv", "x,y,z\n", {"holds no points"});
    // A mistake in the first line is no header: it would lose a point without a message.
    refuse("p.csv", "1,2\n1,2,3\n", {"line 1"});
    refuse("p.csv", "1,5;2;3\n1,2,3\n", {"line 1"});
    refuse("p.csv", "1,2,oops\n1,2,3\n", {"line 1"});
}

TEST_CASE("readPoints: decimal commas are named as such") {
    for (const char* line : {"258,2;0,0;9996,7", "1,5 2,5 3,5", "1,5\t2\t3", "1,2 3,4"})
        refuse("p.csv", "0 0 0\n" + std::string(line) + "\n",
               {"p.csv, line 2", line[1] == ',' ? "'1," : "'258,2", "decimal commas", "1.5 for"});
    refuse("p.csv", "1,5;2,5;3,5\n", {"line 1", "decimal commas"});
    for (const char* line : {"1,2,3", "1, 2, 3", "1,2, 3", "1;2;3", "1 2 3"})
        CHECK(read("p.csv", line)[0].position == Vec3d{1, 2, 3});
}

TEST_CASE("readPoints: a header that names other columns is refused") {
    for (const char* header : {"y,x,z", "z;y;x", "X Z Y", "nx,ny,nz,x", "x,y,z,Red", "id,x,y,z"})
        refuse("p.csv", header + std::string("\n1,2,3\n"),
               {"p.csv, line 1", header, "which is read as", "order x,y,z,start"});
    for (const char* header : {"x,y,z", "X;Y;Z;Start", "x y z r", "a,b,c", "lon,lat,height"})
        CHECK(read("p.csv", header + std::string("\n1,2,3\n"))[0].position == Vec3d{1, 2, 3});
    // Beside names a fourth number is a start value only under its own.
    for (const char* header : {"x,y,z,id", "X;Y;Z;confidence", "x y z r", "lon,lat,height,time"})
        refuse("p.csv", header + std::string("\n1,2,3\n1,2,3,4\n"),
               {"p.csv, line 1", header, "names column 4 '", "which is read as start",
                "leave out others"});
    refuse("p.csv", "x,y,z\n1,2,3,4\n", {"line 1", "names 3 columns", "hold 4 numbers"});
    CHECK(read("p.csv", "\"x\",\"y\",\"z\",\"Start\"\n1,2,3,4\n")[0].start == 4);
    const TempDir folder;
    const std::string pairs = folder.write("p.csv", "x,y,z,nx,ny,nz\n1,2,3,4,5,6\n");
    expectError(Error::Kind::BadInput, {"column 4 'nx', which is read as x", "x,y,z,x,y,z"},
                [&] { readPairs(pairs); });
    CHECK(readPairs(folder.write("q.csv", "x,y,z,x,y,z\n1,2,3,4,5,6\n")).size() == 1);
}

TEST_CASE("readPoints: numbers have points in every locale") {
    const char* const before = std::setlocale(LC_NUMERIC, nullptr);
    const std::string locale = before ? before : "C";
    const char* const comma = std::setlocale(LC_NUMERIC, "de_DE.UTF-8");
    if (!comma) std::printf("there is no locale de_DE.UTF-8\n");
    const auto points = read("p.csv", "x,y,z\n1.5,-2.25,+3e-1\n");
    const AskedPoint point = parsePoint("1.5,-2.25,.5");
    std::setlocale(LC_NUMERIC, locale.c_str());
    REQUIRE(points.size() == 1);
    CHECK(points[0].position == Vec3d{1.5, -2.25, 0.3});
    CHECK(point.position == Vec3d{1.5, -2.25, 0.5});
}

TEST_CASE("readPoints: a byte order mark is skipped") {
    const std::string mark = "\xEF\xBB\xBF";
    CHECK(read("p.json", mark + "[[1, 2, 3]]")[0].position == Vec3d{1, 2, 3});
    CHECK(read("p.label", mark + "#!ascii label\n1\n5 0 0 0 0\n")[0].vertex == "5");
    CHECK(read("p.csv", mark + "1,2,3\n")[0].position == Vec3d{1, 2, 3});
}

TEST_CASE("readPoints: of a line without end only the beginning is quoted") {
    const TempDir folder;
    std::ofstream(folder / "p.csv") << "1,2,3\n" << std::string(1000000, '9') << "\n";
    try {
        readPoints(folder / "p.csv");
        FAIL("no error");
    } catch (const Error& e) {
        CHECK(std::string(e.what()).find("line 2: '9999") != std::string::npos);
        CHECK(std::string(e.what()).size() < 500);
    }
}

TEST_CASE("lists in lists without end are refused, and take no stack") {
    // The stack has 8 MB, and a call takes 50 bytes at least.
    const std::size_t deep = 200000;
    const std::string lists = std::string(deep, '[') + std::string(deep, ']');
    const TempDir folder;
    const auto expectRefused = [&](const std::string& content, const auto& read) {
        std::ofstream(folder / "deep.json") << content;
        expectError(Error::Kind::BadInput, {"deep.json"}, [&] { read(folder / "deep.json"); });
    };
    expectRefused(lists, readPoints);
    const auto curves = [](const std::string& file) { return readCurves(file); };
    expectRefused(lists, curves);
    expectRefused(R"({"isolines": )" + lists + "}", curves);
    expectRefused("[[" + lists + ", 1, 2, 3, 4, 5]]", readPairs);
}

TEST_CASE("readPoints: JSON") {
    const auto points =
        read("p.json",
             R"([[1, 2, 3], {"position": [-1.5, 2e3, 0]}, {"start": 4, "position": [0, 0, 1]}])");
    REQUIRE(points.size() == 3);
    CHECK(points[0].position == Vec3d{1, 2, 3});
    CHECK(points[1].position == Vec3d{-1.5, 2000, 0});
    CHECK(points[1].start == 0);
    CHECK(points[2].start == 4);
}

TEST_CASE("readPoints: JSON that is no points") {
    const std::string remedy = "[[x, y, z], ...]";
    refuse("p.json", "", {"not a JSON list", remedy});
    refuse("p.json", "[[1, 2, 3]", {"not a JSON list"});
    refuse("p.json", R"({"position": [1, 2, 3]})", {"not a JSON list"});
    refuse("p.json", "[]", {"holds no points"});
    refuse("p.json", "[[1, 2, 3], [1, 2]]", {"entry 1", remedy});
    refuse("p.json", "[[1, 2, null]]", {"entry 0"});
    refuse("p.json", R"([[1, 2, "3"]])", {"entry 0"});
    refuse("p.json", "[1.5, 2, 3]", {"entry 0", "vertex"});
    refuse("p.json", R"([{"point": [1, 2, 3]}])", {"entry 0", "position"});
    refuse("p.json", R"([{"position": [1, 2, 3], "start": "x"}])", {"entry 0", "start"});
    refuse("p.json", R"([{"position": [1, 2, 3], "start": -1}])", {"start value", "negative"});
    refuse("p.json", "[[1, 2, NaN]]", {"not a JSON list"});
    refuse("p.json", "[[1, 2, 1e999]]", {});
}

TEST_CASE("readPoints: files that cannot be read") {
    const TempDir folder;
    const auto kind = Error::Kind::Io;
    expectError(kind, {"nowhere.csv", "No such file"}, [&] { readPoints(folder / "nowhere.csv"); });
    expectError(kind, {"folder"}, [&] { readPoints(folder.path().string()); });
}

TEST_CASE("readCurves: lists, objects, and what the program writes") {
    auto curves = [](const std::string& name, const std::string& content) {
        const TempDir folder;
        std::ofstream(folder / name) << content;
        return readCurves(folder / name);
    };
    const auto text = curves("c.csv", "x,y,z\n1,2,3\n4,5,6\n");
    REQUIRE(text.size() == 1);
    CHECK(text[0].points == std::vector<Vec3d>{{1, 2, 3}, {4, 5, 6}});
    CHECK_FALSE(text[0].closed);
    const auto list = curves("c.json", "[[0,0,0],[1,0,0],[1,1,0],[0,0,0]]");
    REQUIRE(list.size() == 1);
    CHECK(list[0].closed);  // it ends where it begins
    CHECK(list[0].points.size() == 3);
    const auto two = curves("c.json", R"([{"position": [[1,2,3]], "start": 2},
                                          {"position": [[0,0,0],[1,0,0]], "closed": true}])");
    REQUIRE(two.size() == 2);
    CHECK(two[0].start == 2);
    CHECK(two[1].closed);
    CHECK(curves("c.json", R"({"isolines": [{"position": [[1,2,3]], "closed": false}]})").size() ==
          1);
    CHECK(curves("c.json", R"({"paths": [{"vertices": {"position": [[1,2,3],[2,2,3]]}}]})")[0]
              .points.size() == 2);
    for (const char* bad : {"{}", "[]", "[1]", "[{}]", R"([{"position": []}])", "[[1,2]]",
                            R"([{"position": [[1,2,3]], "closed": 1}])", "nonsense",
                            R"([{"position": [[1,2,3]], "start": -1}])",
                            R"([{"position": [[1,2,3]], "start": "x"}])", "[[1,2,3],{}]"}) {
        INFO(bad);
        expectError(Error::Kind::BadInput, {"c.json", "position"}, [&] { curves("c.json", bad); });
    }
}

TEST_CASE("curves of documents with several lists, and with paths that were not reached") {
    const TempDir folder;
    const std::string line =
                          R"({"status": "reached", "vertices": {"position": [[1,2,3],[2,2,3]]}})",
                      none = R"({"status": "unreachable", "vertices": {"position": []}})",
                      two =
                          folder.write("two.json", R"({"paths": [)" + line + "," + none +
                                                       R"(], "walks": [)" + line + "," + line +
                                                       R"(], "pairs": [], "via": [)" + none + "]}");
    std::vector<std::string> warnings;
    CHECK(readCurves(two, &warnings).size() == 3);
    REQUIRE(warnings.size() == 1);
    CHECK(warnings[0].find("2 of 5 paths in " + two) == 0);
    CHECK(readCurves(two).size() == 3);
    expectError(Error::Kind::BadInput, {"two.json", "\"paths\", \"walks\", \"via\"", "of its own"},
                [&] { readAskedCurves(two); });
    const std::string one = folder.write("one.json", R"({"paths": [)" + none + "," + line + "]}");
    warnings.clear();
    CHECK(readAskedCurves(one, &warnings).size() == 1);
    CHECK(warnings.size() == 1);
    const std::string lost = folder.write("lost.json", R"({"paths": [)" + none + "]}");
    expectError(Error::Kind::BadInput, {"lost.json", "1 paths", "not reached"},
                [&] { readCurves(lost); });
    expectError(Error::Kind::BadInput, {"lost.json"}, [&] { readAskedCurves(lost); });
    const std::string bad =
        folder.write("bad.json", R"({"paths": [)" + line + R"(], "via": [{}]})");
    expectError(Error::Kind::BadInput, {"bad.json, \"via\", entry 0"}, [&] { readCurves(bad); });
}

TEST_CASE("endings of lists of points are those of any case") {
    CHECK(read("p.JSON", "[[1, 2, 3]]")[0].position == Vec3d{1, 2, 3});
    CHECK(read("p.Label", "#!ascii label\n1\n5 0 0 0 0\n")[0].vertex == "5");
    const TempDir folder;
    CHECK(readPairs(folder.write("p.Json", "[[1, 2]]"))[0].target.vertex == "2");
    CHECK(readCurves(folder.write("c.JSON", "[[1,2,3],[4,5,6]]"))[0].points.size() == 2);
    CHECK(readAskedCurves(folder.write("v.JSON", "[1, 2]"))[0].points[1].vertex == "2");
}

TEST_CASE("readPairs: six numbers each") {
    auto pairs = [](const std::string& name, const std::string& content) {
        const TempDir folder;
        std::ofstream(folder / name) << content;
        return readPairs(folder / name);
    };
    for (const auto& [name, content] :
         {std::pair("p.csv", "a,b,c,d,e,f\n1,2,3,4,5,6\n"), {"p.json", "[[1,2,3,4,5,6]]"}}) {
        const auto read = pairs(name, content);
        REQUIRE(read.size() == 1);
        CHECK(read[0].source.position == Vec3d{1, 2, 3});
        CHECK(read[0].target.position == Vec3d{4, 5, 6});
    }
    expectError(Error::Kind::BadInput, {"line 2", "x,y,z,x,y,z"},
                [&] { pairs("p.csv", "1,2,3,4,5,6\n1,2,3\n"); });
    expectError(Error::Kind::BadInput, {"entry 0", "six"}, [&] { pairs("p.json", "[[1,2,3]]"); });
    expectError(Error::Kind::BadInput, {"no pairs"}, [&] { pairs("p.csv", "# none\n"); });
}

TEST_CASE("parseCurve: points with blanks between") {
    const AskedCurve curve = parseCurve("0,0,1  1,0,0;vertex:12 +x");
    REQUIRE(curve.points.size() == 4);
    CHECK(curve.points[1].position == Vec3d{1, 0, 0});
    CHECK(curve.points[2].vertex == "12");
    CHECK_FALSE(curve.closed);
    const AskedCurve closed = parseCurve("0,0,1 1,0,0 0,1,0 0,0,1");
    CHECK(closed.closed);
    CHECK(closed.points.size() == 3);
    CHECK(parseCurve("vertex:1 vertex:2 vertex:3 vertex:1").closed);
    CHECK_FALSE(parseCurve("0,0,1 0,0,1").closed);
    for (const char* file : {"points.csv", "my points.csv", "", "a,b,c"})
        CHECK(parseCurve(file).points.empty());
    expectError(Error::Kind::InvalidArgument, {"'points.csv'"},
                [] { parseCurve("0,0,1 points.csv"); });
}

TEST_CASE("readAskedCurves: curves, or the points of one") {
    auto curves = [](const std::string& name, const std::string& content) {
        const TempDir folder;
        std::ofstream(folder / name) << content;
        return readAskedCurves(folder / name);
    };
    const auto text = curves("c.csv", "3\n14\n15\n3\n");
    REQUIRE(text.size() == 1);
    CHECK(text[0].closed);
    CHECK(text[0].points.size() == 3);
    CHECK(text[0].points[1].vertex == "14");
    CHECK(curves("c.json", "[3, 14, 15]")[0].points[2].vertex == "15");
    CHECK(curves("c.json", "[[0,0,1],[1,0,0]]")[0].points.size() == 2);
    CHECK(curves("c.json", R"([{"position": [0,0,1]}, {"vertex": 4}])")[0].points.size() == 2);
    const auto two = curves("c.json", R"([{"position": [[0,0,0],[1,0,0],[1,1,0]], "closed": true},
                                          {"position": [[0,0,0],[1,0,0]]}])");
    REQUIRE(two.size() == 2);
    CHECK(two[0].closed);
    CHECK(curves("c.json", R"({"paths": [], "walks":
                              [{"vertices": {"position": [[1,2,3],[2,2,3]]}}]})")[0]
              .points.size() == 2);
    // Of a walk `start` is a point.
    CHECK(curves("c.json", R"({"walks": [{"start": {"position": [1,2,3]},
                              "vertices": {"position": [[1,2,3],[2,2,3]]}}]})")[0]
              .points.size() == 2);
    for (const char* bad :
         {"{}", "[]", "nonsense", R"([{"position": []}])", R"([{"vertices": 1}])"})
        expectError(Error::Kind::BadInput, {"c.json"}, [&] { curves("c.json", bad); });
}

}  // namespace igeo::test
