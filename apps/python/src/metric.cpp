#include <igeo/metric/vertex_weights.h>

#include <map>

#include "arrays.h"
#include "background.h"
#include "bindings.h"
#include "obstacle_rim.h"

namespace {

using igeo::Band;
using igeo::NodeIndex;
using igeo::Tensor;

std::vector<bool> maskOf(const Array<bool>& blocked) {
    return std::vector<bool>(blocked.data(), blocked.data() + blocked.size());
}

/// Turns a tensor from world axes to index axes; `g` is row by row.
Tensor turned(const double* g, const std::array<igeo::Vec3d, 3>& axis) {
    const auto component = [&](std::size_t a, std::size_t b) {
        double sum = 0;
        for (int r = 0; r < 3; ++r)
            for (int c = 0; c < 3; ++c) sum += axis[a][r] * g[3 * r + c] * axis[b][c];
        return float(sum);
    };
    return {component(0, 0), component(1, 1), component(2, 2),
            component(0, 1), component(0, 2), component(1, 2)};
}

void setNodeTensors(MetricBuilder& metric, const Array<double>& tensors) {
    const auto& axis = metric.plain().surface().transform().axis;
    auto& all = metric.definition().nodeTensors;
    all.resize(std::size_t(tensors.size() / 9));
    for (std::size_t k = 0; k < all.size(); ++k) all[k] = turned(tensors.data() + 9 * k, axis);
}

/// Values per vertex at the points of the mesh; for welded vertices that of the last.
std::vector<double> atPoints(const igeo::TriangleMesh& mesh, const double* values,
                             std::size_t stride) {
    std::vector<double> ofPoint(mesh.points.size());
    if (!mesh.source)
        for (std::size_t p = 0; p < ofPoint.size(); ++p) ofPoint[p] = values[p * stride];
    else
        for (std::size_t v = 0; v < mesh.pointOfVertex.size(); ++v)
            if (const auto p = mesh.pointOfVertex[v]; p != igeo::TriangleMesh::kNoPoint)
                ofPoint[p] = values[v * stride];
    return ofPoint;
}

/// Linear over each triangle, component by component.
void setVertexTensors(MetricBuilder& metric, const Array<double>& tensors,
                      const py::object& progress) {
    runInBackground(progress, [&](igeo::Progress& p) {
        const igeo::TriangleMesh& mesh = igeo::requireMesh(metric.plain().surface());
        const auto band = metric.plain().wholeBand(p);
        std::vector<double> ofNode(9 * band->size());
        for (std::size_t c = 0; c < 9; ++c) {
            const auto values =
                igeo::sampleVertexWeights(atPoints(mesh, tensors.data() + c, 9), *band, p);
            for (std::size_t k = 0; k < values.size(); ++k) ofNode[9 * k + c] = double(values[k]);
        }
        auto& all = metric.definition().nodeTensors;
        all.resize(band->size());
        for (std::size_t k = 0; k < all.size(); ++k)
            all[k] = turned(ofNode.data() + 9 * k, band->transform.axis);
    });
}

Array<double> footPoints(const igeo::GeodesicSolver& plain, const py::object& progress) {
    return arrayOf(inBackground(progress, [&](igeo::Progress& p) {
        const auto band = plain.wholeBand(p);
        std::vector<igeo::Vec3d> feet(band->size());
        for (std::size_t k = 0; k < feet.size(); ++k)
            feet[k] = band->transform.worldFromIndex(band->footPoint(NodeIndex(k)));
        return feet;
    }));
}

void setCurvatureWeight(MetricBuilder& metric, const std::string& kind, double epsilon,
                        double power) {
    static const std::map<std::string, igeo::CurvatureKind> kKinds{
        {"valley", igeo::CurvatureKind::Valley},
        {"crest", igeo::CurvatureKind::Crest},
        {"mean", igeo::CurvatureKind::Mean},
        {"gaussian", igeo::CurvatureKind::Gaussian},
        {"principal", igeo::CurvatureKind::Principal}};
    metric.definition().curvature = igeo::CurvatureWeight{kKinds.at(kind), epsilon, power};
}

void setBending(MetricBuilder& metric, const std::string& kind, double length) {
    metric.definition().bending =
        igeo::BendingCost{kind == "avoid" ? igeo::Bending::Avoid : igeo::Bending::Prefer, length};
}

/// Whether obstacles block any part of the whole surface.
bool blocksAny(const igeo::GeodesicSolver& solver) {
    const py::gil_scoped_release released;
    const igeo::MetricPtr metric = solver.wholeMetric();
    return metric && metric->blocksAny(*solver.wholeBand());
}

}  // namespace

void bindMetric(py::module_& module) {
    using namespace py::literals;
    module.def("foot_points", &footPoints, "plain"_a, "progress"_a);
    module.def("blocks_any", &blocksAny, "solver"_a);
    py::class_<ObstacleRim>(module, "ObstacleRim")
        .def(py::init<const igeo::GeodesicSolver&, const Array<bool>&>(), "plain"_a, "blocked"_a,
             py::call_guard<py::gil_scoped_release>())
        .def("middles", &ObstacleRim::middles)
        .def("halve", &ObstacleRim::halve, "blocked"_a);
    py::class_<MetricBuilder>(module, "Metric")
        .def(py::init<igeo::GeodesicSolver>(), "plain"_a)
        .def(
            "weight_by_node",
            [](MetricBuilder& m, const Array<float>& w) {
                m.definition().nodeWeights.push_back(vectorOf(w));
            },
            "weights"_a)
        .def(
            "weight_by_vertex",
            [](MetricBuilder& m, const Array<double>& w) {
                m.definition().vertexWeights.push_back(
                    igeo::valuesAtPoints(igeo::requireMesh(m.plain().surface()), vectorOf(w)));
            },
            "weights"_a)
        .def(
            "weight_by_grid",
            [](MetricBuilder& m, const std::string& file) {
                auto& all = m.definition().weights;
                all.push_back(igeo::readScalarGrid(igeo::parseGridSource(file)));
                return all.back().warnings;
            },
            "file"_a)
        .def("tensor_by_node", &setNodeTensors, "tensors"_a)
        .def("tensor_by_vertex", &setVertexTensors, "tensors"_a, "progress"_a)
        .def(
            "tensor_by_grid",
            [](MetricBuilder& m, const std::string& file) {
                m.definition().tensor = igeo::readTensorGrids(igeo::parseGridSource(file));
                return m.definition().tensor->warnings;
            },
            "file"_a)
        .def("weight_by_curvature", &setCurvatureWeight, "kind"_a, "eps"_a, "p"_a)
        .def(
            "weight_by_slope",
            [](MetricBuilder& m, const Array<double>& up, double steepest, double power) {
                m.definition().slope = igeo::SlopeWeight{pointOf(up), steepest, power};
            },
            "up"_a, "steepest"_a, "power"_a)
        .def("tensor_by_curvature", &setBending, "kind"_a, "length"_a)
        .def(
            "curvature_scale",
            [](MetricBuilder& m, double voxels) { m.definition().curvatureScale = voxels; },
            "voxels"_a)
        .def(
            "block_sphere",
            [](MetricBuilder& m, const Array<double>& center, double radius) {
                m.obstacles().addSphere(pointOf(center), radius);
            },
            "center"_a, "radius"_a)
        .def(
            "block_box",
            [](MetricBuilder& m, const Array<double>& low, const Array<double>& high) {
                m.obstacles().addBox(pointOf(low), pointOf(high));
            },
            "low"_a, "high"_a)
        .def(
            "block_vertices",
            [](MetricBuilder& m, const Array<bool>& blocked) {
                m.obstacles().addVertices(igeo::requireMesh(m.plain().surface()), maskOf(blocked));
            },
            "blocked"_a)
        .def(
            "block_inside",
            [](MetricBuilder& m, const ObstacleRim& rim, const std::string& name) {
                const py::gil_scoped_release released;
                m.obstacles().addGrid({rim.levelSet(), name, name});
            },
            "rim"_a, "name"_a)
        .def(
            "block_grid",
            [](MetricBuilder& m, const std::string& file) {
                const auto grid = igeo::readObstacleGrid(igeo::parseGridSource(file));
                m.obstacles().addGrid(grid);
                return grid.warnings;
            },
            "file"_a)
        .def(
            "solver",
            [](const MetricBuilder& m, const py::object& progress) {
                return inBackground(progress, [&](igeo::Progress& p) { return m.solver(p); });
            },
            "progress"_a);
}
