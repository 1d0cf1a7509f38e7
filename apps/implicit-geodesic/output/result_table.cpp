#include "output/result_table.h"

#include <igeo/results/color_map.h>
#include <igeo/results/distance_matrix.h>
#include <igeo/results/pair_distances.h>
#include <igeo/results/picture.h>
#include <igeo/results/surface_mesh.h>

#include <algorithm>

#include "output/grids.h"
#include "output/output_files.h"
#include "output/result_checks.h"
#include "usage_error.h"

namespace {

void writePaths(RunResult& r, const std::string& file) {
    writeDocument(file, endingOf(file) == ".obj" ? geodesicsObj(r.lines(), r.band())
                                                 : geodesicsJson(r.report, r.field()));
}

void writeMesh(RunResult& r, const std::string& file) {
    const igeo::ColorMap colors(colorMapOf(r.options));
    auto color = [&](double t) { return igeo::Vec3f(igeo::srgbFromLinear(colors(t))); };
    const igeo::Similarity& transform = r.band().transform;
    writeDocument(file, endingOf(file) == ".obj" ? igeo::surfaceObj(r.mesh(), transform, color)
                                                 : igeo::surfacePly(r.mesh(), transform, color));
}

void writeIsolines(RunResult& r, const std::string& file) {
    const std::string ending = endingOf(file);
    const igeo::Similarity& transform = r.band().transform;
    writeDocument(file, ending == ".obj"   ? igeo::isolinesObj(r.isolines(), transform)
                        : ending == ".ply" ? igeo::isolinesPly(r.isolines(), transform)
                                           : isolinesJson(r.report, r.field(), r.isolines()));
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
    writeDocument(file, endingOf(file) == ".json"
                            ? pairsJson(r.report, r.band())
                            : igeo::pairsCsv(r.report.pairs, r.band().transform.dx));
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
    writeDocument(file, igeo::renderPng(r.levelSet(), r.field(), r.lines(), picture, r.progress));
}

std::string pairsFile(const RunOptions& o) {
    return o.pairsOut.empty() && !o.pairs.empty() ? "-" : o.pairsOut;
}

/// Of a level set from standard input the grid names it, and is not known yet.
std::string volumeFile(const RunOptions& o) {
    if (!o.hasSeeds() || (o.source.file == "-" && o.output.empty())) return o.output;
    return distanceFile(o, "");
}

void requireTogether(const ResultKind& kind, const RunOptions& o) {
    const std::string option = kind.option;
    if (kind.needs.jet && o.scheme != igeo::Scheme::Jet)
        usageError(option + " is marched with jet, and --scheme " + igeo::toString(o.scheme) +
                       " is asked for",
                   "leave --scheme out; for distances by godunov take a run per seed, whose "
                   "--report has those of its targets");
    if (kind.needs.points && o.hasExtendedSeeds())
        usageError(option + " does not go with --seed-curve and --seed-mask",
                   "it is made of distances between points");
}

}  // namespace

const std::vector<ResultKind>& resultKinds() {
    using Options = const RunOptions&;
    static const std::vector<ResultKind> kinds{
        {"-o", "distance", "", volumeFile, {.seeds = true}, writeVolume},
        {"--paths", "paths", ".json .obj", [](Options o) { return o.paths; }, {}, writePaths},
        {"--mesh-out",
         "mesh",
         ".ply .obj",
         [](Options o) { return o.meshOut; },
         {.seeds = true},
         writeMesh},
        {"--isolines",
         "isolines",
         ".json .obj .ply",
         [](Options o) { return o.isolines; },
         {.seeds = true},
         writeIsolines},
        {"--matrix",
         "matrix",
         ".csv .json .npy",
         [](Options o) { return o.matrix; },
         {.seeds = true, .jet = true, .points = true},
         writeMatrix},
        {"--pairs-out", "pairs", ".csv .json", pairsFile, {.jet = true}, writePairs},
        {"--image", "image", ".png", [](Options o) { return o.image; }, {}, writePicture},
        {"--report", "report", "", [](Options o) { return o.report; }, {}, nullptr}};
    return kinds;
}

void checkResults(const RunOptions& o) {
    for (const ResultKind& kind : resultKinds()) {
        if (kind.file(o).empty()) continue;
        if (kind.needs.seeds && !o.hasSeeds())
            usageError(std::string(kind.option) + " needs distances, but no seed is given",
                       "add --seed x,y,z; without seeds only --paths, --pairs-out, --image and "
                       "--report are written");
        requireTogether(kind, o);
    }
    checkGrids(o);
    if (o.matrixRows && endingOf(o.matrix) != ".json")
        usageError("--matrix-rows without --matrix FILE.json",
                   "parts are written as JSON; batch merge --matrix makes any format of them");
}

std::vector<WithoutEffect> optionsWithoutEffect(const RunOptions& o) {
    const bool grids = !o.grids.empty(), lines = o.asked(Grid::Engraved);
    const bool curved = o.weightCurvature || o.metricCurvature || o.asked(Grid::Curvature);
    const struct {
        bool given, used;
        const char *option, *users;
    } modifiers[] = {
        {o.extend, o.hasSeeds(), "--extend", "a seed"},
        {!o.name.empty(), o.hasSeeds(), "--name", "a seed"},
        {grids, o.hasSeeds(), "--grids", "a seed"},
        {o.hasTargets(), o.hasSeeds(), "--target", "a seed"},
        {o.straighten, o.hasTargets(), "--straighten", "--target or --targets"},
        {o.stopAtTargets, o.hasTargets(), "--stop-at-targets", "--target or --targets"},
        {o.maxDistance > 0, o.hasSeeds(), "--max-distance", "a seed"},
        {o.levels > 0, !o.isolines.empty() || !o.image.empty() || lines, "--levels",
         "--isolines, --image or --grids engraved"},
        {o.spacing > 0, !o.isolines.empty() || !o.image.empty() || lines, "--spacing",
         "--isolines, --image or --grids engraved"},
        {!o.pairsOut.empty(), !o.pairs.empty(), "--pairs-out", "--pairs"},
        {o.imageSize.has_value(), !o.image.empty(), "--image-size", "--image"},
        {o.camera.has_value(), !o.image.empty(), "--camera", "--image"},
        {o.up == UpAxis::Z, !o.image.empty(), "--up", "--image"},
        {!o.colorMap.empty(), !o.image.empty() || !o.meshOut.empty() || o.asked(Grid::Color),
         "--color-map", "--image, --mesh-out or --grids color"},
        {o.order.has_value(), o.scheme == igeo::Scheme::Godunov, "--order", "--scheme godunov"},
        {o.curvatureScale > 0, curved, "--curvature-scale",
         "--weight-curvature, --metric-curvature or --grids curvature"}};
    std::vector<WithoutEffect> found;
    for (const auto& m : modifiers)
        if (m.given && !m.used) found.push_back({m.option, m.users});
    return found;
}

void refuseWithoutEffect(const RunOptions& o) {
    for (const WithoutEffect& w : optionsWithoutEffect(o))
        usageError(w.option + " has no effect without " + w.users, "add that, or leave it out");
}

void checkFiles(const RunOptions& o) {
    const std::vector<std::string> inputs = inputFiles(o);
    if (const auto n = std::count(inputs.begin(), inputs.end(), "-"); n > 1)
        usageError(
            "standard input is named for " + std::to_string(n) + " inputs, and can be read once",
            "give the others as files");
    std::vector<OutputFile> outputs;
    for (const ResultKind& kind : resultKinds())
        if (const std::string file = kind.file(o); !file.empty())
            outputs.push_back({kind.option, file, kind.endings});
    checkOutputFiles(outputs, inputs);
}

std::vector<std::string> outputFiles(const RunOptions& o) {
    std::vector<std::string> files;
    for (const ResultKind& kind : resultKinds())
        if (const std::string file = kind.file(o); !file.empty()) files.push_back(file);
    return files;
}

void writeResults(RunResult& r) {
    for (const ResultKind& kind : resultKinds()) {
        const std::string file = kind.write == writeVolume && r.options.hasSeeds()
                                     ? distanceFile(r.options, r.distance.surface().facts().name)
                                     : kind.file(r.options);
        if (file.empty() || !kind.write) continue;
        kind.write(r, file);
        r.report.outputs.emplace_back(kind.name, file);
    }
}
