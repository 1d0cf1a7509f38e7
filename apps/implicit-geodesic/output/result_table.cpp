#include "output/result_table.h"

#include <igeo/results/color_map.h>
#include <igeo/results/distance_matrix.h>
#include <igeo/results/picture.h>
#include <igeo/results/surface_mesh.h>
#include <igeo/results/vertex_values.h>

#include <algorithm>

#include "output/grids.h"
#include "output/output_files.h"
#include "output/path_curves.h"
#include "output/run_result.h"

namespace {

/// What is no file of curves is JSON: standard output, devices.
bool isCurveFile(const std::string& file) {
    const std::string ending = endingOf(file), all = std::string(igeo::kCurveEndings) + " ";
    return !ending.empty() && all.find(ending + " ") != std::string::npos;
}

void writePaths(RunResult& r, const std::string& file) {
    const RunReport report = withPathsAsAsked(r.report, r.solver, r.options);
    writeDocument(file, isCurveFile(file) ? igeo::curveFile(endingOf(file), igeo::CurveKind::Path,
                                                            pathCurves(report))
                                          : geodesicsJson(report, r.field()));
}

igeo::Color srgb(const RunOptions& options) {
    return [colors = igeo::ColorMap(colorMapOf(options))](double t) {
        return igeo::Vec3f(igeo::srgbFromLinear(colors(t)));
    };
}

void writeMesh(RunResult& r, const std::string& file) {
    const igeo::Color color = srgb(r.options);
    const igeo::Similarity& transform = r.band().transform;
    writeDocument(file, endingOf(file) == ".obj" ? igeo::surfaceObj(r.mesh(), transform, color)
                                                 : igeo::surfacePly(r.mesh(), transform, color));
}

void writeIsolines(RunResult& r, const std::string& file) {
    writeDocument(file, isCurveFile(file)
                            ? igeo::curveFile(endingOf(file), igeo::CurveKind::Isoline,
                                              igeo::namedCurves(r.isolines(), r.band().transform))
                            : isolinesJson(r.report, r.field(), r.isolines()));
}

void writeVertices(RunResult& r, const std::string& file) {
    const igeo::TriangleMesh& mesh = *r.distance.surface().triangles();
    const igeo::VertexValues values = igeo::vertexValues(mesh, r.field(), r.progress);
    const igeo::Color color = srgb(r.options);
    const std::string ending = endingOf(file);
    writeDocument(file,
                  ending == ".npy"   ? igeo::verticesNpy(values)
                  : ending == ".ply" ? igeo::verticesPly(igeo::polygonsOf(mesh), values, color)
                  : ending == ".obj" ? igeo::verticesObj(igeo::polygonsOf(mesh), values, color)
                                     : igeo::verticesCsv(values));
}

void writeMatrix(RunResult& r, const std::string& file) {
    const std::vector<igeo::SurfacePoint>&seeds = r.field().seeds, &targets = r.distance.targets();
    const igeo::MetricPtr& metric = r.field().metric;
    const std::optional<Part>& rows = r.options.matrixRows;
    const igeo::DistanceMatrix matrix =
        rows ? igeo::distanceRows(r.band(), metric, seeds, targets, rows->begin(seeds.size()),
                                  rows->end(seeds.size()), r.progress)
             : igeo::distances(r.band(), metric, seeds, targets, r.progress);
    const std::string ending = endingOf(file);
    writeDocument(file, ending == ".json"  ? matrixJson(r.report, r.band(), matrix)
                        : ending == ".npy" ? igeo::matrixNpy(matrix)
                                           : igeo::matrixCsv(matrix));
}

void writePairs(RunResult& r, const std::string& file) {
    writeDocument(
        file, endingOf(file) == ".json" ? pairsJson(r.report, r.band()) : pairsCsv(r.report.pairs));
}

void writePicture(RunResult& r, const std::string& file) {
    const RunOptions& o = r.options;
    igeo::PictureOptions picture;
    if (o.imageSize) picture.width = o.imageSize->width, picture.height = o.imageSize->height;
    if (o.camera) picture.eye = o.camera->eye, picture.lookAt = o.camera->lookAt;
    if (o.up == UpAxis::Z) picture.up = {0, 0, 1};
    picture.colorMap = colorMapOf(o);
    if (o.spacing > 0) picture.isolineSpacing = o.spacing;
    if (o.levels > 0) picture.isolineSpacing = r.distance.largest() / (o.levels + 1);
    // A mesh is drawn as it is given.
    writeDocument(
        file, r.band().triangles
                  ? igeo::renderPng(r.field(), r.drawnLines(), picture, r.progress)
                  : igeo::renderPng(r.levelSet(), r.field(), r.drawnLines(), picture, r.progress));
}

std::string pairsFile(const RunOptions& o, const std::string*) {
    return o.pairsOut.empty() && !o.pairs.empty() ? "-" : o.pairsOut;
}

std::string volumeFile(const RunOptions& o, const std::string* grid) {
    return o.hasSeeds() ? distanceFile(o, grid) : o.output;
}

}  // namespace

const std::vector<ResultKind>& resultKinds() {
    using Options = const RunOptions&;
    using Name = const std::string*;
    static const char* const kCurveFiles = ".json .csv .obj .ply .vtp .usda";
    static const std::vector<ResultKind> kinds{
        {"-o", "distance", ".vdb", volumeFile, {.seeds = true}, writeVolume},
        {"--paths", "paths", kCurveFiles, [](Options o, Name) { return o.paths; }, {}, writePaths},
        {"--mesh-out",
         "mesh",
         ".ply .obj",
         [](Options o, Name) { return o.meshOut; },
         {.seeds = true},
         writeMesh},
        {"--per-vertex",
         "vertices",
         ".csv .npy .ply .obj",
         [](Options o, Name) { return o.perVertex; },
         {.seeds = true, .mesh = true},
         writeVertices},
        {"--isolines",
         "isolines",
         kCurveFiles,
         [](Options o, Name) { return o.isolines; },
         {.seeds = true},
         writeIsolines},
        {"--matrix",
         "matrix",
         ".csv .json .npy",
         [](Options o, Name) { return o.matrix; },
         {.seeds = true, .jet = true, .points = true},
         writeMatrix},
        {"--pairs-out", "pairs", ".csv .json", pairsFile, {.jet = true}, writePairs},
        {"--image", "image", ".png", [](Options o, Name) { return o.image; }, {}, writePicture},
        {"--report", "report", "", [](Options o, Name) { return o.report; }, {}, nullptr}};
    return kinds;
}

void writeResults(RunResult& r) {
    for (const ResultKind& kind : resultKinds()) {
        const std::string file = kind.file(r.options, &r.distance.surface().facts().name);
        if (file.empty() || !kind.write) continue;
        kind.write(r, file);
        r.report.outputs.emplace_back(kind.name, file);
    }
}
