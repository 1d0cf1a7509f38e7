#include <igeo/results/vertex_values.h>

#include <fmt/core.h>
#include <igeo/base/detail/deflate.h>
#include <igeo/io/detail/base64.h>
#include <igeo/io/detail/little_endian.h>
#include <igeo/io/vtp_file.h>
#include <igeo/results/detail/npy.h>
#include <igeo/results/detail/ply_writer.h>
#include <igeo/results/refined_mesh.h>

#include <algorithm>
#include <limits>
#include <utility>

namespace igeo {

namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

std::vector<std::int32_t> labelNumbers(const VertexValues& values) {
    std::vector<std::int32_t> numbers;
    numbers.reserve(values.label.size());
    for (const std::uint32_t label : values.label)
        numbers.push_back(label == kNoLabel ? -1 : std::int32_t(label));
    return numbers;
}

/// The columns as the rows of an array.
std::vector<double> rowsOf(const std::vector<VertexColumn>& columns, std::size_t vertices) {
    std::vector<double> rows;
    rows.reserve(vertices * columns.size());
    for (std::size_t v = 0; v < vertices; ++v)
        for (const VertexColumn& column : columns) rows.push_back(column.distance[v]);
    return rows;
}

std::string npyOfColumns(const VertexValues& values) {
    const std::size_t n = values.distance.size(), columns = values.columns.size();
    return npy(rowsOf(values.columns, n), fmt::format("({}, {})", n, columns));
}

double orMinusOne(double distance) { return distance < kInfinity ? distance : -1; }

std::vector<double> orNaN(std::vector<double> distance) {
    for (double& d : distance)
        if (!(d < kInfinity)) d = kNaN;
    return distance;
}

/// A data array of a GIFTI file with `value` at each vertex.
template <typename Value>
std::string giftiArray(const char* intent, const std::string& name, std::size_t vertices,
                       const Value& value) {
    std::string bytes;
    bytes.reserve(4 * vertices);
    for (std::size_t v = 0; v < vertices; ++v) putLittleEndian(bytes, float(value(v)));
    return fmt::format(
        "<DataArray Intent=\"{}\" DataType=\"NIFTI_TYPE_FLOAT32\" "
        "ArrayIndexingOrder=\"RowMajorOrder\" Dimensionality=\"1\" Dim0=\"{}\" "
        "Encoding=\"GZipBase64Binary\" Endian=\"LittleEndian\" ExternalFileName=\"\" "
        "ExternalFileOffset=\"\">\n"
        "<MetaData><MD><Name><![CDATA[Name]]></Name><Value><![CDATA[{}]]></Value></MD></MetaData>\n"
        "<Data>{}</Data>\n</DataArray>\n",
        intent, vertices, name, base64(deflated(bytes)));
}

}  // namespace

PolygonMesh polygonsOf(const TriangleMesh& mesh) {
    if (mesh.source) return *mesh.source;
    PolygonMesh polygons;
    polygons.vertices = mesh.points;
    for (const TriangleMesh::Triangle& t : mesh.triangles) polygons.addFace(t);
    return polygons;
}

VertexReader::VertexReader(const TriangleMesh& mesh, const Similarity& transform)
    : mesh_(meshAsGiven(mesh, transform)) {
    if (mesh.source) {
        pointOfVertex_ = mesh.pointOfVertex;
        return;
    }
    for (std::uint32_t p = 0; p < mesh.points.size(); ++p) pointOfVertex_.push_back(p);
}

VertexValues VertexReader::read(const Field& field, Progress& progress) const {
    SurfaceMesh at = mesh_;
    sampleField(at, field, progress);
    finish(at, field);
    const std::size_t n = pointOfVertex_.size();
    VertexValues values{std::vector<double>(n, kNaN), std::vector<std::uint32_t>(n, kNoLabel)};
    for (std::size_t v = 0; v < n; ++v) {
        const std::uint32_t p = pointOfVertex_[v];
        if (p == TriangleMesh::kNoPoint) continue;
        values.distance[v] = at.distance[p] * field.band->transform.dx;
        values.label[v] = at.label[p];
    }
    return values;
}

VertexValues vertexValues(const TriangleMesh& mesh, const Field& field, Progress& progress) {
    return VertexReader(mesh, field.band->transform).read(field, progress);
}

std::string verticesCsv(const VertexValues& values) {
    std::string text = "vertex,distance,label";
    for (const VertexColumn& column : values.columns) text += "," + column.name;
    text += "\n";
    const std::vector<std::int32_t> label = labelNumbers(values);
    for (std::size_t v = 0; v < values.distance.size(); ++v) {
        text += fmt::format("{},{},{}", v, values.distance[v], label[v]);
        for (const VertexColumn& column : values.columns)
            text += fmt::format(",{}", column.distance[v]);
        text += "\n";
    }
    return text;
}

std::string verticesNpy(const VertexValues& values) {
    return values.columns.empty()
               ? npy(values.distance, fmt::format("({},)", values.distance.size()))
               : npyOfColumns(values);
}

std::string verticesNpz(const VertexValues& values) {
    const std::string shape = fmt::format("({},)", values.distance.size());
    std::vector<std::pair<std::string, std::string>> arrays{
        {"distance", npy(values.distance, shape)}, {"label", npy(labelNumbers(values), shape)}};
    if (!values.columns.empty()) arrays.emplace_back("distances", npyOfColumns(values));
    return npz(arrays);
}

std::string verticesPly(const PolygonMesh& mesh, const VertexValues& values, const Color& color) {
    PlyWriter ply("geodesic distance, world units; -1: not reached, or no face uses the vertex",
                  mesh.vertices.size());
    ply.addPositions([&](std::size_t v) { return mesh.vertices[v]; });
    ply.addColors(colorsOf(values.distance, color));
    ply.addDistances(values.distance, labelNumbers(values));
    for (const VertexColumn& column : values.columns)
        ply.add(PlyProperty::Type::Float, column.name,
                [&column](std::size_t v) { return orMinusOne(column.distance[v]); });
    return ply.bytes(mesh.faces(), [&](std::size_t f) { return mesh.face(f); });
}

std::string verticesObj(const PolygonMesh& mesh, const VertexValues& values, const Color& color) {
    std::string text = "# colors are shares of the largest geodesic distance\n";
    const std::vector<Vec3f> colors = colorsOf(values.distance, color);
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
        const Vec3d& p = mesh.vertices[v];
        const Vec3f& c = colors[v];
        text += fmt::format("v {} {} {} {:.4g} {:.4g} {:.4g}\n", p.x, p.y, p.z, c.x, c.y, c.z);
    }
    for (std::size_t f = 0; f < mesh.faces(); ++f) {
        text += "f";
        for (const std::uint32_t v : mesh.face(f)) text += fmt::format(" {}", v + 1);
        text += "\n";
    }
    return text;
}

std::string verticesVtp(const PolygonMesh& mesh, const VertexValues& values) {
    using Type = PointData::Type;
    const std::vector<std::int32_t> label = labelNumbers(values);
    PolyData shape;
    shape.points = mesh.vertices;
    shape.polygons = {mesh.corners, mesh.faceEnd};
    shape.data = {{"distance", orNaN(values.distance), 1, Type::Float64},
                  {"label", {label.begin(), label.end()}, 1, Type::Int32}};
    for (const VertexColumn& column : values.columns)
        shape.data.push_back({column.name, orNaN(column.distance), 1, Type::Float64});
    return vtp(shape);
}

std::string verticesGifti(const VertexValues& values) {
    const std::size_t n = values.distance.size();
    const std::vector<std::int32_t> label = labelNumbers(values);
    std::string xml = fmt::format(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
        "<GIFTI Version=\"1.0\" NumberOfDataArrays=\"{}\">\n<MetaData/>\n<LabelTable/>\n",
        2 + values.columns.size());
    const char *const kShape = "NIFTI_INTENT_SHAPE", *const kNone = "NIFTI_INTENT_NONE";
    auto add = [&](const std::string& name, const std::vector<double>& distance) {
        xml += giftiArray(kShape, name, n, [&](std::size_t v) { return orMinusOne(distance[v]); });
    };
    add("distance", values.distance);
    xml += giftiArray(kNone, "label", n, [&](std::size_t v) { return label[v]; });
    for (const VertexColumn& column : values.columns) add(column.name, column.distance);
    return xml + "</GIFTI>\n";
}

}  // namespace igeo
