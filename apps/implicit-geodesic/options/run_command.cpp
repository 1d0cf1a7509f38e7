#include "options/run_command.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <utility>

#include "output/result_checks.h"
#include "process.h"
#include "usage_error.h"

namespace {

void checkSurface(const RunOptions& o) {
    if (o.kind == SurfaceKind::None || o.source.file.empty())
        usageError("no surface is given",
                   "name a .vdb, mesh, point or volume file, or add --sdf, --mesh, --points or "
                   "--volume; see implicit-geodesic --help");
    const bool volume = o.kind == SurfaceKind::Volume;
    if (volume && (o.voxelSize > 0 || o.resolution > 0))
        usageError("--voxel-size and --resolution are for meshes and points",
                   "a volume has a fixed voxel size: leave them out");
    if (!volume && o.rebuild)
        usageError("--rebuild is for level sets, and " + o.source.text() + " is none",
                   "leave it out: other surfaces need no signed distance");
    if (o.iso && !o.rebuild && o.kind != SurfaceKind::VoxelVolume)
        usageError("--iso needs --rebuild or --volume", "add one of them, or leave --iso out");
    if (o.kind != SurfaceKind::Mesh && o.joinGaps > 0)
        usageError("--join-gaps is for meshes, and " + o.source.text() + " is none",
                   "leave it out");
    if (o.joinGaps > 0 && o.scheme == igeo::Scheme::Godunov)
        usageError("--join-gaps is for scheme jet, and --scheme is godunov",
                   "leave out one of the two");
}

/// Refuses standard input and pipes where they are not read.
void checkIsFile(const RunOptions& o) {
    const std::string& file = o.source.file;
    const std::string given = optionFor(o.kind) + " " + file;
    std::error_code ignored;
    const bool isPipe = std::filesystem::is_fifo(file, ignored), isInput = file == "-";
    if (o.kind == SurfaceKind::Volume && isPipe)
        usageError(given + ": this is a pipe, and grids are read from files and standard input",
                   "write --sdf - and give the file on standard input, or name the file");
    if (o.kind != SurfaceKind::Volume &&
        (isInput || (isPipe && !std::filesystem::path(file).has_extension())))
        usageError(given + ": " + (isInput ? "standard input" : "this pipe") +
                       " has no ending, which tells the format",
                   "write it into a file with the ending of its format, and name that; only --sdf "
                   "reads standard input");
}

/// Refuses a kind of surface that contradicts the name of the file.
void checkKind(const RunOptions& o) {
    checkIsFile(o);
    const std::string file = o.source.text();
    const SurfaceKind byName = kindByName(o.source.file);
    const auto refuse = [&](const std::string& given, const char* what, const std::string& remedy) {
        usageError(given + " " + file + ": its ending is that of " + what, "write " + remedy);
    };
    if (o.kind == SurfaceKind::VoxelVolume && file.ends_with(".vdb"))
        refuse("--volume", "a VDB file", "--sdf " + file + " --rebuild --iso V");
    if (o.kind != SurfaceKind::VoxelVolume && byName == SurfaceKind::VoxelVolume)
        refuse(optionFor(o.kind), "a volume of voxels", "--volume " + file + " --iso V");
    if (o.kind != SurfaceKind::Volume) return;
    if (byName == SurfaceKind::Mesh) refuse("--sdf", "a mesh", "--mesh " + file);
    if (byName == SurfaceKind::Points) refuse("--sdf", "points", "--points " + file);
}

void checkSeeds(const RunOptions& o) {
    if (!o.hasSeeds() && o.pairs.empty() && o.shots.empty() && o.vias.empty())
        usageError("no seed is given", "add --seed x,y,z, --seeds FILE or --sample K");
    const bool hasPoints = !o.seeds.empty() || !o.seedFile.empty() || o.sample > 0;
    if (o.withSign && (hasPoints || o.seedCurves.empty() == o.seedMasks.empty()))
        usageError("--signed needs closed curves or masks, and seeds of one kind only",
                   "give either --seed-curve or --seed-mask, and no other seed");
}

/// Refuses options that contradict each other, whatever the content of the files.
void checkTogether(const RunOptions& options) {
    checkSurface(options);
    checkKind(options);
    checkSeeds(options);
    checkResults(options);
}

/// GiB; with a unit kB, MB, GB, TB (powers of 1000) or KiB, MiB, GiB, TiB.
double gibibytesOf(const std::string& word) {
    const std::size_t letters = std::min(word.find_first_not_of("0123456789.eE+-"), word.size());
    std::string unit = word.substr(letters);
    const std::optional<double> number = numberOf(word.substr(0, letters));
    double bytes = kGiB;
    if (!unit.empty()) {
        const double base = unit.size() == 3 && unit[1] == 'i' ? 1024 : 1000;
        if (base == 1024) unit.erase(1, 1);
        const std::size_t power = std::string("KMGT").find(char(std::toupper(unit[0])));
        const bool known =
            power != std::string::npos && unit.size() == 2 && std::toupper(unit[1]) == 'B';
        bytes = known ? std::pow(base, double(power + 1)) : 0;
    }
    if (!number || !(*number > 0) || bytes == 0)
        usageError("'" + word + "' is no amount of memory above 0",
                   "write GiB, as 4, or a unit, as 500MB or 4GiB");
    return *number * bytes / kGiB;
}

/// Sets the brief texts of -h, for the options used most.
void describeBriefly(Command& command) {
    const std::pair<const char*, const char*> words[] = {
        {"--seed", "distance 0 here; on meshes also vertex:123, +x"},
        {"--seeds", "seeds from a .json or .csv file"},
        {"--target", "where a path to the nearest seed starts"},
        {"--targets", "targets from a .json or .csv file"},
        {"--max-distance", "stop beyond this distance"},
        {"--voxel-size", "of a mesh or points [longest side / 256]"},
        {"--weight", "cost per unit length: a float grid, or per vertex"},
        {"--obstacle", "where no path may go: a mask, a level set"},
        {"--output", "distances [<sdf>_geodesic.vdb, here]"},
        {"--grids", "more in it: gradient, label, color, logmap, ..."},
        {"--paths", "paths: .json .csv .obj .ply .vtp .usda"},
        {"--isolines", "lines of equal distance, in the same formats"},
        {"--mesh-out", "the surface with distances: .ply .vtp .glb .obj"},
        {"--per-vertex", "distances at the mesh's vertices: .csv .npz .gii ..."},
        {"--matrix", "from all seeds to all targets: .csv .json .npy"},
        {"--image", "a picture"},
        {"--report", "what was done, as JSON"}};
    for (Option& option : command.options)
        for (const auto& [name, brief] : words)
            if (option.longName() == name) option.brief = brief;
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
    command.add("Run",
                {{.names = {"--memory-limit"},
                  .value = "G",
                  .text = "Refuse work that needs more memory, before it begins: GiB, or with a "
                          "unit, as 500MB or 4GiB [what the machine has]",
                  .reads = parsed(o.memoryLimit, gibibytesOf)}});
    command.check = [&o] { checkTogether(o); };
    return command;
}

Command runCommand(RunOptions& o) {
    Command command = jobCommand(o);
    addSurfaceArgument(command, o);
    // Not in a batch: options for all of its jobs need not have an effect on each.
    command.check = [&o] {
        checkTogether(o);
        refuseWithoutEffect(o);
    };
    addProcessOptions(command, o);
    command.add("Run", {helpOption(), versionOption()});
    describeBriefly(command);
    command.about =
        "Geodesic distances and shortest paths along a surface: a signed-distance volume, a mesh "
        "or points.\n"
        "Lengths are in world units of the surface; defaults are in brackets.";
    command.exitCodes = {{0, "done"},
                         {1, "failed"},
                         {2, "wrong usage"},
                         {3, "unusable input or output"},
                         {4, "done, but a target, pair or --via is unreached"},
                         {130, "interrupted"}};
    command.examples = {
        {"implicit-geodesic data/trefoil.vdb --seed 0,-0.42,0",
         "distances along the surface, in trefoil_geodesic.vdb"},
        {"implicit-geodesic --sdf data/sphere.vdb --seed 0,0,1 --target 0.6,0,-0.8 --paths "
         "path.json",
         "the geodesic between two points; its length is printed and in path.json"},
        {"implicit-geodesic --sdf data/torus.vdb --seeds data/torus_seeds.csv --max-distance 0.2 "
         "-o near.vdb --report -",
         "distances up to 0.2 from the nearest of several seeds; the report goes to stdout"}};
    return command;
}
