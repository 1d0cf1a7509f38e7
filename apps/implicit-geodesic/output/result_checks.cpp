#include "output/result_checks.h"

#include <igeo/geodesic_solver.h>
#include <igeo/results/view_page.h>

#include <algorithm>
#include <utility>

#include "output/output_files.h"
#include "output/result_table.h"
#include "usage_error.h"

namespace {

/// The option that requests a result: pairs go to stdout without one.
std::string optionFor(const ResultKind& kind, const RunOptions& o) {
    const std::string option = kind.option;
    return option == "--pairs-out" && o.pairsOut.empty() ? "--pairs" : option;
}

void requireTogether(const ResultKind& kind, const RunOptions& o) {
    const std::string option = optionFor(kind, o);
    if (kind.needs.viewer && !igeo::hasViewer())
        usageError(option + ": this program was built without three.js, which draws its pages",
                   "take --image FILE.png; or install three.js (Debian: libjs-three), configure "
                   "and build again");
    if (kind.needs.jet && o.scheme != igeo::Scheme::Jet)
        usageError(option + " is marched with jet, and --scheme " + igeo::toString(o.scheme) +
                       " is asked for",
                   "leave --scheme out; for distances by godunov take a run per seed, whose "
                   "--report has those of its targets");
    if (kind.needs.mesh && o.kind != SurfaceKind::Mesh)
        usageError(option + " needs the vertices of a mesh, and the surface is none",
                   "give it by --mesh; of other surfaces --mesh-out has vertices with distances");
    if (kind.needs.points && o.hasExtendedSeeds())
        usageError(option + " does not go with --seed-curve and --seed-mask",
                   "it holds distances between points");
}

std::vector<OutputFile> askedFiles(const RunOptions& o, const std::string* grid = nullptr) {
    std::vector<OutputFile> files;
    for (const ResultKind& kind : resultKinds())
        if (const std::string file = kind.file(o, grid); !file.empty())
            files.push_back({kind.option, file, kind.endings});
    return files;
}

void checkGrids(const RunOptions& o) {
    for (const auto& [grid, name] : {std::pair(Grid::Label, "label"), {Grid::LogMap, "logmap"}})
        if (o.asked(grid) && o.scheme != igeo::Scheme::Jet)
            usageError(std::string("--grids ") + name + " needs --scheme jet",
                       "godunov does not know which seed a front comes from");
    if (!o.asked(Grid::LogMap)) return;
    if (o.hasTensor())
        usageError("--grids logmap does not go with tensors (--metric, --metric-curvature)",
                   "the logarithmic map is known for weights only");
    if (o.hasExtendedSeeds())
        usageError("--grids logmap does not go with --seed-curve and --seed-mask",
                   "polar coordinates are those about a point");
}

/// Whether a mesh with colors is written.
bool colorsMesh(const RunOptions& o) {
    const std::string perVertex = endingOf(o.perVertex);
    return (!o.meshOut.empty() && endingOf(o.meshOut) != ".vtp") || perVertex == ".ply" ||
           perVertex == ".obj";
}

bool hasCoordinates(const std::vector<igeo::AskedPoint>& points) {
    return std::any_of(points.begin(), points.end(),
                       [](const igeo::AskedPoint& p) { return p.vertex.empty(); });
}

/// Whether points are given by x,y,z, or may be: those in files are not known yet.
bool hasCoordinates(const RunOptions& o) {
    return hasCoordinates(o.seeds) || hasCoordinates(o.targets) || !o.shots.empty() ||
           !o.seedFile.empty() || !o.targetFile.empty() || !o.seedCurves.empty() ||
           !o.pairs.empty() || std::any_of(o.vias.begin(), o.vias.end(), [](const Via& via) {
               return via.curve.points.empty() || hasCoordinates(via.curve.points);
           });
}

/// Whether points are moved onto the surface.
bool movesPoints(const RunOptions& o) {
    return !o.seeds.empty() || !o.seedFile.empty() || !o.seedCurves.empty() || o.hasTargets() ||
           !o.pairs.empty() || !o.shots.empty() || !o.vias.empty();
}

}  // namespace

void checkSeeds(const RunOptions& o, const igeo::Seeds& seeds) {
    if (!seeds.groups.empty() && o.asked(Grid::LogMap))
        usageError("--grids logmap does not go with groups of seeds",
                   "polar coordinates are those about a point");
}

void checkResults(const RunOptions& o) {
    for (const ResultKind& kind : resultKinds()) {
        if (kind.file(o, nullptr).empty()) continue;
        if (kind.needs.seeds && !o.hasSeeds())
            usageError(std::string(kind.option) + " needs distances, but no seed is given",
                       "add --seed x,y,z; without seeds only --paths, --pairs-out, --image, "
                       "--view and --report are written");
        requireTogether(kind, o);
    }
    checkGrids(o);
    if (o.matrixRows && endingOf(o.matrix) != ".json")
        usageError("--matrix-rows without --matrix FILE.json",
                   "parts are written as JSON; batch merge --matrix makes any format of them");
}

std::vector<WithoutEffect> optionsWithoutEffect(const RunOptions& o) {
    const bool grids = !o.grids.empty(), drawn = !o.image.empty() || !o.view.empty();
    const bool lines = drawn || !o.isolines.empty() || o.asked(Grid::Engraved);
    const bool marches = o.hasSeeds() || !o.pairs.empty() || !o.vias.empty();
    const char* const marchers = "a seed, --pairs or --via";
    const bool curved = o.weightCurvature || o.metricCurvature || o.asked(Grid::Curvature);
    const struct {
        bool given, used;
        const char *option, *users;
    } modifiers[] = {
        {o.extend, o.hasSeeds(), "--extend", "a seed"},
        {!o.name.empty(), o.hasSeeds(), "--name", "a seed"},
        {grids, o.hasSeeds(), "--grids", "a seed"},
        {!o.targets.empty(), o.hasSeeds(), "--target", "a seed"},
        {!o.targetFile.empty(), o.hasSeeds(), "--targets", "a seed"},
        {!o.paths.empty(),
         o.hasTargets() || !o.shots.empty() || !o.pairs.empty() || !o.vias.empty(), "--paths",
         "--target, --targets, --pairs, --via or --shoot"},
        {o.straighten, o.hasTargets() || !o.vias.empty() || (!o.pairs.empty() && !o.paths.empty()),
         "--straighten", "--target, --targets, --via, or --pairs with --paths"},
        {o.pathStep > 0, !o.paths.empty(), "--path-step", "--paths"},
        {o.pathOffset.has_value(), !o.paths.empty(), "--path-offset", "--paths"},
        {o.skipOffSurface, o.hasTargets() || !o.pairs.empty(), "--skip-off-surface",
         "--target, --targets or --pairs"},
        {o.stopAtTargets, o.hasTargets(), "--stop-at-targets", "--target or --targets"},
        {o.maxDistance > 0, o.hasSeeds(), "--max-distance", "a seed"},
        {o.levels > 0, lines, "--levels", "--isolines, --image, --view or --grids engraved"},
        {o.spacing > 0, lines, "--spacing", "--isolines, --image, --view or --grids engraved"},
        {!o.pairsOut.empty(), !o.pairs.empty(), "--pairs-out", "--pairs"},
        {o.imageSize.has_value(), !o.image.empty(), "--image-size", "--image"},
        {o.camera.has_value(), drawn, "--camera", "--image or --view"},
        {o.background.has_value(), !o.image.empty(), "--background", "--image"},
        {!o.unit.empty(), drawn, "--unit", "--image or --view"},
        {o.up.has_value(), drawn || endingOf(o.meshOut) == ".glb", "--up",
         "--image, --view or --mesh-out FILE.glb"},
        {o.perSeed, !o.perVertex.empty() && endingOf(o.perVertex) != ".obj", "--per-seed",
         "--per-vertex FILE that holds columns (.csv .npy .npz .ply .vtp .gii)"},
        {!o.colorMap.empty(), drawn || o.asked(Grid::Color) || colorsMesh(o), "--color-map",
         "--image, --view, --grids color, or --mesh-out or --per-vertex FILE that holds colors "
         "(.ply .obj, of --mesh-out also .glb)"},
        {o.space == igeo::Space::Index, hasCoordinates(o), "--space", "a point given by x,y,z"},
        {o.snap.has_value(), movesPoints(o), "--snap",
         "a point to move: of seeds, curves, targets, --pairs, --shoot or --via"},
        // Points become another surface for godunov.
        {o.scheme == igeo::Scheme::Godunov, o.hasSeeds() || o.kind == SurfaceKind::Points,
         "--scheme", "a seed"},
        {!o.weights.empty(), marches, "--weight", marchers},
        {o.weightCurvature.has_value(), marches, "--weight-curvature", marchers},
        {o.weightSlope.has_value(), marches, "--weight-slope", marchers},
        {o.metric.has_value(), marches, "--metric", marchers},
        {o.metricCurvature.has_value(), marches, "--metric-curvature", marchers},
        {!o.obstacles.empty(), marches, "--obstacle", marchers},
        {!o.obstacleSpheres.empty(), marches, "--obstacle-sphere", marchers},
        {!o.obstacleBoxes.empty(), marches, "--obstacle-box", marchers},
        {o.order.has_value(), o.scheme == igeo::Scheme::Godunov, "--order", "--scheme godunov"},
        {o.curvatureScale > 0, curved, "--curvature-scale",
         "--weight-curvature, --metric-curvature or --grids curvature"}};
    std::vector<WithoutEffect> found;
    for (const auto& m : modifiers)
        if (m.given && !m.used) found.push_back({m.option, m.users});
    return found;
}

void WithoutEffect::refuse() const {
    usageError(option + " has no effect without " + users, "add that, or leave it out");
}

void refuseWithoutEffect(const RunOptions& o) {
    for (const WithoutEffect& w : optionsWithoutEffect(o)) w.refuse();
}

void checkFiles(const RunOptions& o) {
    const std::vector<std::string> inputs = inputFiles(o);
    if (const auto n = std::count(inputs.begin(), inputs.end(), "-"); n > 1)
        usageError(
            "standard input is named for " + std::to_string(n) + " inputs, and can be read once",
            "give the others as files");
    checkOutputFiles(askedFiles(o), inputs);
}

void checkFileOfGrid(const RunOptions& o, const std::string& grid) {
    if (o.source.file == "-") checkOutputFiles(askedFiles(o, &grid), inputFiles(o));
}

std::vector<std::string> outputFiles(const RunOptions& o) {
    std::vector<std::string> files;
    for (const OutputFile& output : askedFiles(o)) files.push_back(output.file);
    return files;
}
