#include <igeo/io/point_cloud_file.h>

#include <fmt/core.h>
#include <igeo/base/detail/text.h>
#include <igeo/base/error.h>
#include <igeo/io/detail/file_bytes.h>
#include <igeo/io/detail/number_lines.h>
#include <igeo/io/detail/number_rows.h>
#include <igeo/io/detail/ply_reader.h>
#include <igeo/io/detail/vdb_points.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>

namespace igeo {

namespace {

using Kind = Error::Kind;

/// The ending in lower case, ".ply"; that of the file in FILE.vdb:GRID.
std::string endingOf(const std::string& file) {
    const std::string name = lowerCase(std::filesystem::path(file).filename().string());
    if (name.find(".vdb:") != std::string::npos) return ".vdb";
    const auto dot = name.rfind('.');
    return dot == std::string::npos ? "" : name.substr(dot);
}

[[noreturn]] void failAt(const std::string& file, std::size_t number, std::string_view line,
                         const std::string& what) {
    throw Error(Kind::BadInput,
                fmt::format("{}, line {}: '{}' {}", file, number, line.substr(0, 60), what),
                "write x y z or x y z nx ny nz on every line, with blanks or commas between them; "
                "colors are skipped where a first line names the columns, as x y z r g b");
}

/// The columns of a text of points: without a header those of its lines.
class PointColumns {
public:
    void name(std::size_t number, std::string_view header) {
        const std::vector<std::string> names = namesInHeader(header);
        number_ = number;
        skipped_ = extraColumns(names);
        for (std::size_t k = 0; k < names.size(); ++k)
            if (!skipped_[k]) read_ += (read_.empty() ? "" : ",") + names[k];
        if (!skipsAny()) read_ = header;
        hasNormals_ = std::find(names.begin(), names.end(), "nx") != names.end();
    }
    /// @param numbers  of a line that are read
    /// @throws Error  as requireColumns, for the columns that are read
    void require(const std::string& file, std::size_t numbers) const {
        requireColumns(file, number_, read_, "x,y,z,nx,ny,nz", numbers);
    }
    bool skipsAny() const {
        return std::find(skipped_.begin(), skipped_.end(), true) != skipped_.end();
    }
    std::size_t named() const { return skipped_.size(); }
    /// Whether a header says that columns 4 to 6 are normals, of any length.
    bool hasNormals() const { return hasNormals_; }
    /// The numbers of a line that are read.
    std::vector<double> of(const std::vector<double>& line) const {
        std::vector<double> read;
        for (std::size_t k = 0; k < line.size(); ++k)
            if (!skipped_[k]) read.push_back(line[k]);
        return read;
    }

private:
    std::size_t number_ = 0;     ///< the line of the header
    std::string read_;           ///< the header, or the names of the columns that are read
    std::vector<bool> skipped_;  ///< by the header; empty: there is none
    bool hasNormals_ = false;
};

/// Whether a vector can be a normal in a column without a name. Zero and NaN are refused later.
bool mayBeNormal(const Vec3d& v) {
    constexpr double kRounded = 0.1;  // of numbers with one digit
    const double size = length(v);
    return std::abs(size - 1) <= kRounded || !(size > 0 && size < kInfinity);
}

PointCloud pointsFromText(const std::string& file, const std::string& bytes) {
    PointCloud cloud{file, {}, {}};
    PointColumns columns;
    bool mayBeHeader = true;
    std::size_t count = 0;
    forLines(bytes, [&](std::string_view line, std::size_t number) {
        std::vector<double> v = numbersIn(file, number, line);
        // A first line that does not start like a number names the columns.
        const auto begin = line.find_first_not_of(" \t\"/");
        const bool isHeader = mayBeHeader && v.empty() && begin != std::string_view::npos &&
                              std::isalpha(static_cast<unsigned char>(line[begin]));
        mayBeHeader = false;
        if (isHeader) return columns.name(number, line);
        if (columns.skipsAny()) {
            if (v.size() != columns.named())
                failAt(file, number, line,
                       fmt::format("does not hold {} numbers, one for each name of the first line",
                                   columns.named()));
            v = columns.of(v);
        }
        if (count == 0) columns.require(file, v.size());
        if (v.size() != 3 && v.size() != 6)
            failAt(file, number, line, "is neither x y z nor x y z nx ny nz");
        if (count != 0 && v.size() != count)
            failAt(file, number, line,
                   fmt::format("has {} numbers, the lines before have {}", v.size(), count));
        count = v.size();
        cloud.points.push_back({v[0], v[1], v[2]});
        if (count == 3) return;
        const Vec3d normal(v[3], v[4], v[5]);
        if (!columns.hasNormals() && !mayBeNormal(normal))
            failAt(file, number, line,
                   fmt::format("has no name for columns 4 to 6, which are read as a normal, and "
                               "the length of this one is {:.4g}, not 1",
                               length(normal)));
        cloud.normals.push_back(Vec3f(normal));
    });
    return cloud;
}

/// A .pwn file: the number of points, then all positions, then all normals; or both on each line.
PointCloud pointsFromPwn(const std::string& file, const std::string& bytes) {
    PointCloud cloud{file, {}, {}};
    std::vector<Vec3d> rows;
    double count = -1;
    forLines(bytes, [&](std::string_view line, std::size_t number) {
        const std::vector<double> v = numbersIn(file, number, line);
        if (rows.empty() && count < 0 && v.size() == 1 && v[0] >= 0) {
            count = v[0];
        } else if (v.size() == (count < 0 ? 6u : 3u)) {
            rows.push_back({v[0], v[1], v[2]});
            if (count < 0) cloud.normals.push_back(Vec3f(Vec3d{v[3], v[4], v[5]}));
        } else {
            failAt(file, number, line, count < 0 ? "is not x y z nx ny nz" : "is not x y z");
        }
    });
    if (count >= 0 && double(rows.size()) != 2 * count)
        throw Error(
            Kind::BadInput,
            fmt::format("'{}' announces {} points and as many normals, and holds {} of both", file,
                        count, rows.size()),
            "the file is cut off or broken: write it again");
    const std::size_t points = count < 0 ? rows.size() : rows.size() / 2;
    cloud.points.assign(rows.begin(), rows.begin() + std::ptrdiff_t(points));
    for (std::size_t k = points; k < rows.size(); ++k) cloud.normals.push_back(Vec3f(rows[k]));
    return cloud;
}

PointCloud pointsFromObj(const std::string& file, const std::string& bytes) {
    PointCloud cloud{file, {}, {}};
    forLines(bytes, [&](std::string_view line, std::size_t number) {
        constexpr std::string_view kBlanks = " \t\v\f";
        line.remove_prefix(std::min(line.find_first_not_of(kBlanks), line.size()));
        const std::string_view key = line.substr(0, line.find_first_of(kBlanks));
        const bool isNormal = key == "vn";
        if (!isNormal && key != "v") return;
        // A weight or a color may follow the position.
        const std::vector<double> v = numbersIn(file, number, line.substr(key.size()));
        if (v.size() < 3) failAt(file, number, line, "does not hold three numbers");
        if (isNormal)
            cloud.normals.push_back(Vec3f(Vec3d{v[0], v[1], v[2]}));
        else
            cloud.points.push_back({v[0], v[1], v[2]});
    });
    // Only faces assign normals to vertices; without them the order is the only hint.
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
           ending == ".asc" || ending == ".pwn";
}

PointCloud readPointCloud(const std::string& file) {
    const std::string ending = endingOf(file);
    PointCloud cloud;
    if (ending == ".vdb")
        cloud = readVdbPoints(file);
    else if (ending == ".ply")
        cloud = pointsFromPly(file, fileBytes(file));
    else if (ending == ".obj")
        cloud = pointsFromObj(file, fileBytes(file));
    else if (ending == ".pwn")
        cloud = pointsFromPwn(file, fileBytes(file));
    else if (isPointFile(file))
        cloud = pointsFromText(file, fileBytes(file));
    else {
        fileBytes(file);  // of a file that does not exist its ending does not matter
        throw Error(Kind::BadInput, file + ": '" + ending + "' is no ending of a cloud of points",
                    "give a .ply, .xyz, .csv, .txt, .pts, .asc, .pwn, .obj or .vdb file");
    }
    requireUsable(cloud);
    return cloud;
}

}  // namespace igeo
