#include <igeo/results/surface_files.h>

#include <fmt/core.h>
#include <igeo/base/detail/box.h>
#include <igeo/base/detail/single.h>
#include <igeo/io/vtp_file.h>
#include <igeo/results/detail/glb.h>
#include <igeo/results/detail/ply_writer.h>

#include <limits>
#include <utility>

namespace igeo {

namespace {

std::vector<std::int32_t> labelsOf(const SurfaceMesh& mesh) {
    std::vector<std::int32_t> labels;
    labels.reserve(mesh.label.size());
    for (const std::uint32_t label : mesh.label)
        labels.push_back(label == kNoLabel ? -1 : std::int32_t(label));
    return labels;
}

std::vector<double> flat(const std::vector<Vec3f>& vectors) {
    std::vector<double> numbers;
    numbers.reserve(3 * vectors.size());
    for (const Vec3f& v : vectors) numbers.insert(numbers.end(), {v.x, v.y, v.z});
    return numbers;
}

/// Rounding that results do not notice, voxels.
constexpr double kNoticed = 1e-3;

/// Where a node holds the mesh so that single precision suffices for its vertices: at the origin if
/// it does anyway, else in the middle of the mesh, rounded to single precision itself.
Vec3d placeOf(const std::vector<Vec3d>& positions, double noticed) {
    const auto position = [&](std::size_t v) { return positions[v]; };
    if (isSingle(positions.size(), position, noticed)) return {};
    const Box box(positions);
    return inSingle(0.5 * (box.low + box.high));
}

}  // namespace

std::string surfacePly(const SurfaceMesh& given, const Similarity& transform, const Color& color) {
    const SurfaceMesh mesh = inWorld(given, transform);
    PlyWriter ply("geodesic distance, world units; -1: not reached", mesh.position.size());
    using Type = PlyProperty::Type;
    ply.addPositions([&](std::size_t v) { return mesh.position[v]; }, kNoticed * transform.dx);
    ply.addVector(Type::Float, {"nx", "ny", "nz"},
                  [&](std::size_t v) { return Vec3d(mesh.normal[v]); });
    ply.addColors(colorsOf(mesh.distance, color));
    ply.addDistances(mesh.distance, labelsOf(mesh));
    return ply.bytes(mesh.triangles.size(), [&](std::size_t f) {
        return std::span<const std::uint32_t>(mesh.triangles[f]);
    });
}

std::string surfaceObj(const SurfaceMesh& given, const Similarity& transform, const Color& color) {
    const SurfaceMesh mesh = inWorld(given, transform);
    std::string text = "# surface, world units; colors are shares of the largest distance\n";
    const std::vector<Vec3f> colors = colorsOf(mesh.distance, color);
    for (std::size_t v = 0; v < mesh.position.size(); ++v) {
        const Vec3d& p = mesh.position[v];
        const Vec3f& c = colors[v];
        text += fmt::format("v {:.12g} {:.12g} {:.12g} {:.4g} {:.4g} {:.4g}\n", p.x, p.y, p.z, c.x,
                            c.y, c.z);
    }
    for (const auto& [a, b, c] : mesh.triangles)
        text += fmt::format("f {} {} {}\n", a + 1, b + 1, c + 1);
    return text;
}

std::string surfaceVtp(const SurfaceMesh& given, const Similarity& transform) {
    using Type = PointData::Type;
    SurfaceMesh mesh = inWorld(given, transform);
    for (double& d : mesh.distance)
        if (!(d < kInfinity)) d = std::numeric_limits<double>::quiet_NaN();
    const std::vector<std::int32_t> labels = labelsOf(mesh);
    PolyData shape;
    shape.points = std::move(mesh.position);
    for (const SurfaceMesh::Triangle& t : mesh.triangles) {
        shape.polygons.members.insert(shape.polygons.members.end(), t.begin(), t.end());
        shape.polygons.ends.push_back(shape.polygons.members.size());
    }
    shape.data = {{"distance", std::move(mesh.distance), 1, Type::Float64},
                  {"label", {labels.begin(), labels.end()}, 1, Type::Int32},
                  {"gradient", flat(mesh.gradient), 3, Type::Float32},
                  {"Normals", flat(mesh.normal), 3, Type::Float32}};
    return vtp(shape);
}

std::string surfaceGlb(const SurfaceMesh& given, const Similarity& transform, const Color& color,
                       const Vec3d& up) {
    const SurfaceMesh mesh = inWorld(given, transform);
    const std::size_t n = mesh.position.size();
    const std::vector<Vec3f> colors = colorsOf(mesh.distance, color);
    const double largest = largestOf(mesh.distance);
    GlbWriter glb(n);
    const Vec3d place = placeOf(mesh.position, kNoticed * transform.dx);
    glb.addVectors("POSITION", [&](std::size_t v) { return Vec3f(mesh.position[v] - place); });
    glb.addVectors("NORMAL", [&](std::size_t v) { return mesh.normal[v]; });
    glb.addVectors("COLOR_0", [&](std::size_t v) { return colors[v]; });
    auto isReached = [&](std::size_t v) { return mesh.distance[v] < kInfinity; };
    glb.addPairs("TEXCOORD_0", [&](std::size_t v) {
        if (!isReached(v)) return Vec2f{0, 1};
        return Vec2f{largest > 0 ? float(mesh.distance[v] / largest) : 0.0f, 0};
    });
    glb.addNumbers("_DISTANCE",
                   [&](std::size_t v) { return isReached(v) ? float(mesh.distance[v]) : -1.0f; });
    glb.addNumbers("_LABEL", [&](std::size_t v) {
        return mesh.label[v] == kNoLabel ? -1.0f : float(mesh.label[v]);
    });
    return glb.bytes(mesh.triangles, up, place);
}

}  // namespace igeo
