#include "output/result_table.h"

#include <igeo/base/parallel.h>
#include <igeo/results/color_map.h>
#include <igeo/results/distance_matrix.h>
#include <igeo/results/lost_points.h>
#include <igeo/results/picture.h>
#include <igeo/results/surface_files.h>
#include <igeo/view.h>

#include <algorithm>

#include "heap.h"
#include "output/grids.h"
#include "output/output_files.h"
#include "output/path_curves.h"
#include "output/run_result.h"

namespace {

/// Files that hold no curves by their endings are JSON: standard output, devices.
bool isCurveFile(const std::string& file) {
    const std::string ending = endingOf(file), all = std::string(igeo::kCurveEndings) + " ";
    return !ending.empty() && all.find(ending + " ") != std::string::npos;
}

void writePaths(RunResult& r, const std::string& file) {
    const RunReport report = withPathsAsAsked(r.report, r.solver, r.options);
    writeDocument(file, isCurveFile(file) ? igeo::curveFile(endingOf(file), igeo::CurveKind::Path,
                                                            pathCurves(report))
                                          : geodesicsJson(report, *r.marched()));
}

igeo::Color srgb(const RunOptions& options) {
    return [colors = igeo::ColorMap(colorMapOf(options))](double t) {
        return igeo::Vec3f(igeo::srgbFromLinear(colors(t)));
    };
}

igeo::Color linear(const RunOptions& options) {
    return
        [colors = igeo::ColorMap(colorMapOf(options))](double t) { return igeo::Vec3f(colors(t)); };
}

/// The up direction of pictures and .glb.
igeo::Vec3d upOf(const RunOptions& options) {
    return options.up.value_or(igeo::PictureOptions{}.up);
}

std::string meshAs(const std::string& ending, RunResult& r) {
    const igeo::Similarity& transform = r.band().transform;
    const igeo::Field& field = *r.marched();
    igeo::SurfaceMesh finished;
    const bool differs = field.greatest < igeo::kInfinity || !field.sign.empty();
    if (differs) finished = r.mesh(), finish(finished, field);
    const igeo::SurfaceMesh& mesh = differs ? finished : r.mesh();
    if (ending == ".vtp") return igeo::surfaceVtp(mesh, transform);
    if (ending == ".glb")
        return igeo::surfaceGlb(mesh, transform, linear(r.options), upOf(r.options));
    return (ending == ".obj" ? igeo::surfaceObj : igeo::surfacePly)(mesh, transform,
                                                                    srgb(r.options));
}

void writeMesh(RunResult& r, const std::string& file) {
    writeDocument(file, meshAs(endingOf(file), r));
}

void writeIsolines(RunResult& r, const std::string& file) {
    writeDocument(file, isCurveFile(file)
                            ? igeo::curveFile(endingOf(file), igeo::CurveKind::Isoline,
                                              igeo::namedCurves(r.isolines(), r.band().transform))
                            : isolinesJson(r.report, *r.marched(), r.isolines()));
}

/// Each source by itself. Samples are points that the march has found.
std::vector<igeo::Seeds> sourcesOf(const RunResult& r) {
    std::vector<igeo::Seeds> sources = r.input.seeds.sources();
    const std::shared_ptr<const igeo::Field> field = r.marched();
    const std::vector<igeo::SurfacePoint>& found = field->seeds;
    const igeo::Similarity& transform = r.band().transform;
    for (std::size_t k = found.size() - (field->sourceCount() - sources.size()); k < found.size();
         ++k) {
        const igeo::Vec3d p = found[k].pIndex;
        sources.push_back(
            {igeo::Seed(r.options.space == igeo::Space::Index ? p : transform.worldFromIndex(p))});
    }
    return sources;
}

std::string verticesAs(const std::string& ending, const igeo::TriangleMesh& mesh,
                       const igeo::VertexValues& values, const igeo::Color& color) {
    if (ending == ".npy") return igeo::verticesNpy(values);
    if (ending == ".npz") return igeo::verticesNpz(values);
    if (ending == ".gii") return igeo::verticesGifti(values);
    if (ending == ".ply") return igeo::verticesPly(igeo::polygonsOf(mesh), values, color);
    if (ending == ".vtp") return igeo::verticesVtp(igeo::polygonsOf(mesh), values);
    if (ending == ".obj") return igeo::verticesObj(igeo::polygonsOf(mesh), values, color);
    return igeo::verticesCsv(values);
}

/// Marches of single sources, numbered from `first` on, and their distances to points: adds a
/// warning where triangles join some without one.
/// @param distances(k)  the first of those of march k
template <typename Distances>
void warnOfLost(RunResult& r, const char* what, std::vector<igeo::Vec3d> pWorld, std::size_t first,
                std::size_t count, const Distances& distances) {
    const std::shared_ptr<const igeo::Field> field = r.marched();
    igeo::LostPoints lost(r.band(), field->metric, std::move(pWorld));
    for (std::size_t k = 0; k < count; ++k) lost.addSource(*field, first + k, distances(k));
    r.report.warn(lost.warning(what));
}

void writeVertices(RunResult& r, const std::string& file) {
    const igeo::TriangleMesh& mesh = *r.distance.surface().triangles();
    igeo::VertexValues values = r.distance.atVertices(r.progress);
    if (r.options.perSeed) {
        values.columns = r.solver.atVertices(sourcesOf(r), r.input.limits, r.progress);
        if (r.input.limits.maxDistance == igeo::kInfinity)
            warnOfLost(r, "distances from single seeds", igeo::polygonsOf(mesh).vertices, 0,
                       values.columns.size(),
                       [&](std::size_t k) { return values.columns[k].distance.data(); });
    }
    writeDocument(file, verticesAs(endingOf(file), mesh, values, srgb(r.options)));
}

void writeSamples(RunResult& r, const std::string& file) {
    const igeo::Samples samples = r.distance.samples();
    r.report.warn(igeo::lostWarning(*r.marched(), "samples", samples.position, samples.distance));
    const std::string ending = endingOf(file);
    writeDocument(file, ending == ".npz"   ? igeo::samplesNpz(samples)
                        : ending == ".ply" ? igeo::samplesPly(samples)
                                           : igeo::samplesCsv(samples));
}

/// Names the rows, and between seeds the columns, after the groups.
void nameGroups(const igeo::Seeds& seeds, bool betweenSeeds, igeo::DistanceMatrix& matrix) {
    for (std::size_t g = 0; g < seeds.groups.size(); ++g) {
        const std::size_t k = seeds.points.size() + g;
        matrix.seeds[k].name = seeds.groups[g].name;
        if (betweenSeeds) matrix.targets[k].name = seeds.groups[g].name;
    }
}

void writeMatrix(RunResult& r, const std::string& file) {
    const std::shared_ptr<const igeo::Field> field = r.marched();
    const std::vector<igeo::SurfacePoint>&seeds = field->seeds, &targets = r.distance.targets();
    const igeo::MetricPtr& metric = field->metric;
    const std::optional<Part>& rows = r.options.matrixRows;
    const std::size_t count = field->sourceCount();
    igeo::DistanceMatrix matrix =
        rows ? igeo::distanceRows(r.band(), metric, seeds, targets, rows->begin(count),
                                  rows->end(count), r.progress)
             : igeo::distances(r.band(), metric, seeds, targets, r.progress);
    nameGroups(r.input.seeds, targets.empty(), matrix);
    matrix.withReasons = r.options.skipOffSurface;
    std::vector<igeo::Vec3d> columns;
    for (const igeo::MatrixPlace& target : matrix.targets) columns.push_back(target.point.position);
    warnOfLost(r, "distances of the matrix", columns, matrix.firstRow, matrix.rows(),
               [&](std::size_t k) { return matrix.distance.data() + k * columns.size(); });
    if (matrix.oneWay > 0) r.report.warn(oneWayWarning(matrix));
    for (double& d : matrix.distance)
        if (d > r.input.limits.maxDistance) d = igeo::kInfinity;
    const std::string ending = endingOf(file);
    writeDocument(file, ending == ".json"  ? matrixJson(r.report, *field, matrix)
                        : ending == ".npy" ? igeo::matrixNpy(matrix)
                                           : igeo::matrixCsv(matrix));
}

void writePairs(RunResult& r, const std::string& file) {
    writeDocument(
        file, endingOf(file) == ".json" ? pairsJson(r.report, *r.marched()) : pairsCsv(r.report));
}

/// The options of a picture, except its size.
igeo::PictureOptions pictureOf(const RunResult& r, igeo::PictureOptions picture = {}) {
    const RunOptions& o = r.options;
    if (o.camera) picture.eye = o.camera->eye, picture.lookAt = o.camera->lookAt;
    picture.up = upOf(o);
    picture.background = o.background.value_or(picture.background);
    picture.unit = o.unit;
    picture.colorMap = colorMapOf(o);
    picture.isolineSpacing = o.spacing;
    picture.isolineCount = o.levels;
    return picture;
}

void writePicture(RunResult& r, const std::string& file) {
    igeo::PictureOptions picture = pictureOf(r);
    if (const std::optional<ImageSize>& size = r.options.imageSize)
        picture.width = size->width, picture.height = size->height;
    writeDocument(file, igeo::renderPng(r.distance, pathCurves(r.report), picture, r.progress));
}

/// Writes the page, with the names of the seeds in their files, and warnings as notes.
void writeViewPage(RunResult& r, const std::string& file) {
    igeo::ViewScene scene = igeo::viewScene(r.distance, pathCurves(r.report),
                                            pictureOf(r, igeo::viewPicture()), {}, r.progress);
    const std::vector<std::string>& names = r.report.sources;
    for (std::size_t k = 0; k < std::min(names.size(), scene.labelNames.size()); ++k)
        if (!names[k].empty()) scene.labelNames[k] = names[k];
    scene.notes.insert(scene.notes.end(), r.report.warnings.begin(), r.report.warnings.end());
    writeDocument(file, igeo::viewPage(scene));
}

std::string pairsFile(const RunOptions& o, const std::string*) {
    return o.pairsOut.empty() && !o.pairs.empty() ? "-" : o.pairsOut;
}

/// Whether results other than volume and report are requested, of those for which of(kind).
template <typename Of>
bool asksForOther(const RunOptions& o, const Of& of) {
    return std::any_of(resultKinds().begin(), resultKinds().end(), [&](const ResultKind& kind) {
        return kind.name != std::string("distance") && kind.name != std::string("report") &&
               of(kind) && !kind.file(o, nullptr).empty();
    });
}
bool asksForOther(const RunOptions& o) {
    return asksForOther(o, [](const ResultKind&) { return true; });
}
bool needsBand(const RunOptions& o, bool isMesh) {
    return !o.grids.empty() || o.extend || asksForOther(o, [&](const ResultKind& kind) {
        return kind.needs.band || (kind.needs.bandOfMesh && isMesh);
    });
}

/// Without -o a volume is written if it is the only result, or if options change its content.
std::string volumeFile(const RunOptions& o, const std::string* grid) {
    const bool unnamed = o.output.empty() && o.grids.empty() && !o.extend && !o.withSign &&
                         o.name.empty() && asksForOther(o);
    return o.hasSeeds() && !unnamed ? distanceFile(o, grid) : o.output;
}

}  // namespace

const std::vector<ResultKind>& resultKinds() {
    using Run = const RunOptions&;
    using Name = const std::string*;
    static const char* const kCurveFiles = ".json .csv .obj .ply .vtp .usda";
    static const std::vector<ResultKind> kinds{
        {"-o", "distance", ".vdb", volumeFile, {.seeds = true}, writeVolume},
        {"--paths", "paths", kCurveFiles, [](Run o, Name) { return o.paths; }, {}, writePaths},
        {"--mesh-out",
         "mesh",
         ".ply .vtp .glb .obj",
         [](Run o, Name) { return o.meshOut; },
         {.seeds = true, .band = true},
         writeMesh},
        {"--per-vertex",
         "vertices",
         ".csv .npy .npz .ply .vtp .gii .obj",
         [](Run o, Name) { return o.perVertex; },
         {.seeds = true, .mesh = true, .band = true},
         writeVertices},
        {"--samples",
         "samples",
         ".npz .csv .ply",
         [](Run o, Name) { return o.samples; },
         {.seeds = true, .jet = true},
         writeSamples},
        {"--isolines",
         "isolines",
         kCurveFiles,
         [](Run o, Name) { return o.isolines; },
         {.seeds = true, .band = true},
         writeIsolines},
        {"--matrix",
         "matrix",
         ".csv .json .npy",
         [](Run o, Name) { return o.matrix; },
         {.seeds = true, .jet = true, .points = true},
         writeMatrix},
        {"--pairs-out", "pairs", ".csv .json", pairsFile, {.jet = true}, writePairs},
        {"--image", "image", ".png", [](Run o, Name) { return o.image; }, {}, writePicture},
        {"--view",
         "view",
         ".html",
         [](Run o, Name) { return o.view; },
         {.viewer = true, .bandOfMesh = true},
         writeViewPage},
        {"--report", "report", "", [](Run o, Name) { return o.report; }, {}, nullptr}};
    return kinds;
}

void writeResults(RunResult& r) {
    const RunOptions& o = r.options;
    const std::string& surface = r.distance.surface().facts().name;
    if (!volumeFile(o, &surface).empty()) {
        // Some results need the whole band. Otherwise the volume is written leaf by leaf; if
        // nothing else needs the surface, its memory is freed first.
        if (needsBand(o, r.distance.surface().triangles() != nullptr)) {
            r.distance.field();
        } else if (r.lastRun && !asksForOther(o)) {
            r.distance.surface().dropVolume();
            // One thread uses the memory again for the volume that it writes.
            if (igeo::ThreadLimit::current() > 1) giveBackFreedMemory();
        }
    }
    for (const ResultKind& kind : resultKinds()) {
        const std::string file = kind.file(o, &surface);
        if (file.empty() || !kind.write) continue;
        kind.write(r, file);
        r.report.outputs.emplace_back(kind.name, file);
    }
}
