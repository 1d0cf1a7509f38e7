#include <igeo/results/vertex_values.h>

#include <fmt/core.h>
#include <igeo/io/detail/little_endian.h>
#include <igeo/results/detail/npy.h>
#include <igeo/results/refined_mesh.h>

#include <algorithm>
#include <limits>

namespace igeo {

namespace {

bool reached(double distance) { return distance < kInfinity; }

/// Of vertices that are not reached it is gray.
std::vector<Vec3f> colorsOf(const VertexValues& values, const Color& color) {
    double largest = 0;
    for (const double d : values.distance)
        if (reached(d)) largest = std::max(largest, d);
    std::vector<Vec3f> colors(values.distance.size(), Vec3f{0.5f, 0.5f, 0.5f});
    for (std::size_t v = 0; v < colors.size(); ++v)
        if (const double d = values.distance[v]; reached(d))
            colors[v] = color(largest > 0 ? std::max(d, 0.0) / largest : 0.0);
    return colors;
}

std::int32_t labelNumber(std::uint32_t label) {
    return label == kNoLabel ? -1 : std::int32_t(label);
}

}  // namespace

PolygonMesh polygonsOf(const TriangleMesh& mesh) {
    if (mesh.source) return *mesh.source;
    PolygonMesh polygons;
    polygons.vertices = mesh.points;
    for (const TriangleMesh::Triangle& t : mesh.triangles) polygons.addFace(t);
    return polygons;
}

VertexValues vertexValues(const TriangleMesh& mesh, const Field& field, Progress& progress) {
    // Without cuts: its points are those of the mesh, in their order.
    const SurfaceMesh at = refinedMesh(mesh, field, kInfinity, progress);
    const std::size_t n = mesh.source ? mesh.source->vertices.size() : mesh.points.size();
    VertexValues values{std::vector<double>(n, std::numeric_limits<double>::quiet_NaN()),
                        std::vector<std::uint32_t>(n, kNoLabel)};
    for (std::size_t v = 0; v < n; ++v) {
        const std::uint32_t p = mesh.source ? mesh.pointOfVertex[v] : std::uint32_t(v);
        if (p == TriangleMesh::kNoPoint) continue;
        values.distance[v] = at.distance[p] * field.band->transform.dx;
        values.label[v] = at.label[p];
    }
    return values;
}

std::string verticesCsv(const VertexValues& values) {
    std::string text = "vertex,distance,label\n";
    for (std::size_t v = 0; v < values.distance.size(); ++v)
        text += fmt::format("{},{},{}\n", v, values.distance[v], labelNumber(values.label[v]));
    return text;
}

std::string verticesNpy(const VertexValues& values) {
    return npy(values.distance, fmt::format("({},)", values.distance.size()));
}

std::string verticesPly(const PolygonMesh& mesh, const VertexValues& values, const Color& color) {
    const bool isSingle = std::all_of(mesh.vertices.begin(), mesh.vertices.end(),
                                      [](const Vec3d& p) { return Vec3d(Vec3f(p)) == p; });
    std::size_t most = 0;
    for (std::size_t f = 0; f < mesh.faces(); ++f) most = std::max(most, mesh.face(f).size());
    const bool isShort = most < 256;
    std::string bytes = fmt::format(
        "ply\n"
        "format binary_little_endian 1.0\n"
        "comment geodesic distance, world units; -1: not reached, or no face uses the vertex\n"
        "element vertex {0}\n"
        "property {1} x\nproperty {1} y\nproperty {1} z\n"
        "property uchar red\nproperty uchar green\nproperty uchar blue\n"
        "property float distance\nproperty float quality\nproperty int label\n"
        "element face {2}\n"
        "property list {3} int vertex_indices\n"
        "end_header\n",
        mesh.vertices.size(), isSingle ? "float" : "double", mesh.faces(),
        isShort ? "uchar" : "int");
    const std::vector<Vec3f> colors = colorsOf(values, color);
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
        for (int k = 0; k < 3; ++k)
            if (isSingle)
                putLittleEndian(bytes, float(mesh.vertices[v][k]));
            else
                putLittleEndian(bytes, mesh.vertices[v][k]);
        for (int k = 0; k < 3; ++k)
            putLittleEndian(bytes, std::uint8_t(std::clamp(colors[v][k], 0.0f, 1.0f) * 255 + 0.5f));
        const float d = reached(values.distance[v]) ? float(values.distance[v]) : -1.0f;
        putLittleEndian(bytes, d);
        putLittleEndian(bytes, d);
        putLittleEndian(bytes, labelNumber(values.label[v]));
    }
    for (std::size_t f = 0; f < mesh.faces(); ++f) {
        const auto face = mesh.face(f);
        if (isShort)
            putLittleEndian(bytes, std::uint8_t(face.size()));
        else
            putLittleEndian(bytes, std::int32_t(face.size()));
        for (const std::uint32_t v : face) putLittleEndian(bytes, std::int32_t(v));
    }
    return bytes;
}

std::string verticesObj(const PolygonMesh& mesh, const VertexValues& values, const Color& color) {
    std::string text = "# colors are shares of the largest geodesic distance\n";
    const std::vector<Vec3f> colors = colorsOf(values, color);
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

}  // namespace igeo
