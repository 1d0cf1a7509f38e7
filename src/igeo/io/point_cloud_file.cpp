#include <igeo/io/point_cloud_file.h>

#include <fmt/core.h>
#include <igeo/base/detail/numbers.h>
#include <igeo/base/error.h>
#include <igeo/io/detail/ply_reader.h>
#include <igeo/io/detail/vdb_points.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>

namespace igeo {

namespace {

using Kind = Error::Kind;

/// The ending in lower case, ".ply"; of FILE.vdb:GRID that of the file.
std::string endingOf(const std::string& file) {
    std::string name = std::filesystem::path(file).filename().string();
    std::transform(name.begin(), name.end(), name.begin(),
                   [](unsigned char c) { return char(std::tolower(c)); });
    if (name.find(".vdb:") != std::string::npos) return ".vdb";
    const auto dot = name.rfind('.');
    return dot == std::string::npos ? "" : name.substr(dot);
}

std::string bytesOf(const std::string& file) {
    std::error_code ignored;
    if (std::filesystem::is_directory(file, ignored))
        throw Error(Kind::Io, "cannot read '" + file + "': it is a folder", "give a file");
    errno = 0;
    std::ifstream in(file, std::ios::binary);
    std::ostringstream all;
    if (in) all << in.rdbuf();
    if (!in || in.bad())
        throw Error(Kind::Io,
                    "cannot read '" + file + "'" + (errno ? ": " : "") +
                        (errno ? std::strerror(errno) : ""),
                    "check the name and the permissions");
    return all.str();
}

/// Calls visit(line, number) for all lines, without line ends and what follows a `#`.
template <typename Visit>
void forLines(const std::string& bytes, const Visit& visit) {
    // Spreadsheets begin UTF-8 files with a byte order mark.
    std::size_t at = bytes.compare(0, 3, "\xEF\xBB\xBF") == 0 ? 3 : 0;
    for (std::size_t number = 1; at < bytes.size(); ++number) {
        const std::size_t end = std::min(bytes.find('\n', at), bytes.size());
        std::string_view line(bytes.data() + at, end - at);
        line = line.substr(0, line.find('#'));
        while (!line.empty() && std::isspace(static_cast<unsigned char>(line.back())))
            line.remove_suffix(1);
        if (!line.empty()) visit(line, number);
        at = end + 1;
    }
}

bool isSeparator(char c) { return c == ' ' || c == '\t' || c == '\r'; }

/// The numbers of a line; empty where something else is in it. Between two is a comma, a semicolon
/// or blanks; nan and inf are numbers here.
std::vector<double> numbersIn(std::string_view line) {
    std::vector<double> numbers;
    const char *at = line.data(), *const end = at + line.size();
    for (bool first = true;; first = false) {
        while (at != end && isSeparator(*at)) ++at;
        if (at == end) return numbers;
        if (!first && (*at == ',' || *at == ';')) {
            do ++at;
            while (at != end && isSeparator(*at));
        }
        if (at != end && *at == '+') ++at;
        const char* const stop =
            std::find_if(at, end, [](char c) { return isSeparator(c) || c == ',' || c == ';'; });
        const auto value = parseDouble({at, std::size_t(stop - at)});
        if (!value) return {};
        numbers.push_back(*value);
        at = stop;
    }
}

[[noreturn]] void failAt(const std::string& file, std::size_t number, std::string_view line,
                         const std::string& what) {
    throw Error(Kind::BadInput,
                fmt::format("{}, line {}: '{}' {}", file, number, line.substr(0, 60), what),
                "write x y z or x y z nx ny nz on every line, with blanks or commas between them");
}

PointCloud pointsFromText(const std::string& file, const std::string& bytes) {
    PointCloud cloud{file, {}, {}};
    bool mayBeHeader = true;
    std::size_t columns = 0;
    forLines(bytes, [&](std::string_view line, std::size_t number) {
        const std::vector<double> v = numbersIn(line);
        // A first line that does not begin like a number names the columns.
        const auto begin = line.find_first_not_of(" \t\"");
        const bool isHeader = mayBeHeader && v.empty() && begin != std::string_view::npos &&
                              std::isalpha(static_cast<unsigned char>(line[begin]));
        mayBeHeader = false;
        if (isHeader) return;
        if (v.size() != 3 && v.size() != 6)
            failAt(file, number, line, "is neither x y z nor x y z nx ny nz");
        if (columns != 0 && v.size() != columns)
            failAt(file, number, line,
                   fmt::format("has {} numbers, the lines before have {}", v.size(), columns));
        columns = v.size();
        cloud.points.push_back({v[0], v[1], v[2]});
        if (columns == 6) cloud.normals.push_back(Vec3f(Vec3d{v[3], v[4], v[5]}));
    });
    return cloud;
}

PointCloud pointsFromObj(const std::string& file, const std::string& bytes) {
    PointCloud cloud{file, {}, {}};
    forLines(bytes, [&](std::string_view line, std::size_t number) {
        const bool isNormal = line.substr(0, 3) == "vn ";
        if (!isNormal && line.substr(0, 2) != "v ") return;
        // A weight or a color may follow the position.
        const std::vector<double> v = numbersIn(line.substr(isNormal ? 3 : 2));
        if (v.size() < 3) failAt(file, number, line, "does not hold three numbers");
        if (isNormal)
            cloud.normals.push_back(Vec3f(Vec3d{v[0], v[1], v[2]}));
        else
            cloud.points.push_back({v[0], v[1], v[2]});
    });
    // Faces say which normal belongs to which vertex; without them only the order does.
    if (cloud.normals.size() != cloud.points.size()) cloud.normals.clear();
    return cloud;
}

PointCloud pointsFromPly(const std::string& file, const std::string& bytes) {
    Ply ply = readPlyPoints(file, bytes);
    return {file, std::move(ply.points), std::move(ply.normals)};
}

}  // namespace

bool isPointFile(const std::string& file) {
    const std::string ending = endingOf(file);
    return ending == ".xyz" || ending == ".txt" || ending == ".csv" || ending == ".pts" ||
           ending == ".asc";
}

PointCloud readPointCloud(const std::string& file) {
    const std::string ending = endingOf(file);
    PointCloud cloud;
    if (ending == ".vdb")
        cloud = readVdbPoints(file);
    else if (ending == ".ply")
        cloud = pointsFromPly(file, bytesOf(file));
    else if (ending == ".obj")
        cloud = pointsFromObj(file, bytesOf(file));
    else if (isPointFile(file))
        cloud = pointsFromText(file, bytesOf(file));
    else
        throw Error(Kind::BadInput, file + ": '" + ending + "' is no ending of a cloud of points",
                    "give a .ply, .xyz, .csv, .txt, .obj or .vdb file");
    requireUsable(cloud);
    return cloud;
}

}  // namespace igeo
