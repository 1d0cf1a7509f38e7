#include "options/run_options.h"

#include <utility>

#include "file_ending.h"
#include "options/command.h"
#include "usage_error.h"

namespace {

void checkSurface(const RunOptions& o) {
    if (o.kind == SurfaceKind::None || o.source.file.empty())
        usageError(
            "no surface is given",
            "add --sdf FILE.vdb, --mesh FILE or --points FILE; see implicit-geodesic --help");
}

void checkSeeds(const RunOptions& o) {
    if (!o.hasSeeds() && o.pairs.empty() && o.shots.empty())
        usageError("no seed is given", "add --seed x,y,z, --seeds FILE or --sample K");
    if (!o.hasSeeds() && o.needsSeeds())
        usageError(
            "results that need distances are asked for, but no seed is given",
            "add --seed x,y,z; without seeds only --paths, --pairs-out, --image and --report "
            "are written");
    const bool hasPoints = !o.seeds.empty() || !o.seedFile.empty() || o.sample > 0;
    if (o.withSign && (hasPoints || o.seedCurves.empty() == o.seedMasks.empty()))
        usageError("--signed needs closed curves or masks, and seeds of one kind only",
                   "give either --seed-curve or --seed-mask, and no other seed");
}

void checkScheme(const RunOptions& o) {
    if (o.scheme == Scheme::Jet) return;
    // Each row and each pair is a march of its own, for which only jet is quick and exact enough.
    const char* const many = !o.pairs.empty() ? "--pairs" : !o.matrix.empty() ? "--matrix" : "";
    if (*many)
        usageError(
            std::string(many) + " is marched with jet, and --scheme " + nameOf(o.scheme) +
                " is asked for",
            "leave --scheme out; for distances by godunov take a run per seed, whose --report "
            "has those of its targets");
    for (const auto& [grid, name] : {std::pair(Grid::Label, "label"), {Grid::LogMap, "logmap"}})
        if (o.asked(grid))
            usageError(std::string("--grids ") + name + " needs --scheme jet",
                       "godunov does not know where a front came from");
}

void checkTables(const RunOptions& o) {
    if (o.matrixRows && endingOf(o.matrix) != ".json")
        usageError("--matrix-rows without --matrix FILE.json",
                   "parts are written as JSON; batch merge --matrix makes any format of them");
    if (!o.matrix.empty() && o.hasExtendedSeeds())
        usageError("--matrix does not go with --seed-curve and --seed-mask",
                   "a matrix is made of distances between points");
    if (!o.pairsOut.empty() && o.pairs.empty())
        usageError("--pairs-out without --pairs", "add --pairs FILE");
}

void checkLogMap(const RunOptions& o) {
    if (!o.asked(Grid::LogMap)) return;
    if (o.hasTensor())
        usageError("--grids logmap does not go with tensors (--metric, --metric-curvature)",
                   "the logarithmic map is known for weights only");
    if (o.hasExtendedSeeds())
        usageError("--grids logmap does not go with --seed-curve and --seed-mask",
                   "polar coordinates are those about a point");
}

/// Refuses what options say against each other, which no file can mend.
void checkTogether(const RunOptions& options) {
    checkSurface(options);
    checkSeeds(options);
    checkScheme(options);
    checkTables(options);
    checkLogMap(options);
}

}  // namespace

Command jobCommand(RunOptions& o) {
    Command command{.name = "implicit-geodesic", .about = ""};
    addSurfaceOptions(command, o);
    addBandOptions(command, o);
    addSeedOptions(command, o);
    addMetricOptions(command, o);
    addSchemeOptions(command, o);
    addResultOptions(command, o);
    addPictureOptions(command, o);
    addReportOption(command, o);
    command.add("Run", {{.names = {"--memory-limit"},
                         .value = "G",
                         .text = "Refuse what needs more memory, before it is taken, GiB [what the "
                                 "machine has]",
                         .reads = numberAboveZero(o.memoryLimit)}});
    command.check = [&o] { checkTogether(o); };
    return command;
}

Command runCommand(RunOptions& o) {
    Command command = jobCommand(o);
    addProcessOptions(command, o);
    command.add("Run", {helpOption(), versionOption()});
    command.about =
        "How far is it, and which way, along a surface: a signed-distance volume, a mesh or "
        "points.\n"
        "Lengths are in world units of the surface; defaults are in brackets.";
    command.exitCodes = {{0, "done"},
                         {1, "failed"},
                         {2, "wrong usage"},
                         {3, "unusable input or output"},
                         {4, "done, but a target is unreached"},
                         {130, "interrupted"}};
    command.examples = {
        {"implicit-geodesic --sdf data/trefoil.vdb --seed 0,-0.42,0",
         "distances along the surface, in trefoil_geodesic.vdb"},
        {"implicit-geodesic --sdf data/sphere.vdb --seed 0,0,1 --target 0.6,0,-0.8 --paths "
         "path.json",
         "the geodesic between two points; its length is printed and in path.json"},
        {"implicit-geodesic --sdf data/torus.vdb --seeds data/torus_seeds.csv --max-distance 0.2 "
         "-o near.vdb --report -",
         "distances up to 0.2 from the nearest of several seeds; the report goes to stdout"}};
    return command;
}
