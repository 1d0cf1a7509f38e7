// JSON outputs: valid by their schemas, and consistent in what they say.
#include <support/catch.h>

#include <cmath>
#include <filesystem>
#include <set>

#include "program.h"

namespace igeo::test {

namespace {

const std::string kSchemas = IGEO_SOURCE_DIR "/docs/";

/// Runs validate_json.py.
Result validate(const std::string& schema, const std::string& document) {
    Command command;
    command.program = "/usr/bin/python3";
    command.args = {IGEO_SOURCE_DIR "/tests/cli/validate_json.py", schema, document};
    return run(command);
}

void requireValid(const TempWorkspace& desk, const std::string& schema,
                  const std::string& document) {
    const Result result = validate(kSchemas + schema, desk / document);
    if (result.exitCode == 77 || result.exitCode == 127) {
        markSkipped("a document was not compared with its schema: python3-jsonschema is missing");
        return;
    }
    INFO(document << "\n" << result.out << result.err);
    CHECK(result.exitCode == 0);
}

double between(const json& a, const json& b) {
    double sum = 0;
    for (int k = 0; k < 3; ++k) sum += std::pow(a[k].get<double>() - b[k].get<double>(), 2);
    return std::sqrt(sum);
}

/// What holds for every path that reached its seed.
void requireConsistent(const json& path, double dx) {
    const auto& position = path["vertices"]["position"];
    const auto arc = path["vertices"]["arcLength"].get<std::vector<double>>();
    const auto d = path["vertices"]["distance"].get<std::vector<double>>();
    REQUIRE(path["status"] == "reached");
    REQUIRE(arc.size() >= 2);
    REQUIRE(position.size() == arc.size());
    REQUIRE(d.size() == arc.size());
    CHECK(arc.front() == 0);
    CHECK(arc.back() == path["length"].get<double>());
    CHECK(d.front() == path["distance"].get<double>());
    CHECK(position.front() == path["target"]["position"]);
    CHECK(position.back() == path["seed"]["position"]);
    CHECK(d.back() == Approx(path["seed"]["start"].get<double>()).margin(1e-12));
    for (std::size_t k = 1; k < arc.size(); ++k) {
        INFO("vertex " << k << " of " << arc.size());
        // Chords, summed; rounding of world coordinates is far below 1e-9.
        CHECK(arc[k] - arc[k - 1] == Approx(between(position[k - 1], position[k])).margin(1e-9));
        CHECK(arc[k] > arc[k - 1]);
        // d falls along a path, but each value is a trilinear mean of nodes whose d is off by an
        // error that varies from node to node by up to some percent of dx.
        CHECK(d[k] < d[k - 1] + 0.05 * dx);
    }
    for (const char* end : {"target", "seed"})
        CHECK(path[end]["snapDistance"].get<double>() ==
              Approx(between(path[end]["asked"], path[end]["position"])).margin(1e-9));
}

}  // namespace

TEST_CASE("reports and paths are valid by their schemas") {
    const std::string options =
        GENERATE("--target 0.7,0,0.5", "--target 0.7,0,0.5 --target -1.2,0,0 --grids gradient",
                 "--target 0.2,0,0 --max-distance 0.3",
                 "--target 0.7,0,0.5 --stop-at-targets --scheme godunov",
                 "--target 0.7,0,0.5 --weight-curvature valley --obstacle-sphere 3,0,0,1",
                 "--target 0.7,0,0.5 --metric-curvature avoid --straighten");
    const TempWorkspace desk;
    desk.make("in.vdb", "two-spheres --grid-class unknown");  // with a warning
    const Result result = desk.run(
        "--sdf in.vdb --seed 1.2,0,0 -q --report report.json -o out.vdb "
        "--paths paths.json " +
        options);
    INFO(options << "\n" << result.err);
    REQUIRE((result.exitCode == 0 || result.exitCode == 4));
    requireValid(desk, "report.schema.json", "report.json");
    requireValid(desk, "geodesics.schema.json", "paths.json");
    // Only NaN and infinity would be words of their own.
    for (const char* name : {"report.json", "paths.json"})
        REQUIRE_FALSE(json::parse(readBytes(desk / name), nullptr, false).is_discarded());
}

TEST_CASE("all documents of a run say alike how it was made") {
    const TempWorkspace desk;
    desk.make("in.vdb", "two-spheres --grid-class unknown");  // with a warning
    writeBytes(desk / "pairs.csv", "1.2,0,0,0.9,0.3,0\n1.2,0,0,9,9,9\n");
    const Result result = desk.run(
        "--sdf in.vdb --seed 1.2,0,0 --target 0.7,0,0.5 --target 9,9,9 --pairs pairs.csv -q "
        "--obstacle-sphere 3,0,0,1 --skip-off-surface --threads 1 --paths p.json --isolines i.json "
        "--matrix m.json --pairs-out q.json --report r.json");
    INFO(result.err);
    REQUIRE(result.exitCode == 4);
    const std::vector<std::pair<std::string, std::string>> documents{
        {"report", "r"}, {"geodesics", "p"}, {"isolines", "i"}, {"matrix", "m"}, {"pairs", "q"}};
    const json report = readJson(desk / "r.json");
    CHECK(report["command"][1] == "in.vdb");
    for (const json& word : report["command"]) CHECK((word != "--threads" && word != "-q"));
    for (const auto& [schema, name] : documents) {
        INFO(schema);
        requireValid(desk, schema + ".schema.json", name + ".json");
        const json document = readJson(desk / (name + ".json"));
        for (const char* same : {"command", "versions", "inputs", "metric", "warnings"})
            CHECK(document[same] == report[same]);
        for (const char* part : {"surface", "parameters"})
            for (const auto& [member, value] : document[part].items())
                CHECK(report[part][member] == value);
        CHECK(document["parameters"]["skipOffSurface"] == true);
        CHECK(document["seconds"]["march"] == report["seconds"]["march"]);
        CHECK(document["peakMemoryBytes"] <= report["peakMemoryBytes"]);
        CHECK(document["peakMemoryBytes"] > 1000000);
    }
    // What was skipped keeps its place.
    const json target = report["targets"][1], pair = readJson(desk / "q.json")["pairs"][1],
               matrix = readJson(desk / "m.json");
    CHECK(target["status"] == "off surface");
    CHECK((target["distance"].is_null() && target["target"]["position"].is_null()));
    CHECK(target["target"]["asked"] == json({9.0, 9.0, 9.0}));
    CHECK(matrix["targets"][1] == target["target"]);
    CHECK((matrix["distance"][0][0].is_number() && matrix["distance"][0][1].is_null()));
    CHECK((pair["distance"].is_null() && pair["target"]["reason"] == "off the surface"));
}

TEST_CASE(
    "documents of runs with results of every kind hold to the schemas, of which all are used") {
    const TempWorkspace desk;
    desk.make("in.vdb", "sphere --voxel-size 0.1");
    writeBytes(desk / "in.obj",
               "v 1 0 0\nv -1 0 0\nv 0 1 0\nv 0 -1 0\nv 0 0 1\nv 0 0 -1\nf 1 3 5\nf 3 2 5\n"
               "f 2 4 5\nf 4 1 5\nf 3 1 6\nf 2 3 6\nf 4 2 6\nf 1 4 6\n");
    writeBytes(desk / "pairs.csv", "1,0,0,0,0,1\n0,1,0,0,0,1\n");
    writeBytes(desk / "curve.csv", "1,0,0\n0,1,0\n");
    const bool viewer = desk.run("--version").out.find("no --view") == std::string::npos;
    const std::string curves =
        " --pairs pairs.csv --via 1,0,0;0,1,0;0,0,1 --shoot 0,0,1,1,0,0,0.5 ";
    const std::vector<std::pair<std::string, std::string>> runs{
        {"--mesh in.obj --resolution 16 --seed +z --sample 2 --target +x --straighten" + curves +
             "-o o.vdb --grids gradient,label --mesh-out m.ply --per-vertex v.csv --samples s.csv "
             "--image i.png --image-size 80x60" +
             (viewer ? " --view v.html" : ""),
         "report geodesics isolines matrix pairs"},
        {"--sdf in.vdb --seed-curve curve.csv --weight-curvature valley --obstacle-sphere "
         "0,0,-1,0.3 --target 0,0,1" +
             curves,
         "report geodesics isolines pairs"},
        {"--sdf in.vdb --rebuild --snap 0.2" + curves, "report geodesics pairs"},
        {"--sdf in.vdb --seed 0,0,1 --scheme godunov --target 1,0,0", "report geodesics isolines"}};
    const std::map<std::string, std::string> options{{"report", "--report"},
                                                     {"geodesics", "--paths"},
                                                     {"isolines", "--isolines"},
                                                     {"matrix", "--matrix"},
                                                     {"pairs", "--pairs-out"}};
    std::set<std::string> used;
    const auto require = [&](const std::string& schema, const std::string& document) {
        INFO(schema);
        requireValid(desk, schema + ".schema.json", document);
        used.insert(schema + ".schema.json");
    };
    for (const auto& [run, documents] : runs) {
        std::string line = run + " -q";
        for (const std::string& name : split(documents))
            line += " " + options.at(name) + " " + name + ".json";
        requireDone(desk, line);
        INFO(line);
        for (const std::string& name : split(documents)) require(name, name + ".json");
        if (&run == &runs.front().first)  // all but the report itself
            CHECK(readJson(desk / "report.json")["outputs"].size() == (viewer ? 10 : 9));
    }
    for (const std::string file : {"in.vdb", "in.obj"}) {
        writeBytes(desk / "survey.json", desk.run("info --json " + file).out);
        require("info", "survey.json");
    }
    writeBytes(desk / "jobs.json",
               R"({"version": 2, "defaults": {"sdf": "in.vdb", "report": "{name}.report.json"},
                   "jobs": [{"name": "a", "seed": [0, 0, 1], "output": "a.vdb"},
                            {"name": "b", "via": "1,0,0;0,1,0"},
                            {"name": "off", "seed": [9, 9, 9], "output": "off.vdb"}]})");
    REQUIRE(desk.run("batch jobs.json -q").exitCode == 2);
    require("batch", "jobs.json");
    require("summary", "jobs.summary.json");
    require("report", "b.report.json");
    for (const auto& entry : std::filesystem::directory_iterator(IGEO_SOURCE_DIR "/docs")) {
        const std::string name = entry.path().filename().string();
        if (name.ends_with(".schema.json")) CHECK(used.count(name) == 1);
    }
}

TEST_CASE("documents differ in times and memory only, and with SOURCE_DATE_EPOCH in nothing") {
    const TempWorkspace desk;
    desk.make("in.vdb", "two-spheres --grid-class unknown");
    const auto documents = [&](const char* epoch, const char* threads) {
        std::map<std::string, json> all;
        for (const std::string line :
             {"--sdf in.vdb --seed 1.2,0,0 --target 0.7,0,0.5 -q --paths out.json",
              "--sdf in.vdb --seed 1.2,0,0 --target 0.7,0,0.5 -q --matrix out.json",
              "--sdf in.vdb --seed 1.2,0,0 -q --isolines out.json", "info in.vdb --json"}) {
            Command command = desk.command(line + " --threads " + threads);
            command.environment["SOURCE_DATE_EPOCH"] = epoch;
            const Result result = run(command);
            INFO(line << "\n" << result.err);
            REQUIRE(result.exitCode == 0);
            all[line] = parseJson(result.out.empty() ? readBytes(desk / "out.json") : result.out);
        }
        return all;
    };
    auto timed = documents("", "1");
    const auto same = documents("1700000000", "1");
    CHECK((documents("1700000000", "2") == same));
    for (auto& [line, document] : timed) {
        INFO(line);
        CHECK((document != same.at(line)));
        for (const char* member : {"seconds", "peakMemoryBytes"}) {
            CHECK(same.at(line)[member].is_null());
            CHECK_FALSE(document[member].is_null());
            document[member] = nullptr;
        }
        CHECK(document == same.at(line));
    }
}

TEST_CASE("targets and pairs off the surface: rows with a reason, a warning, exit code 4") {
    const TempWorkspace desk;
    desk.make("in.vdb", "sphere --voxel-size 0.1");
    writeBytes(desk / "t.csv", "1,0,0\n9,9,9\n0,1,0\n0,0,5\n5,0,0\n0,5,0\n");
    writeBytes(desk / "p.csv", "1,0,0,0,1,0\n9,9,9,0,1,0\n");
    const std::string base = "--sdf in.vdb --seed 0,0,1 --targets t.csv --matrix -";
    CHECK(desk.run(base).exitCode == 2);
    const Result matrix = desk.run(base + " --skip-off-surface");
    CHECK(matrix.exitCode == 4);
    CHECK_THAT(matrix.err, contains("4 of 6 targets are off the surface"));
    CHECK_THAT(matrix.err, contains("target 1 (9,9,9) is 14.588"));
    CHECK(matrix.err.find("target 5") == std::string::npos);
    const auto rows = lines(matrix.out);
    REQUIRE(rows.size() == 7);
    CHECK(rows[0] == "target,x,y,z,distance_0,reason");
    CHECK_THAT(rows[1], Catch::Matchers::StartsWith("0,1,") && Catch::Matchers::EndsWith(","));
    CHECK_THAT(rows[2], Catch::Matchers::StartsWith("1,,,,,14.588"));
    CHECK_THAT(rows[2], Catch::Matchers::EndsWith(" from the surface"));
    const Result pairs = desk.run("--sdf in.vdb --pairs p.csv --skip-off-surface");
    CHECK(pairs.exitCode == 4);
    CHECK_THAT(pairs.out, contains("sourceSnap,targetSnap,reason\n0,1.5"));
    CHECK_THAT(pairs.out, contains("\n1,,,,the source is off the surface\n"));
    // Rows that are good have the same bits.
    writeBytes(desk / "t.csv", "1,0,0\n0,1,0\n");
    const auto plain = lines(desk.run(base + " -q").out);
    CHECK(rows[1] == plain[1] + ",");
    CHECK(rows[3].substr(1) == plain[2].substr(1) + ",");
    const Result idle = desk.run("--sdf in.vdb --seed 0,0,1 --skip-off-surface");
    CHECK(idle.exitCode == 2);
    CHECK_THAT(idle.err, contains("--skip-off-surface has no effect without"));
}

TEST_CASE("the schemas refuse what does not belong") {
    const TempWorkspace desk;
    desk.make("in.vdb", "sphere --voxel-size 0.1");
    requireDone(desk, "--sdf in.vdb --seed 0,0,1 -q --target 1,0,0 -o out.vdb --paths p.json");
    const int valid = validate(kSchemas + "geodesics.schema.json", desk / "p.json").exitCode;
    if (valid == 77 || valid == 127) return markSkipped("python3-jsonschema is missing");
    const json good = readJson(desk / "p.json");
    const auto exitCodeOf = [&](const json& changed) {
        writeBytes(desk / "changed.json", changed.dump());
        return validate(kSchemas + "geodesics.schema.json", desk / "changed.json").exitCode;
    };
    CHECK(exitCodeOf(good) == 0);
    json more = good, less = good, wrong = good;
    more["paths"][0]["color"] = "red";
    less["paths"][0].erase("distance");
    wrong["paths"][0]["status"] = "lost";
    CHECK(exitCodeOf(more) == 1);
    CHECK(exitCodeOf(less) == 1);
    CHECK(exitCodeOf(wrong) == 1);
}

TEST_CASE("a path runs from its target to its seed, downhill, on the surface") {
    const std::string shape = GENERATE("sphere", "torus", "trefoil --voxel-size 0.03");
    const TempWorkspace desk;
    desk.make("in.vdb", shape);
    const std::string seed = shape == "torus"    ? "1.4,0,0"
                             : shape == "sphere" ? "0,0,1"
                                                 : "0,-.42,0";
    requireDone(desk, "--sdf in.vdb --seed " + seed +
                          " --target 0.2,0.95,0.3 --target -0.4,0.9,0.2 --target 0.6,-0.8,0.1 "
                          "--snap 2 -q -o out.vdb --paths p.json --report r.json");
    const json paths = readJson(desk / "p.json");
    const json report = readJson(desk / "r.json");
    const double dx = paths["surface"]["voxelSize"];
    REQUIRE(paths["paths"].size() == 3);
    for (const json& path : paths["paths"]) requireConsistent(path, dx);
    // The report says the same about the targets.
    for (std::size_t k = 0; k < 3; ++k) {
        json path = paths["paths"][k];
        path.erase("vertices");
        CHECK(path == report["targets"][k]);
    }
    CHECK(paths["surface"]["file"] == "in.vdb");
    CHECK(report["distance"]["reached"].get<int>() + report["distance"]["unreached"].get<int>() ==
          report["band"]["nodes"].get<int>());
}

TEST_CASE("a target without a distance has a path without vertices") {
    const TempWorkspace desk;
    desk.make("in.vdb", "two-spheres");
    CHECK(desk.run("--sdf in.vdb --seed 1.2,0,0 --target -1.2,0,0 -q -o o.vdb --paths p.json")
              .exitCode == 4);
    const json path = readJson(desk / "p.json")["paths"][0];
    CHECK(path["status"] == "unreachable");
    CHECK(path["distance"].is_null());
    CHECK(path["length"].is_null());
    CHECK(path["seed"].is_null());
    CHECK(path["vertices"]["position"].empty());
}

TEST_CASE("OBJ paths have the vertices of the JSON, bit by bit") {
    const TempWorkspace desk;
    desk.make("in.vdb", "sphere");
    const std::string base = "--sdf in.vdb --seed 0,0,1 --target 1,0,0 --target 0,0.6,-0.8 -q ";
    requireDone(desk, base + "-o out.vdb --paths p.json");
    requireDone(desk, base + "-o out.vdb --paths p.obj");
    std::vector<std::vector<double>> inObj, inJson;
    std::size_t objects = 0, ends = 0;
    for (const std::string& line : lines(readBytes(desk / "p.obj"))) {
        const auto words = split(line);
        objects += words[0] == "o";
        if (words[0] == "l") ends += words.size() - 1;
        if (words[0] == "v")
            inObj.push_back({std::stod(words[1]), std::stod(words[2]), std::stod(words[3])});
    }
    const json document = readJson(desk / "p.json");
    for (const json& path : document["paths"])
        for (const json& p : path["vertices"]["position"])
            inJson.push_back(p.get<std::vector<double>>());
    CHECK(objects == 2);
    CHECK(ends == 2 * (inObj.size() - 2));
    CHECK(inObj == inJson);
}

}  // namespace igeo::test
