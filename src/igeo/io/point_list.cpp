#include <igeo/io/point_list.h>

#include <fmt/core.h>
#include <igeo/base/error.h>
#include <igeo/io/annotation_file.h>
#include <igeo/io/detail/file_bytes.h>
#include <igeo/io/detail/json_depth.h>
#include <igeo/io/detail/number_rows.h>
#include <igeo/io/vertex_data_file.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>
#include <string_view>
#include <utility>

namespace igeo {

namespace {

using Kind = Error::Kind;
/// It keeps members in the order of the file.
using json = nlohmann::ordered_json;

/// Three numbers of a list, from `first` on.
/// @throws std::invalid_argument
Vec3d vectorFrom(const json& j, std::size_t first) {
    Vec3d p;
    for (int a = 0; a < 3; ++a) {
        const json& number = j[first + std::size_t(a)];
        if (!number.is_number()) throw std::invalid_argument("coordinates are numbers");
        p[a] = number.get<double>();
        if (!std::isfinite(p[a])) throw std::invalid_argument("coordinates are finite");
    }
    return p;
}

/// @throws std::invalid_argument
Vec3d positionFrom(const json& j) {
    if (!j.is_array() || j.size() != 3) throw std::invalid_argument("a position is [x, y, z]");
    return vectorFrom(j, 0);
}

/// @throws std::invalid_argument
AskedPoint vertexFrom(const json& j) {
    if (!j.is_number_unsigned())
        throw std::invalid_argument("the number of a vertex is whole and at least 0");
    return AskedPoint(std::to_string(j.get<std::uint64_t>()));
}

/// @throws std::invalid_argument
AskedPoint pointFrom(const json& j) {
    if (j.is_number()) return vertexFrom(j);
    if (!j.is_object()) return {positionFrom(j), 0};
    if (j.contains("position") == j.contains("vertex"))
        throw std::invalid_argument("there is no \"position\", nor a \"vertex\" instead");
    AskedPoint p =
        j.contains("vertex") ? vertexFrom(j["vertex"]) : AskedPoint(positionFrom(j["position"]));
    if (j.contains("start")) {
        if (!j["start"].is_number()) throw std::invalid_argument("\"start\" is a number");
        p.start = j["start"].get<double>();
    }
    return p;
}

/// The content of a .json file; discarded if it is not valid JSON.
json parsedJson(std::istream& in, const std::string& file) {
    return json::parse(in, JsonGuard<json>(file), /*allow_exceptions=*/false);
}

/// The list that a .json file holds.
json listFromJson(std::istream& in, const std::string& file, const char* what,
                  const std::string& remedy) {
    json all = parsedJson(in, file);
    if (!all.is_array())
        throw Error(Kind::BadInput, file + " is not a JSON list of " + what, remedy);
    return all;
}

/// read(entry) for every entry; errors name the entry.
template <typename Read>
auto readEntries(const json& all, const std::string& file, const std::string& remedy,
                 const Read& read) {
    std::vector<decltype(read(all))> entries;
    for (const json& j : all) {
        try {
            entries.push_back(read(j));
        } catch (const std::invalid_argument& e) {
            throw Error(Kind::BadInput,
                        fmt::format("{}, entry {}: {}", file, entries.size(), e.what()), remedy);
        }
    }
    return entries;
}

/// @throws std::invalid_argument
Curve curveFrom(const json& j) {
    // Isolines have positions here; geodesics have them in `vertices`, beside the distances.
    const bool isPath = j.is_object() && j.contains("vertices");
    const json& holder = isPath ? j["vertices"] : j;
    if (!holder.is_object() || !holder.contains("position") || !holder["position"].is_array())
        throw std::invalid_argument("there is no list \"position\"");
    Curve curve;
    for (const json& p : holder["position"]) curve.points.push_back(positionFrom(p));
    if (curve.points.empty()) throw std::invalid_argument("\"position\" is empty");
    if (j.contains("closed")) {
        if (!j["closed"].is_boolean()) throw std::invalid_argument("\"closed\" is true or false");
        curve.closed = j["closed"].get<bool>();
    }
    if (j.contains("start") && !isPath) {  // of a walk it is a point
        if (!j["start"].is_number()) throw std::invalid_argument("\"start\" is a number");
        curve.start = j["start"].get<double>();
        if (!(curve.start >= 0 && std::isfinite(curve.start)))
            throw std::invalid_argument("\"start\" is finite and at least 0");
    }
    return curve;
}

/// The lists of curves in a document of this program that are not empty, by their names.
std::vector<std::pair<std::string, const json*>> listsIn(const json& document) {
    std::vector<std::pair<std::string, const json*>> lists;
    for (const char* name : {"isolines", "paths", "walks", "pairs", "via"})
        if (document.is_object() && document.contains(name) && !document[name].empty())
            lists.emplace_back(name, &document[name]);
    return lists;
}

/// Whether a path of this program has no vertices, as none was found.
bool isWithoutPath(const json& j) {
    if (!j.is_object() || !j.contains("status") || !j.contains("vertices")) return false;
    const json& vertices = j["vertices"];
    return vertices.is_object() && vertices.contains("position") && vertices["position"].empty();
}

constexpr const char* kCurvesRemedy =
    R"(write [[x, y, z], ...] or [{"position": [[x, y, z], ...], "closed": true}, ...])";

/// Adds the curves of a list but for paths without vertices.
/// @return the number of these
std::size_t addCurves(const json& list, const std::string& file, std::vector<Curve>& curves) {
    if (!list.is_array() || list.empty())
        throw Error(Kind::BadInput, file + " is not a JSON list of curves", kCurvesRemedy);
    if (list[0].is_array()) {
        curves.emplace_back();
        curves.back().points = readEntries(list, file, kCurvesRemedy, positionFrom);
        return 0;
    }
    std::size_t skipped = 0;
    for (const auto& curve : readEntries(list, file, kCurvesRemedy, [](const json& j) {
             return isWithoutPath(j) ? std::optional<Curve>() : curveFrom(j);
         }))
        if (curve)
            curves.push_back(*curve);
        else
            ++skipped;
    return skipped;
}

std::vector<Curve> curvesFromJson(std::istream& in, const std::string& file,
                                  std::vector<std::string>* warnings) {
    const json document = parsedJson(in, file);
    std::vector<Curve> curves;
    std::size_t skipped = 0;
    const auto lists = listsIn(document);
    if (lists.empty()) skipped = addCurves(document, file, curves);
    for (const auto& [name, list] : lists)
        skipped += addCurves(*list, file + ", \"" + name + "\"", curves);
    if (curves.empty())
        throw Error(Kind::BadInput,
                    fmt::format("{} holds {} paths and none with vertices: their ends were not "
                                "reached",
                                file, skipped),
                    "give a file with paths that were reached");
    if (skipped > 0 && warnings)
        warnings->push_back(
            fmt::format("{} of {} paths in {} have no vertices and are left out: "
                        "their ends were not reached",
                        skipped, skipped + curves.size(), file));
    return curves;
}

/// @throws std::invalid_argument
AskedPair pairFrom(const json& j) {
    if (j.is_array() && j.size() == 2) return {vertexFrom(j[0]), vertexFrom(j[1])};
    if (!j.is_array() || j.size() != 6)
        throw std::invalid_argument("a pair is six numbers, or two vertices");
    return {vectorFrom(j, 0), vectorFrom(j, 3)};
}

/// The vertex with a number from a text file.
/// @throws Error  BadInput
AskedPoint vertexFrom(double number, const std::string& file) {
    if (!(number >= 0 && number == std::floor(number) && number < 0x1p53))
        throw Error(Kind::BadInput, fmt::format("{}: {} is no number of a vertex", file, number),
                    "write whole numbers from 0 on, or x,y,z");
    return AskedPoint(fmt::format("{:.0f}", number));
}

bool isJson(const std::string& file) { return endingBeforeGz(file) == ".json"; }

std::ifstream open(const std::string& file) {
    errno = 0;
    std::ifstream in(file, std::ios::binary);
    if (!in)
        throw Error(Kind::Io, "cannot read '" + file + "': " + std::strerror(errno),
                    "check the name and the permissions");
    std::error_code ignored;
    if (std::filesystem::is_directory(file, ignored))
        throw Error(Kind::Io, "cannot read '" + file + "': it is a folder",
                    "give a .json or .csv file");
    return in;
}

constexpr const char* kPointsRemedy =
    R"(write [[x, y, z], ...], [{"position": [x, y, z], "start": s}, ...] or [vertex, ...])";

std::vector<AskedPoint> pointsFromText(std::istream& in, const std::string& file) {
    std::vector<AskedPoint> points;
    if (endingBeforeGz(file) == ".label") {
        for (const std::size_t v : readLabelFile(file))
            points.push_back(AskedPoint(std::to_string(v)));
        return points;
    }
    for (const auto& v :
         rowsFromText(in, file, "x,y,z,start", {1, 3, 4}, "x,y,z, x,y,z,start or a vertex"))
        if (v.size() == 1)
            points.push_back(vertexFrom(v[0], file));
        else
            points.emplace_back(Vec3d{v[0], v[1], v[2]}, v.size() == 4 ? v[3] : 0.0);
    return points;
}

/// @throws Error  BadInput without points, and for a start value out of range
void requirePoints(const std::vector<AskedPoint>& points, const std::string& file) {
    if (points.empty())
        throw Error(Kind::BadInput, file + " holds no points",
                    "write one point per line: x,y,z or x,y,z,start, or a vertex");
    for (const Seed& p : points)
        if (!(p.start >= 0 && std::isfinite(p.start)))
            throw Error(Kind::BadInput,
                        fmt::format("{}: start value {:g} is negative", file, p.start),
                        "start values are distances: finite and at least 0");
}

/// @param what  names the file, and the group in it
AskedGroup groupFrom(const json& list, const std::string& name, const std::string& what) {
    if (!list.is_array())
        throw Error(Kind::BadInput, what + " is not a list of points", kPointsRemedy);
    AskedGroup group{name, readEntries(list, what, kPointsRemedy, pointFrom)};
    requirePoints(group.points, what);
    return group;
}

std::vector<AskedGroup> groupsFrom(const json& groups, const std::string& file) {
    std::vector<AskedGroup> all;
    if (groups.is_object()) {
        for (const auto& [name, list] : groups.items()) {
            const bool hasControls = std::any_of(name.begin(), name.end(), [](char c) {
                return static_cast<unsigned char>(c) < 0x20 || c == 0x7f;
            });
            if (name.empty() || hasControls)
                throw Error(Kind::BadInput,
                            fmt::format("{}: the name of group {} is empty or holds a control "
                                        "character",
                                        file, all.size()),
                            "give each group a name that can be printed");
            all.push_back(groupFrom(list, name, file + ", group '" + name + "'"));
        }
    } else if (groups.is_array()) {
        for (const json& list : groups)
            all.push_back(groupFrom(list, "", file + ", group " + std::to_string(all.size())));
    }
    if (all.empty())
        throw Error(
            Kind::BadInput, file + ": \"groups\" is no list of groups",
            R"(write {"groups": {"name": [vertex, ...], ...}} or {"groups": [[...], ...]})");
    return all;
}

AskedSeeds seedsFrom(std::istream& in, const std::string& file) {
    AskedSeeds seeds;
    if (!isJson(file)) {
        seeds.points = pointsFromText(in, file);
        requirePoints(seeds.points, file);
        return seeds;
    }
    const json document = parsedJson(in, file);
    if (document.is_object() && document.contains("groups")) {
        seeds.groups = groupsFrom(document["groups"], file);
        return seeds;
    }
    if (!document.is_array())
        throw Error(Kind::BadInput, file + " is not a JSON list of points", kPointsRemedy);
    seeds.points = readEntries(document, file, kPointsRemedy, pointFrom);
    requirePoints(seeds.points, file);
    return seeds;
}

AskedSeeds regionsOf(const Annotation& annotation) {
    AskedSeeds seeds;
    seeds.vertices = annotation.vertices;
    for (const VertexRegion& region : annotation.regions) {
        seeds.groups.push_back({region.name, {}});
        for (const std::size_t v : region.vertices)
            seeds.groups.back().points.push_back(AskedPoint(std::to_string(v)));
    }
    return seeds;
}

}  // namespace

std::vector<double> parseNumbers(const std::string& text) { return numbersIn(text); }

AskedPoint parsePoint(const std::string& text) {
    constexpr std::array<const char*, 7> kNames{"+x", "-x", "+y", "-y", "+z", "-z", "center"};
    if (std::find(kNames.begin(), kNames.end(), text) != kNames.end()) return AskedPoint(text);
    constexpr std::string_view kVertex = "vertex:";
    if (text.starts_with(kVertex)) {
        const std::string number = text.substr(kVertex.size());
        if (!number.empty() && number.find_first_not_of("0123456789") == number.npos)
            return AskedPoint(number);
    }
    const std::vector<double> v = parseNumbers(text);
    if (v.size() != 3)
        throw Error(Kind::InvalidArgument, "'" + text + "' is not a point",
                    "write three finite numbers with commas between them, as in 0.1,0.2,0.3; of a "
                    "mesh or points also vertex:123, +x, -x, +y, -y, +z, -z or center");
    return {v[0], v[1], v[2]};
}

AskedSeeds readSeeds(const std::string& file) {
    if (isAnnotationFile(file)) return regionsOf(readAnnotation(file));
    std::ifstream in = open(file);
    return seedsFrom(in, file);
}

std::vector<AskedPoint> readPoints(const std::string& file) {
    const AskedSeeds seeds = readSeeds(file);
    if (!seeds.groups.empty())
        throw Error(Kind::BadInput, file + " holds groups, where points are asked for",
                    "give groups as seeds, and points as a list");
    return seeds.points;
}

std::vector<Curve> readCurves(const std::string& file, std::vector<std::string>* warnings) {
    std::ifstream in = open(file);
    std::vector<Curve> curves;
    if (isJson(file)) {
        curves = curvesFromJson(in, file, warnings);
    } else {
        Curve one;
        for (const AskedPoint& p : readPoints(file)) {
            if (!p.vertex.empty())
                throw Error(Kind::BadInput, file + " names vertices, which make no curve",
                            "write positions: x,y,z");
            one.points.push_back(p.position);
        }
        curves.push_back(one);
    }
    for (Curve& curve : curves) {
        auto& points = curve.points;
        if (points.size() < 2 || points.front() != points.back()) continue;
        points.pop_back();
        curve.closed = true;
    }
    return curves;
}

namespace {

bool same(const AskedPoint& a, const AskedPoint& b) {
    return a.vertex == b.vertex && a.position == b.position;
}

/// A curve whose last point repeats its first is closed.
AskedCurve curveThrough(std::vector<AskedPoint> points) {
    AskedCurve curve{std::move(points), false};
    if (curve.points.size() < 3 || !same(curve.points.front(), curve.points.back())) return curve;
    curve.points.pop_back();
    curve.closed = true;
    return curve;
}

/// Whether a .json file holds curves, rather than the points of one.
/// @throws Error  BadInput for several lists of them
bool holdsCurves(const std::string& file) {
    std::ifstream in = open(file);
    const json all = parsedJson(in, file);
    if (const auto lists = listsIn(all); lists.size() > 1) {
        std::string names;
        for (const auto& list : lists) names += (names.empty() ? "\"" : ", \"") + list.first + '"';
        throw Error(Kind::BadInput, file + " holds several lists of curves: " + names,
                    "write the list you mean into a file of its own, as {\"" + lists[0].first +
                        "\": [...]}");
    }
    if (!all.is_array() || all.empty() || !all[0].is_object()) return all.is_object();
    const json& first = all[0];
    if (!first.contains("position")) return first.contains("vertices");
    const json& position = first["position"];
    return position.is_array() && !position.empty() && position[0].is_array();
}

}  // namespace

AskedCurve parseCurve(const std::string& text) {
    std::string words = text;
    std::replace(words.begin(), words.end(), ';', ' ');
    std::istringstream in(words);
    std::vector<AskedPoint> points;
    for (std::string word; in >> word;) {
        try {
            points.push_back(parsePoint(word));
        } catch (const Error&) {
            if (points.empty()) return {};
            throw;
        }
    }
    return curveThrough(std::move(points));
}

std::vector<AskedCurve> readAskedCurves(const std::string& file,
                                        std::vector<std::string>* warnings) {
    if (!isJson(file) || !holdsCurves(file)) return {curveThrough(readPoints(file))};
    std::vector<AskedCurve> curves;
    for (const Curve& curve : readCurves(file, warnings)) {
        curves.push_back({{}, curve.closed});
        for (const Vec3d& p : curve.points) curves.back().points.emplace_back(p);
    }
    return curves;
}

std::vector<AskedPair> readPairs(const std::string& file) {
    std::ifstream in = open(file);
    std::vector<AskedPair> pairs;
    if (isJson(file)) {
        const std::string remedy = "write [[x, y, z, x, y, z], ...] or [[vertex, vertex], ...]";
        pairs = readEntries(listFromJson(in, file, "pairs", remedy), file, remedy, pairFrom);
    } else {
        for (const auto& v :
             rowsFromText(in, file, "x,y,z,x,y,z", {2, 6}, "x,y,z,x,y,z or two vertices"))
            if (v.size() == 2)
                pairs.push_back({vertexFrom(v[0], file), vertexFrom(v[1], file)});
            else
                pairs.push_back({{v[0], v[1], v[2]}, {v[3], v[4], v[5]}});
    }
    if (pairs.empty())
        throw Error(Kind::BadInput, file + " holds no pairs",
                    "write one pair per line: x,y,z,x,y,z or two vertices");
    return pairs;
}

}  // namespace igeo
