#include <openvdb/tools/Dense.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "arrays.h"
#include "background.h"
#include "bindings.h"

namespace {

using igeo::Surface;
using igeo::VoxelOptions;

igeo::Scheme schemeNamed(const std::string& name) {
    return name == "godunov" ? igeo::Scheme::Godunov : igeo::Scheme::Jet;
}

Surface fromMesh(const Array<double>& vertices, const Array<std::uint32_t>& faces,
                 const std::string& name, const VoxelOptions& voxels, const py::object& progress) {
    igeo::PolygonMesh polygons;
    polygons.vertices = pointsOf(vertices);
    polygons.corners = vectorOf(faces);
    polygons.faceEnd.resize(polygons.corners.size() / 3);
    for (std::size_t f = 0; f < polygons.faceEnd.size(); ++f) polygons.faceEnd[f] = 3 * (f + 1);
    return inBackground(progress, [&](igeo::Progress& p) {
        return Surface(igeo::meshOf(std::move(polygons), name), voxels, p);
    });
}

Surface fromPoints(const Array<double>& points, const std::optional<Array<double>>& normals,
                   const std::string& name, const VoxelOptions& voxels,
                   const py::object& progress) {
    igeo::PointCloud cloud;
    cloud.file = name;
    cloud.points = pointsOf(points);
    if (normals)
        for (const igeo::Vec3d& n : pointsOf(*normals)) cloud.normals.emplace_back(n);
    return inBackground(progress, [&](igeo::Progress& p) {
        igeo::requireUsable(cloud);
        return Surface(std::move(cloud), voxels, p);
    });
}

/// The size of an array values[i, j, k] with i fastest in memory.
std::array<std::size_t, 3> sizeOf(const py::array_t<float, py::array::f_style>& values) {
    return {std::size_t(values.shape(0)), std::size_t(values.shape(1)),
            std::size_t(values.shape(2))};
}

igeo::Vec3d column(const Array<double>& affine, int c) {
    return {affine.at(0, c), affine.at(1, c), affine.at(2, c)};
}

Surface fromVolume(const py::array_t<float, py::array::f_style>& values,
                   const Array<double>& affine, std::optional<double> iso, const std::string& name,
                   VoxelOptions voxels, const py::object& progress) {
    igeo::VoxelVolume volume;
    volume.file = name;
    volume.kind = "array";
    volume.size = sizeOf(values);
    volume.values.assign(values.data(), values.data() + values.size());
    for (int a = 0; a < 3; ++a) volume.axis[std::size_t(a)] = column(affine, a);
    volume.origin = column(affine, 3);
    if (voxels.size == 0 && voxels.resolution == 0) voxels.size = volume.finestSpacing();
    return inBackground(progress, [&](igeo::Progress& p) {
        return Surface(igeo::volumeMesh(volume, iso, p), voxels, p);
    });
}

/// Active where |psi| is at most `width`; elsewhere only the sign is used.
openvdb::FloatGrid::Ptr levelSetGrid(const py::array_t<float, py::array::f_style>& values,
                                     const Array<double>& affine, float width) {
    auto grid = openvdb::FloatGrid::create(width);
    const auto size = sizeOf(values);
    auto accessor = grid->getAccessor();
    const float* value = values.data();
    for (std::size_t k = 0; k < size[2]; ++k)
        for (std::size_t j = 0; j < size[1]; ++j)
            for (std::size_t i = 0; i < size[0]; ++i, ++value) {
                const openvdb::Coord ijk{int(i), int(j), int(k)};
                if (!(std::abs(*value) > width))
                    accessor.setValueOn(ijk, *value);
                else if (*value < 0)
                    accessor.setValueOff(ijk, -width);
            }
    openvdb::math::Mat4d map;  // OpenVDB multiplies rows from the left
    for (int r = 0; r < 4; ++r)
        for (int c = 0; c < 4; ++c) map(c, r) = affine.at(r, c);
    grid->setTransform(openvdb::math::Transform::createLinearTransform(map));
    grid->setGridClass(openvdb::GRID_LEVEL_SET);
    return grid;
}

Surface fromLevelSet(const py::array_t<float, py::array::f_style>& values,
                     const Array<double>& affine, double width, const std::string& name,
                     const py::object& progress) {
    return inBackground(progress, [&](igeo::Progress& p) {
        auto grid = levelSetGrid(values, affine, float(width));
        grid->setName(name);
        return Surface(igeo::LoadedGrid{grid, name, name, true}, p);
    });
}

/// The kind of a file, by its ending.
std::string kindOf(const std::string& file) {
    if (igeo::isVolumeFile(file)) return "volume";
    if (igeo::isMeshFile(file)) return "mesh";
    return igeo::isPointFile(file) ? "points" : "level set";
}

Surface fromFile(const std::string& file, const std::string& kind, const std::string& grid,
                 bool rebuild, std::optional<double> iso, VoxelOptions voxels,
                 const py::object& progress) {
    return inBackground(progress, [&](igeo::Progress& p) {
        if (kind == "mesh") return Surface(igeo::readMesh(file), voxels, p);
        if (kind == "points") return Surface(igeo::readPointCloud(file), voxels, p);
        if (kind == "volume") {
            const igeo::VoxelVolume volume = igeo::readVolume(file);
            if (voxels.size == 0 && voxels.resolution == 0) voxels.size = volume.finestSpacing();
            return Surface(igeo::volumeMesh(volume, iso, p), voxels, p);
        }
        const igeo::GridSource source =
            grid.empty() ? igeo::parseGridSource(file) : igeo::GridSource{file, grid};
        if (!rebuild) return Surface(igeo::readLevelSetGrid(source), p);
        const igeo::LoadedGrid volume = igeo::readScalarGrid(source);
        const bool fog = volume.grid->getGridClass() == openvdb::GRID_FOG_VOLUME;
        return Surface(igeo::rebuilt(volume, iso.value_or(fog ? 0.5 : 0.0), p), p);
    });
}

std::string kindNameOf(const Surface& surface) {
    switch (surface.facts().kind) {
        case igeo::SurfaceFacts::Kind::Mesh:
            return "mesh";
        case igeo::SurfaceFacts::Kind::Points:
            return "points";
        case igeo::SurfaceFacts::Kind::LevelSet:
            break;
    }
    return "level set";
}

/// The vertices as a read-only view of memory that `self` owns.
py::object verticesOf(const py::object& self) {
    const std::vector<igeo::Vec3d>* vertices = self.cast<const Surface&>().vertices();
    if (!vertices) return py::none();
    Array<double> view({py::ssize_t(vertices->size()), py::ssize_t(3)},
                       reinterpret_cast<const double*>(vertices->data()), self);
    view.attr("setflags")(py::arg("write") = false);
    return view;
}

/// Whether all faces of a mesh are triangles.
bool isOfTriangles(const igeo::PolygonMesh& mesh) {
    for (std::size_t f = 0; f < mesh.faces(); ++f)
        if (mesh.face(f).size() != 3) return false;
    return true;
}

/// The triangles of a mesh, in the order of its faces, with the vertex numbers of these.
std::vector<igeo::TriangleMesh::Triangle> cutFaces(const igeo::TriangleMesh& mesh) {
    constexpr std::uint32_t kNone = igeo::TriangleMesh::kNoPoint;
    std::vector<igeo::TriangleMesh::Triangle> found;
    for (std::size_t f = 0; f < mesh.source->faces(); ++f) {
        const auto face = mesh.source->face(f);
        const auto vertexAt = [&](std::uint32_t point) {
            for (const std::uint32_t v : face)
                if (mesh.pointOfVertex[v] == point) return v;
            return kNone;
        };
        // A face of n corners has n - 2 triangles, or fewer where some have shrunk or are repeated.
        for (std::size_t k = 2; k < face.size() && found.size() < mesh.triangles.size(); ++k) {
            const auto& [a, b, c] = mesh.triangles[found.size()];
            const igeo::TriangleMesh::Triangle t{vertexAt(a), vertexAt(b), vertexAt(c)};
            if (t[0] == kNone || t[1] == kNone || t[2] == kNone) break;
            found.push_back(t);
        }
    }
    return found;
}

/// The triangles of a mesh, each corner as the first vertex at its point: pieces of triangles that
/// were split have corners that are none of their face.
std::vector<igeo::TriangleMesh::Triangle> splitFaces(const igeo::TriangleMesh& mesh) {
    std::vector<std::uint32_t> firstAt(mesh.points.size());
    for (std::size_t v = mesh.pointOfVertex.size(); v-- > 0;)
        if (mesh.pointOfVertex[v] != igeo::TriangleMesh::kNoPoint)
            firstAt[mesh.pointOfVertex[v]] = std::uint32_t(v);
    auto found = mesh.triangles;
    for (auto& corners : found)
        for (std::uint32_t& corner : corners) corner = firstAt[corner];
    return found;
}

/// Triangles with vertex numbers: those of the file, or those that its polygons are cut into.
py::object facesOf(const Surface& surface) {
    const igeo::TriangleMesh* mesh = surface.triangles();
    if (!mesh) return py::none();
    if (!mesh->source) return arrayOf(std::vector(mesh->triangles));
    if (!isOfTriangles(*mesh->source))
        return arrayOf(mesh->junctions > 0 ? splitFaces(*mesh) : cutFaces(*mesh));
    const auto& corners = mesh->source->corners;
    const auto n = py::ssize_t(mesh->source->faces());
    return owning<std::uint32_t>(std::vector(corners), {n, 3});
}

}  // namespace

void bindSurface(py::module_& module) {
    using namespace py::literals;
    module.def("kind_of", &kindOf, "file"_a);
    py::class_<VoxelOptions>(module, "Voxels")
        .def(py::init([](double size, int resolution, const std::string& scheme, double joinGaps) {
                 return VoxelOptions{size, resolution, schemeNamed(scheme), joinGaps};
             }),
             "size"_a, "resolution"_a, "scheme"_a, "join_gaps"_a);
    py::class_<Surface>(module, "Surface")
        .def_static("from_mesh", &fromMesh, "vertices"_a, "faces"_a, "name"_a, "voxels"_a,
                    "progress"_a)
        .def_static("from_points", &fromPoints, "points"_a, "normals"_a, "name"_a, "voxels"_a,
                    "progress"_a)
        .def_static("from_volume", &fromVolume, "values"_a, "affine"_a, "iso"_a, "name"_a,
                    "voxels"_a, "progress"_a)
        .def_static("from_level_set", &fromLevelSet, "values"_a, "affine"_a, "width"_a, "name"_a,
                    "progress"_a)
        .def_static("from_file", &fromFile, "file"_a, "kind"_a, "grid"_a, "rebuild"_a, "iso"_a,
                    "voxels"_a, "progress"_a)
        .def_property_readonly("kind", &kindNameOf)
        .def_property_readonly("name", [](const Surface& s) { return s.facts().name; })
        .def_property_readonly("summary", [](const Surface& s) { return s.facts().summary; })
        .def_property_readonly("warnings", [](const Surface& s) { return s.facts().warnings; })
        .def_property_readonly("snap", [](const Surface& s) { return s.facts().snap; })
        .def_property_readonly("voxel_size", [](const Surface& s) { return s.transform().dx; })
        .def_property_readonly("vertices", &verticesOf)
        .def_property_readonly("faces", &facesOf);
}
