#include <igeo/base/parallel.h>
#include <igeo/results/lost_points.h>

#include <fstream>
#include <optional>

#include "arrays.h"
#include "background.h"
#include "bindings.h"

namespace {

using igeo::Distance;

/// Distances and labels at the vertices.
py::tuple atVertices(const Distance& d, const py::object& progress) {
    igeo::VertexValues values =
        inBackground(progress, [&](igeo::Progress& p) { return d.atVertices(p); });
    return py::make_tuple(arrayOf(std::move(values.distance)), labelsOf(values.label));
}

/// Distances, gradients and labels.
py::tuple valuesAt(const Distance& d, const Array<double>& points, const py::object& progress) {
    const auto asked = pointsOf(points);
    const auto values =
        inBackground(progress, [&](igeo::Progress& p) { return d.valuesAt(asked, p); });
    std::vector<double> distance;
    std::vector<igeo::Vec3d> gradient;
    std::vector<std::uint32_t> label;
    for (const igeo::PointValue& v : values) {
        distance.push_back(v.distance);
        gradient.push_back(v.gradient);
        label.push_back(v.source);
    }
    return py::make_tuple(arrayOf(std::move(distance)), arrayOf(std::move(gradient)),
                          labelsOf(label));
}

/// Per target the status of its path, and its points; then warnings.
py::tuple paths(const Distance& d, const Array<double>& targets, bool straighten,
                const py::object& progress) {
    const auto asked = pointsOf(targets);
    std::vector<igeo::Polyline> lines(asked.size());
    runInBackground(progress, [&](igeo::Progress& p) {
        igeo::parallelFor(asked.size(), 1, p, [&](std::size_t begin, std::size_t end) {
            for (std::size_t k = begin; k < end; ++k)
                lines[k] = igeo::naming("target " + std::to_string(k),
                                        [&] { return d.path(asked[k], straighten); });
        });
    });
    const auto warnings = igeo::pathWarnings(d.surface(), d.marched()->atFootPoints, lines);
    py::list all;
    for (igeo::Polyline& line : lines)
        all.append(py::make_tuple(igeo::toString(line.status), arrayOf(std::move(line.points))));
    return py::make_tuple(all, warnings);
}

/// Per line its level, whether it is closed, and its points.
py::list isolinesOf(const Distance& d, std::vector<double> levels, const py::object& progress) {
    const igeo::Similarity& t = d.band().transform;
    for (double& level : levels) level /= t.dx;
    auto lines = inBackground(progress, [&](igeo::Progress& p) {
        return igeo::isolines(d.field(), d.indexMesh(p), levels, p);
    });
    py::list all;
    for (igeo::Isoline& line : lines) {
        for (igeo::Vec3d& p : line.points) p = t.worldFromIndex(p);
        all.append(py::make_tuple(line.level * t.dx, line.closed, arrayOf(std::move(line.points))));
    }
    return all;
}

std::vector<igeo::NamedCurve> pathsTo(const Distance& d, const std::vector<igeo::Vec3d>& targets) {
    std::vector<igeo::NamedCurve> lines;
    for (const igeo::Vec3d& target : targets) {
        igeo::NamedCurve line;
        line.name = "path_" + std::to_string(lines.size());
        line.number = lines.size();
        line.points = d.path(target).points;
        lines.push_back(std::move(line));
    }
    return lines;
}

py::bytes picture(const Distance& d, const igeo::PictureOptions& options,
                  const Array<double>& targets, const py::object& progress) {
    const auto asked = pointsOf(targets);
    return inBackground(progress, [&](igeo::Progress& p) {
        return igeo::renderPng(d, pathsTo(d, asked), options, p);
    });
}

py::bytes page(const Distance& d, igeo::PictureOptions options, const Array<double>& targets,
               const py::object& progress) {
    const auto asked = pointsOf(targets);
    const igeo::PictureOptions still = igeo::viewPicture();
    options.width = still.width, options.height = still.height;
    return inBackground(progress, [&](igeo::Progress& p) {
        return igeo::viewPage(igeo::viewScene(d, pathsTo(d, asked), options, {}, p));
    });
}

void writeGrid(const Distance& d, const std::string& file, const std::string& name) {
    const py::gil_scoped_release released;
    igeo::writeVdb(file, {d.grid(name)});
}

py::tuple meshOf(const Distance& d, const py::object& progress) {
    igeo::SurfaceMesh mesh = inBackground(progress, [&](igeo::Progress& p) { return d.mesh(p); });
    return py::make_tuple(arrayOf(std::move(mesh.position)), arrayOf(std::move(mesh.triangles)),
                          arrayOf(std::move(mesh.distance)), labelsOf(mesh.label),
                          arrayOf(std::move(mesh.gradient)), arrayOf(std::move(mesh.normal)));
}

Array<double> seedPoints(const Distance& d) {
    std::vector<igeo::Vec3d> points;
    for (const igeo::SurfacePoint& s : d.seeds())
        points.push_back(d.band().transform.worldFromIndex(s.pIndex));
    return arrayOf(std::move(points));
}

/// The logarithmic map of a distance, with the distance.
struct PointMap {
    Distance distance;
    igeo::LogMap map;
};

PointMap logMapOf(const Distance& d, const std::optional<Array<double>>& reference,
                  const py::object& progress) {
    igeo::Vec3d u;
    const auto& axis = d.band().transform.axis;
    if (reference)
        for (int a = 0; a < 3; ++a) u[a] = dot(axis[std::size_t(a)], pointOf(*reference));
    return inBackground(progress, [&](igeo::Progress& p) {
        return PointMap{d, igeo::logMap(d.field(), u, p)};
    });
}

/// Shape (n, 2), world units.
Array<float> positionsAt(const PointMap& m, const Array<double>& points,
                         const py::object& progress) {
    const auto asked = pointsOf(points);
    const Distance& d = m.distance;
    std::vector<igeo::Vec2f> found(asked.size());
    runInBackground(progress, [&](igeo::Progress& p) {
        d.valuesAt(asked, p);  // refuses points off the surface
        const igeo::Similarity& t = d.band().transform;
        igeo::parallelFor(asked.size(), 64, p, [&](std::size_t begin, std::size_t end) {
            for (std::size_t k = begin; k < end; ++k)
                found[k] =
                    float(t.dx) *
                    igeo::positionAt(d.field(), m.map,
                                     d.surface().nearest(d.band(), t.indexFromWorld(asked[k])));
        });
    });
    const auto n = py::ssize_t(found.size());
    return owning<float>(std::move(found), {n, 2});
}

/// Shape (seeds, 2, 3), unit vectors of the world.
Array<double> axesOf(const PointMap& m) {
    const igeo::Similarity& t = m.distance.band().transform;
    std::vector<igeo::Vec3d> axes;
    for (const igeo::LogMap::Frame& frame : m.map.frames)
        for (const igeo::Vec3d& v : {frame.u, frame.v})
            axes.push_back(t.worldFromIndexDirection(v));
    const auto n = py::ssize_t(m.map.frames.size());
    return owning<double>(std::move(axes), {n, 2, 3});
}

/// Rows for seeds or groups; columns for targets, or the same. And warnings.
py::tuple matrixOf(const Distance& d, bool lookForLost, const py::object& progress) {
    std::vector<std::string> lost;
    igeo::DistanceMatrix matrix = inBackground(progress, [&](igeo::Progress& p) {
        igeo::DistanceMatrix made = d.matrix(p);
        const igeo::Field& field = *d.marched();
        std::vector<igeo::Vec3d> columns;
        for (const igeo::MatrixPlace& target : made.targets)
            columns.push_back(target.point.position);
        igeo::LostPoints rowsLost(d.band(), field.metric, columns);
        for (std::size_t k = 0; lookForLost && k < made.rows(); ++k)
            rowsLost.addSource(field, k, made.distance.data() + k * columns.size());
        lost = {rowsLost.warning("distances of the matrix"), oneWayWarning(made)};
        return made;
    });
    const auto rows = py::ssize_t(matrix.rows()), columns = py::ssize_t(matrix.targets.size());
    return py::make_tuple(owning<double>(std::move(matrix.distance), {rows, columns}), lost);
}

/// Whether labels tell the sources apart: godunov does not know which seed a front comes from.
bool isLabeled(const Distance& d) {
    return d.marched()->atFootPoints || d.marched()->sourceCount() <= 1;
}

void bindPicture(py::module_& module) {
    using namespace py::literals;
    py::class_<igeo::PictureOptions>(module, "Picture")
        .def(py::init<>())
        .def_readwrite("width", &igeo::PictureOptions::width)
        .def_readwrite("height", &igeo::PictureOptions::height)
        .def_readwrite("color_map", &igeo::PictureOptions::colorMap)
        .def_readwrite("spacing", &igeo::PictureOptions::isolineSpacing)
        .def_readwrite("legend", &igeo::PictureOptions::legend)
        .def(
            "eye", [](igeo::PictureOptions& o, const Array<double>& p) { o.eye = pointOf(p); },
            "point"_a)
        .def(
            "look_at",
            [](igeo::PictureOptions& o, const Array<double>& p) { o.lookAt = pointOf(p); },
            "point"_a)
        .def(
            "up", [](igeo::PictureOptions& o, const Array<double>& v) { o.up = pointOf(v); },
            "direction"_a);
}

}  // namespace

void bindDistance(py::module_& module) {
    using namespace py::literals;
    bindPicture(module);
    py::class_<PointMap>(module, "LogMap")
        .def("at", &positionsAt, "points"_a, "progress"_a)
        .def_property_readonly("axes", &axesOf);
    py::class_<Distance>(module, "Distance")
        .def("at_vertices", &atVertices, "progress"_a)
        .def("values_at", &valuesAt, "points"_a, "progress"_a)
        .def("paths", &paths, "targets"_a, "straighten"_a, "progress"_a)
        .def("log_map", &logMapOf, "reference"_a, "progress"_a)
        .def("isolines", &isolinesOf, "levels"_a, "progress"_a)
        .def("picture", &picture, "options"_a, "targets"_a, "progress"_a)
        .def("page", &page, "options"_a, "targets"_a, "progress"_a)
        .def("write_grid", &writeGrid, "file"_a, "name"_a)
        .def("mesh", &meshOf, "progress"_a)
        .def("matrix", &matrixOf, "look_for_lost"_a, "progress"_a)
        .def_property_readonly("labeled", &isLabeled)
        .def_property_readonly("signed",
                               [](const Distance& d) { return !d.marched()->sign.empty(); })
        .def_property_readonly("warnings",
                               [](const Distance& d) {
                                   const py::gil_scoped_release released;
                                   return igeo::marchWarnings(d);
                               })
        .def_property_readonly("lost",
                               [](const Distance& d) {
                                   const py::gil_scoped_release released;
                                   return igeo::lostWarnings(d);
                               })
        .def_property_readonly("seeds", &seedPoints)
        .def_property_readonly("largest", &Distance::largest)
        .def_property_readonly("reached", [](const Distance& d) {
            const std::size_t nodes = d.band().size();
            return nodes ? double(d.reached()) / double(nodes) : 0.0;
        });
}
