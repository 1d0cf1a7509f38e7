#include <igeo/point_file.h>

#include <igeo/error.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

namespace igeo {

namespace {

using Kind = Error::Kind;
using nlohmann::json;

/// A first line in which no field begins like a number names the columns.
bool isHeader(const std::string& line) {
    std::stringstream parts(line);
    for (std::string part; std::getline(parts, part, ',');) {
        char* end = nullptr;
        std::strtod(part.c_str(), &end);
        if (end != part.c_str()) return false;
    }
    return true;
}

std::vector<AskedPoint> pointsFromText(std::istream& in, const std::string& file) {
    std::vector<AskedPoint> points;
    std::size_t lineNumber = 0;
    bool mayBeHeader = true;
    for (std::string line; std::getline(in, line);) {
        ++lineNumber;
        // Spreadsheets begin UTF-8 files with a byte order mark.
        if (lineNumber == 1 && line.compare(0, 3, "\xEF\xBB\xBF") == 0) line.erase(0, 3);
        if (const auto hash = line.find('#'); hash != std::string::npos) line.erase(hash);
        if (line.find_first_not_of(" \t\r") == std::string::npos) continue;
        const std::vector<double> v = parseNumbers(line);
        if (v.size() == 3 || v.size() == 4)
            points.push_back({{v[0], v[1], v[2]}, v.size() == 4 ? v[3] : 0.0});
        else if (!mayBeHeader || !isHeader(line))
            throw Error(Kind::BadInput,
                        file + ", line " + std::to_string(lineNumber) + ": '" + line +
                            "' is not x,y,z or x,y,z,start",
                        "write three or four finite numbers with commas between them");
        mayBeHeader = false;
    }
    return points;
}

/// @throws std::invalid_argument
Vec3d positionFrom(const json& j) {
    if (!j.is_array() || j.size() != 3) throw std::invalid_argument("a position is [x, y, z]");
    Vec3d p;
    for (int a = 0; a < 3; ++a) {
        if (!j[std::size_t(a)].is_number()) throw std::invalid_argument("coordinates are numbers");
        p[a] = j[std::size_t(a)].get<double>();
        if (!std::isfinite(p[a])) throw std::invalid_argument("coordinates are finite");
    }
    return p;
}

/// @throws std::invalid_argument
AskedPoint pointFrom(const json& j) {
    if (!j.is_object()) return {positionFrom(j), 0};
    if (!j.contains("position")) throw std::invalid_argument("there is no \"position\"");
    AskedPoint p{positionFrom(j["position"]), 0};
    if (j.contains("start")) {
        if (!j["start"].is_number()) throw std::invalid_argument("\"start\" is a number");
        p.start = j["start"].get<double>();
    }
    return p;
}

std::vector<AskedPoint> pointsFromJson(std::istream& in, const std::string& file) {
    const json all = json::parse(in, nullptr, /*allow_exceptions=*/false);
    const std::string remedy =
        R"(write [[x, y, z], ...] or [{"position": [x, y, z], "start": s}, ...])";
    if (!all.is_array())
        throw Error(Kind::BadInput, file + " is not a JSON list of points", remedy);
    std::vector<AskedPoint> points;
    for (const json& j : all) {
        try {
            points.push_back(pointFrom(j));
        } catch (const std::invalid_argument& e) {
            throw Error(Kind::BadInput,
                        file + ", entry " + std::to_string(points.size()) + ": " + e.what(),
                        remedy);
        }
    }
    return points;
}

bool endsWith(const std::string& s, const std::string& end) {
    return s.size() >= end.size() && s.compare(s.size() - end.size(), end.size(), end) == 0;
}

}  // namespace

std::vector<double> parseNumbers(const std::string& text) {
    std::vector<double> out;
    std::stringstream parts(text);
    for (std::string part; std::getline(parts, part, ',');) {
        // strtod also reads "nan" and "1x": both are refused here.
        char* end = nullptr;
        const double v = std::strtod(part.c_str(), &end);
        const bool blank = part.find_first_not_of(" \t\r") == std::string::npos;
        while (*end == ' ' || *end == '\t' || *end == '\r') ++end;
        if (blank || *end != '\0' || !std::isfinite(v)) return {};
        out.push_back(v);
    }
    if (!text.empty() && text.back() == ',') return {};
    return out;
}

AskedPoint parsePoint(const std::string& text) {
    const std::vector<double> v = parseNumbers(text);
    if (v.size() != 3)
        throw Error(Kind::InvalidArgument, "'" + text + "' is not a point",
                    "write three finite numbers with commas between them, as in 0.1,0.2,0.3");
    return {{v[0], v[1], v[2]}, 0};
}

std::vector<AskedPoint> readPoints(const std::string& file) {
    errno = 0;
    std::ifstream in(file, std::ios::binary);
    if (!in)
        throw Error(Kind::Io, "cannot read '" + file + "': " + std::strerror(errno),
                    "check the name and the permissions");
    if (std::filesystem::is_directory(file))
        throw Error(Kind::Io, "cannot read '" + file + "': it is a folder",
                    "give a .json or .csv file");
    auto points = endsWith(file, ".json") ? pointsFromJson(in, file) : pointsFromText(in, file);
    if (points.empty())
        throw Error(Kind::BadInput, file + " holds no points",
                    "write one point per line: x,y,z or x,y,z,start");
    for (const AskedPoint& p : points)
        if (!(p.start >= 0 && std::isfinite(p.start)))
            throw Error(Kind::BadInput,
                        file + ": start value " + std::to_string(p.start) + " is negative",
                        "start values are distances: finite and at least 0");
    return points;
}

}  // namespace igeo
