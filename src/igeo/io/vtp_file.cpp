#include <igeo/io/vtp_file.h>

#include <fmt/core.h>
#include <igeo/base/detail/deflate.h>
#include <igeo/base/error.h>
#include <igeo/base/parallel.h>
#include <igeo/io/detail/little_endian.h>

#include <algorithm>

namespace igeo {

namespace {

/// Collects the XML text of the arrays and, separately, their bytes.
class Appender {
public:
    void add(const std::string& name, const char* type, int components, const std::string& bytes) {
        xml_ += fmt::format(
            "<DataArray type=\"{}\" Name=\"{}\" NumberOfComponents=\"{}\" format=\"appended\" "
            "offset=\"{}\"/>\n",
            type, name, components, appended_.size());
        append(bytes);
    }
    void open(const std::string& element) { xml_ += '<' + element + ">\n"; }
    void close(const char* element) { xml_ += fmt::format("</{}>\n", element); }
    const std::string& xml() const { return xml_; }
    const std::string& appended() const { return appended_; }

private:
    /// VTK's layout: number of blocks, their size, the size of a shorter last one, the compressed
    /// sizes, the blocks.
    void append(std::string_view bytes) {
        constexpr std::size_t kBlock = 1 << 20;
        std::vector<std::string> blocks((bytes.size() + kBlock - 1) / kBlock);
        parallelFor(blocks.size(), 1, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i)
                blocks[i] = deflated(bytes.substr(i * kBlock, kBlock));
        });
        for (const std::size_t n : {blocks.size(), kBlock, bytes.size() % kBlock}) put(n);
        for (const std::string& block : blocks) put(block.size());
        for (const std::string& block : blocks) appended_ += block;
    }
    void put(std::size_t n) { putLittleEndian(appended_, std::uint64_t(n)); }

    std::string xml_, appended_;
};

template <typename T, typename Values>
std::string bytesAs(const Values& values) {
    std::string bytes;
    bytes.reserve(values.size() * sizeof(T));
    for (const auto& value : values) putLittleEndian(bytes, T(value));
    return bytes;
}

void addPoints(Appender& out, const std::vector<Vec3d>& points) {
    std::vector<double> flat;
    flat.reserve(3 * points.size());
    for (const Vec3d& p : points) flat.insert(flat.end(), {p.x, p.y, p.z});
    const bool single =
        std::all_of(flat.begin(), flat.end(), [](double x) { return double(float(x)) == x; });
    out.open("Points");
    if (single)
        out.add("Points", "Float32", 3, bytesAs<float>(flat));
    else
        out.add("Points", "Float64", 3, bytesAs<double>(flat));
    out.close("Points");
}

void addCells(Appender& out, const char* element, const Cells& cells) {
    out.open(element);
    out.add("connectivity", "Int64", 1, bytesAs<std::int64_t>(cells.members));
    out.add("offsets", "Int64", 1, bytesAs<std::int64_t>(cells.ends));
    out.close(element);
}

void requireFits(const PointData& data, std::size_t n) {
    if (data.name.find_first_of("<>&\"") != data.name.npos || data.components < 1 ||
        data.values.size() != n * std::size_t(data.components))
        throw Error(
            Error::Kind::InvalidArgument,
            fmt::format("the data '{}' has {} values in {} components for {} points or cells",
                        data.name, data.values.size(), data.components, n));
}

void addValues(Appender& out, const PointData& data, std::size_t n) {
    requireFits(data, n);
    switch (data.type) {
        case PointData::Type::Float32:
            return out.add(data.name, "Float32", data.components, bytesAs<float>(data.values));
        case PointData::Type::Float64:
            return out.add(data.name, "Float64", data.components, bytesAs<double>(data.values));
        case PointData::Type::Int32:
            return out.add(data.name, "Int32", data.components, bytesAs<std::int32_t>(data.values));
    }
}

void addPointData(Appender& out, const PolyData& shape) {
    const bool scalars = !shape.data.empty() && shape.data.front().components == 1;
    out.open(scalars ? fmt::format("PointData Scalars=\"{}\"", shape.data.front().name)
                     : "PointData");
    for (const PointData& data : shape.data) addValues(out, data, shape.points.size());
    out.close("PointData");
}

/// VTK numbers the cells of a file: lines first, then polygons. An array of one kind is padded for
/// the other.
void addCellData(Appender& out, const PolyData& shape) {
    const std::size_t lines = shape.lines.size(), polygons = shape.polygons.size();
    out.open("CellData");
    for (PointData data : shape.lineData) {
        requireFits(data, lines);
        data.values.resize((lines + polygons) * std::size_t(data.components));
        addValues(out, data, lines + polygons);
    }
    for (PointData data : shape.faceData) {
        requireFits(data, polygons);
        data.values.insert(data.values.begin(), lines * std::size_t(data.components), 0.0);
        addValues(out, data, lines + polygons);
    }
    out.close("CellData");
}

}  // namespace

std::string vtp(const PolyData& shape) {
    Appender out;
    out.open(
        fmt::format("Piece NumberOfPoints=\"{}\" NumberOfVerts=\"0\" NumberOfLines=\"{}\" "
                    "NumberOfStrips=\"0\" NumberOfPolys=\"{}\"",
                    shape.points.size(), shape.lines.size(), shape.polygons.size()));
    addPointData(out, shape);
    addCellData(out, shape);
    addPoints(out, shape.points);
    addCells(out, "Lines", shape.lines);
    addCells(out, "Polys", shape.polygons);
    out.close("Piece");
    return "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" version=\"1.0\" "
           "byte_order=\"LittleEndian\" header_type=\"UInt64\" "
           "compressor=\"vtkZLibDataCompressor\">\n<PolyData>\n" +
           out.xml() + "</PolyData>\n<AppendedData encoding=\"raw\">\n_" + out.appended() +
           "\n</AppendedData>\n</VTKFile>\n";
}

}  // namespace igeo
