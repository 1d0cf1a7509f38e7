#include "options/run_command.h"

#include <utility>

#include "output/result_checks.h"
#include "usage_error.h"

namespace {

void checkSurface(const RunOptions& o) {
    if (o.kind == SurfaceKind::None || o.source.file.empty())
        usageError(
            "no surface is given",
            "add --sdf FILE.vdb, --mesh FILE or --points FILE; see implicit-geodesic --help");
    if (o.joinGaps > 0 && o.scheme == igeo::Scheme::Godunov)
        usageError("--join-gaps is for scheme jet, and --scheme is godunov",
                   "leave out one of the two");
}

void checkSeeds(const RunOptions& o) {
    if (!o.hasSeeds() && o.pairs.empty() && o.shots.empty())
        usageError("no seed is given", "add --seed x,y,z, --seeds FILE or --sample K");
    const bool hasPoints = !o.seeds.empty() || !o.seedFile.empty() || o.sample > 0;
    if (o.withSign && (hasPoints || o.seedCurves.empty() == o.seedMasks.empty()))
        usageError("--signed needs closed curves or masks, and seeds of one kind only",
                   "give either --seed-curve or --seed-mask, and no other seed");
}

/// Refuses what options say against each other, which no file can mend.
void checkTogether(const RunOptions& options) {
    checkSurface(options);
    checkSeeds(options);
    checkResults(options);
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
    // A batch has options for all of its jobs, which need not matter to each.
    command.check = [&o] {
        checkTogether(o);
        refuseWithoutEffect(o);
    };
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
