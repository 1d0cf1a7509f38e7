#include "options.h"

#include <igeo/results/color_map.h>
#include <CLI/CLI.hpp>

#include <charconv>
#include <cmath>
#include <cstdlib>
#include <iostream>
#include <set>
#include <sstream>

#include "command_description.h"
#include "results.h"
#include "usage_error.h"
#include "version_text.h"

namespace {

const char* const kProgram = "implicit-geodesic";

/// What the description of a command ends with.
struct Ending {
    const char* command;
    std::vector<ExitCode> exitCodes;
    std::vector<Example> examples;
};

const Ending kEndings[] = {
    {"implicit-geodesic",
     {{0, "done"},
      {1, "failed"},
      {2, "wrong usage"},
      {3, "unusable input or output"},
      {4, "done, but a target is unreached"},
      {130, "interrupted"}},
     {{"implicit-geodesic --sdf data/trefoil.vdb --seed 0,-0.42,0",
       "distances along the surface, in trefoil_geodesic.vdb"},
      {"implicit-geodesic --sdf data/sphere.vdb --seed 0,0,1 --target 0.6,0,-0.8 --paths path.json",
       "the geodesic between two points; its length is printed and in path.json"},
      {"implicit-geodesic --sdf data/torus.vdb --seeds data/torus_seeds.csv --max-distance 0.2 "
       "-o near.vdb --report -",
       "distances up to 0.2 from the nearest of several seeds; the report goes to stdout"}}},
    {"implicit-geodesic info",
     {{0, "usable"}, {1, "failed"}, {2, "wrong usage"}, {3, "not usable"}, {130, "interrupted"}},
     {{"implicit-geodesic info data/torus.vdb", "whether the torus will do"},
      {"implicit-geodesic info data/box.vdb --unreliable unreliable.vdb",
       "where results on a box are unreliable: along its edges"},
      {"implicit-geodesic info model.obj --resolution 400",
       "whether voxels of 1/400 of a mesh's longest side show all of it"}}},
    {"implicit-geodesic batch",
     {{0, "all jobs are done"},
      {1, "failed; of several jobs that failed, the largest code counts"},
      {2, "wrong usage"},
      {3, "unusable input or output"},
      {4, "all jobs are done, but a target is unreached"},
      {130, "interrupted"}},
     {{"implicit-geodesic batch jobs.json",
       "all jobs of jobs.json; once more after an interruption: those that are left"},
      {"implicit-geodesic batch jobs.json --shard 2/8 --threads 1",
       "the second of eight parts of them, for eight processes on any machines"}}},
    {"implicit-geodesic batch merge",
     {{0, "all jobs are done"},
      {1, "failed, or the largest code of a job that failed"},
      {2, "wrong usage"},
      {3, "unusable or incomplete input"},
      {4, "all jobs are done, but a target is unreached"}},
     {{"implicit-geodesic batch merge jobs.summary-1-of-2.json jobs.summary-2-of-2.json "
       "-o jobs.summary.json",
       "one summary of both shards"},
      {"implicit-geodesic batch merge --matrix rows-1.json rows-2.json -o distances.npy",
       "one matrix of the parts that --matrix-rows 1/2 and 2/2 wrote"}}}};

// Checks of values are our own: those of CLI11 say what they take in other words from version to
// version, and let "nan" pass. describe() reads the names and descriptions of these.
constexpr const char* kChoices = "choices";
constexpr const char* kRange = "range";

CLI::Validator number(bool mayBeZero) {
    const std::string range = mayBeZero ? "at least 0" : "above 0";
    auto check = [=](std::string& text) {
        char* end = nullptr;
        const double v = std::strtod(text.c_str(), &end);
        const bool good = end != text.c_str() && *end == '\0' && std::isfinite(v);
        return good && (v > 0 || (mayBeZero && v == 0)) ? std::string()
                                                        : text + " is no number " + range;
    };
    return {check, range, kRange};
}

CLI::Validator wholeNumber(long least, long most) {
    const std::string range = std::to_string(least) + " to " + std::to_string(most);
    auto check = [=](std::string& text) {
        long v = 0;
        const char* end = text.data() + text.size();
        const auto [stop, error] = std::from_chars(text.data(), end, v);
        const bool good = error == std::errc() && stop == end && least <= v && v <= most;
        return good ? std::string() : text + " is no whole number from " + range;
    };
    return {check, range, kRange};
}

std::string listOf(const std::vector<std::string>& choices) {
    std::string list;
    for (const std::string& choice : choices) list += (list.empty() ? "" : ",") + choice;
    return list;
}

CLI::Validator oneOf(const std::vector<std::string>& choices) {
    const std::string list = listOf(choices);
    auto check = [=](std::string& text) {
        const bool good = std::count(choices.begin(), choices.end(), text) > 0;
        return good ? std::string() : text + " is none of " + list;
    };
    return {check, list, kChoices};
}

/// What a value begins with; metric_input.cpp checks the whole of it.
CLI::Validator firstOf(const std::vector<std::string>& choices) {
    return {[](std::string&) { return std::string(); }, listOf(choices), kChoices};
}

void addRunOptions(CLI::App& app, Options& o) {
    app.add_option("--threads", o.threads, "Threads; 0 uses all cores [0]")
        ->type_name("N")
        ->check(wholeNumber(0, 4096))
        ->group("Run");
    app.add_option("--progress", o.progress,
                   "Progress on stderr: auto (if it is a terminal), always, never [auto]")
        ->type_name("WHEN")
        ->check(oneOf({"auto", "always", "never"}))
        ->group("Run");
    app.add_flag("-q,--quiet", o.quiet, "Print errors only")->group("Run");
    app.add_flag("-v,--verbose", o.verbose, "Print what was found and how long it took")
        ->group("Run");
}

void addHelp(CLI::App& app) {
    // Last, so that the help begins with what the program is for.
    app.set_help_flag("-h,--help", "Print this help")->group("Run");
}

std::array<CLI::Option*, 2> addVoxelSize(CLI::App& app, Options& o) {
    auto* size = app.add_option("--voxel-size", o.voxelSize,
                                "Of a mesh or points, world units [longest side / 256; points: "
                                "half their spacing]")
                     ->type_name("S")
                     ->check(number(/*mayBeZero=*/false))
                     ->group("Surface");
    auto* resolution =
        app.add_option("--resolution", o.resolution, "The same as voxels along the longest side")
            ->type_name("N")
            ->check(wholeNumber(8, 1 << 20))
            ->excludes(size)
            ->group("Surface");
    return {size, resolution};
}

/// Nothing of the main job goes with a subcommand.
void beFirst(const CLI::App& app, CLI::App& command) {
    command.preparse_callback([&app, &command](std::size_t) {
        for (const CLI::Option* option : app.get_options())
            if (option->count() > 0)
                throw CLI::ExcludesError(command.get_name() + " goes before all options, and " +
                                             option->get_name() + " stands before it",
                                         CLI::ExitCodes::ExcludesError);
    });
}

/// The subcommand `info`.
void addInfo(CLI::App& app, Options& o) {
    CLI::App* info = app.add_subcommand(
        "info",
        "What a file holds, whether it will do as a surface, and what a run on it would take");
    info->add_option(
            "FILE", o.sdf,
            "A volume and a grid of it, a mesh or points: .vdb .obj .ply .stl .off .gltf .glb "
            ".xyz .csv .txt")
        ->type_name("[:GRID]")
        ->required();
    addVoxelSize(*info, o);
    info->add_flag("--json", o.infoJson, "Print JSON (docs/info.schema.json)")->group("Results");
    info->add_option("--unreliable", o.problems,
                     "Where results are unreliable, as a grid: 1 where a bound is just met, larger "
                     "is worse")
        ->type_name("FILE.vdb")
        ->group("Results");
    addRunOptions(*info, o);
    addHelp(*info);
    beFirst(app, *info);
    info->callback([&o] { o.info = true; });
}

/// The subcommand `batch merge`.
void addMerge(CLI::App& batch, Options& o) {
    CLI::App* merge = batch.add_subcommand(
        "merge", "Joins the summaries of all shards of a batch into one, or the parts of a matrix");
    merge->add_option("PARTS", o.batch.parts, "Summaries, or with --matrix parts; .json")
        ->type_name("")
        ->required();
    merge->add_option("-o,--output", o.batch.output, "Where the whole goes; - is stdout [-]")
        ->type_name("FILE")
        ->group("Results");
    merge
        ->add_flag("--matrix", o.batch.matrix,
                   "Join parts of a matrix, as --matrix-rows writes them: to .csv, .json or .npy")
        ->group("Results");
    addHelp(*merge);
    beFirst(batch, *merge);
    merge->callback([&o] { o.batch.merge = true; });
}

/// The subcommand `batch`.
void addBatch(CLI::App& app, Options& o) {
    CLI::App* batch =
        app.add_subcommand("batch", "Many jobs in one go; what is done already is not done again");
    batch->add_option("JOBS", o.batch.manifest, "The jobs (docs/batch.schema.json); .json")
        ->type_name("");
    batch
        ->add_option("--shard", o.batch.shard,
                     "Only the K-th of N parts of the jobs; all N are the whole")
        ->type_name("K/N")
        ->group("Jobs");
    batch
        ->add_option("--summary", o.batch.summary,
                     "What became of each job, as JSON [beside the jobs: jobs.summary.json]")
        ->type_name("FILE")
        ->group("Jobs");
    batch
        ->add_flag("--dry-run", o.batch.dryRun,
                   "Check all, and print each job, whether it is to do, and its command")
        ->group("Jobs");
    addRunOptions(*batch, o);
    addHelp(*batch);
    beFirst(app, *batch);
    batch->callback([&o] { o.batch.asked = true; });
    addMerge(*batch, o);
}

void addOptions(CLI::App& app, Options& o) {
    const char* surface = "Surface";
    auto* sdf =
        app.add_option(
               "--sdf", o.sdf,
               "Level set to walk on: a .vdb file, its grid if it holds several; - reads stdin")
            ->type_name("FILE[:GRID]")
            ->group(surface);
    auto* mesh = app.add_option("--mesh", o.mesh,
                                "Instead: triangles or polygons, open or closed; .obj .ply .stl "
                                ".off .gltf .glb")
                     ->type_name("FILE")
                     ->excludes(sdf)
                     ->group(surface);
    app.add_option("--points", o.points,
                   "Instead: points on a surface, with or without normals; .ply .xyz .csv .txt "
                   ".obj or points in a .vdb")
        ->type_name("FILE")
        ->excludes(sdf)
        ->excludes(mesh)
        ->group(surface);
    for (CLI::Option* size : addVoxelSize(app, o)) size->excludes(sdf);
    auto* rebuild =
        app.add_flag("--rebuild", o.rebuild,
                     "Make a signed distance of a volume that is none: a fog volume, another "
                     "function, an unsigned distance")
            ->needs(sdf)
            ->group(surface);
    app.add_option_function<double>(
           "--iso", [&o](const double& v) { o.iso = v; },
           "The value that is the surface, for --rebuild [0; fog: 0.5]")
        ->type_name("V")
        ->needs(rebuild)
        ->group(surface);

    auto* band = app.add_option("--band", o.band,
                                "Half-width h of the band |psi| < h, world units; at least sqrt(3) "
                                "voxels, less than the smallest radius of curvature [jet: sqrt(3) "
                                "voxels, godunov: from curvature]")
                     ->type_name("H")
                     ->check(number(/*mayBeZero=*/false))
                     ->group("Band");
    app.add_option("--band-voxels", o.bandVoxels, "The same in voxels")
        ->type_name("N")
        ->check(number(/*mayBeZero=*/false))
        ->excludes(band)
        ->group("Band");

    const char* seeds = "Seeds and targets";
    app.add_option("--seed", o.seeds, "Where the distance is 0; repeat for several")
        ->type_name("X,Y,Z")
        ->allow_extra_args(false)
        ->group(seeds);
    app.add_option("--seeds", o.seedFile,
                   "Seeds from a .json or .csv file: x,y,z and, if given, a start distance")
        ->type_name("FILE")
        ->group(seeds);
    app.add_option("--seed-curve", o.seedCurves,
                   "Distance 0 along polylines on the surface: .json (also --isolines and --paths "
                   "of another run) or .csv; repeatable")
        ->type_name("FILE")
        ->allow_extra_args(false)
        ->group(seeds);
    app.add_option("--seed-mask", o.seedMasks,
                   "Distance 0 on the part of the surface inside a mask, level set or fog volume; "
                   "repeatable")
        ->type_name("FILE[:GRID]")
        ->allow_extra_args(false)
        ->group(seeds);
    app.add_flag("--signed", o.withSign,
                 "Negative distances inside masks, and on the smaller side of closed curves")
        ->group(seeds);
    app.add_option("--target", o.targets, "Where a geodesic to the nearest seed starts; repeatable")
        ->type_name("X,Y,Z")
        ->allow_extra_args(false)
        ->group(seeds);
    app.add_option("--targets", o.targetFile, "Targets from a .json or .csv file")
        ->type_name("FILE")
        ->group(seeds);
    app.add_option_function<std::string>(
           "--space", [&o](const std::string& s) { o.indexSpace = s == "index"; },
           "Space of seeds and targets: world or index [world]")
        ->type_name("SPACE")
        ->check(oneOf({"world", "index"}))
        ->group(seeds);
    app.add_option("--snap", o.snap,
                   "How far a seed or target may be from the surface, world units [the half-width "
                   "of the level set]")
        ->type_name("D")
        ->check(number(/*mayBeZero=*/true))
        ->group(seeds);
    app.add_option("--sample", o.sample, "Add so many seeds, each as far from all others as can be")
        ->type_name("K")
        ->check(wholeNumber(1, 1000000))
        ->group(seeds);
    app.add_flag("--stop-at-targets", o.stopAtTargets, "Stop once all targets are reached")
        ->group(seeds);
    app.add_option("--max-distance", o.maxDistance,
                   "Stop beyond this distance, world units times weight")
        ->type_name("D")
        ->check(number(/*mayBeZero=*/false))
        ->group(seeds);

    app.add_option("--pairs", o.pairs,
                   "Distances between pairs of points, each found near by; from a .json or .csv "
                   "file of x,y,z,x,y,z; needs no seed")
        ->type_name("FILE")
        ->group(seeds);
    app.add_option("--shoot", o.shoots,
                   "Walk straight on (a geodesic) from a point in a direction for a length, world "
                   "units; for --paths and --image; needs no seed; repeatable")
        ->type_name("X,Y,Z,DX,DY,DZ,L")
        ->allow_extra_args(false)
        ->group(seeds);

    const char* metric = "Metric";
    app.add_option("--weight", o.weights,
                   "Cost per unit length: a positive float grid of its own resolution, sampled on "
                   "the surface; several multiply")
        ->type_name("FILE[:GRID]")
        ->allow_extra_args(false)
        ->group(metric);
    app.add_option("--weight-curvature", o.weightCurvature,
                   "Cost from curvature: cheap in a valley, along a crest, or where mean, gaussian "
                   "or principal curvature is small [eps=100,p=3]")
        ->type_name("KIND[,eps=E][,p=P]")
        ->check(firstOf({"valley", "crest", "mean", "gaussian", "principal"}))
        ->group(metric);
    app.add_option("--curvature-scale", o.curvatureScale,
                   "Radius over which curvature is averaged, voxels, 1 to 16 [2]")
        ->type_name("N")
        ->check(number(/*mayBeZero=*/false))
        ->group(metric);
    auto* bending =
        app.add_option("--metric-curvature", o.metricCurvature,
                       "Cost by direction: avoid bending with the surface, or prefer it; L is the "
                       "radius at which it counts, world units [length: 10 voxels]")
            ->type_name("avoid|prefer[,length=L]")
            ->check(firstOf({"avoid", "prefer"}))
            ->group(metric);
    app.add_option("--metric", o.metric,
                   "A tensor G, cost sqrt(G[v, v]) of a step v, in world axes: vector grids "
                   "PREFIXdiagonal (xx, yy, zz) and PREFIXoffdiagonal (xy, xz, yz)")
        ->type_name("FILE[:PREFIX]")
        ->excludes(bending)
        ->group(metric);
    app.add_option("--obstacle", o.obstacles,
                   "No way through: a mask (active voxels), a level set (inside) or a fog volume "
                   "(above 0.5)")
        ->type_name("FILE[:GRID]")
        ->allow_extra_args(false)
        ->group(metric);
    app.add_option("--obstacle-sphere", o.obstacleSpheres, "No way through a ball; repeatable")
        ->type_name("X,Y,Z,R")
        ->allow_extra_args(false)
        ->group(metric);
    app.add_option("--obstacle-box", o.obstacleBoxes,
                   "No way through a box given by two opposite corners; repeatable")
        ->type_name("X,Y,Z,X,Y,Z")
        ->allow_extra_args(false)
        ->group(metric);

    app.add_option("--scheme", o.scheme,
                   "How to solve: jet (value and gradient on foot points) or godunov (Memoli & "
                   "Sapiro 2001) [jet]")
        ->type_name("NAME")
        ->check(oneOf({"jet", "godunov"}))
        ->group("Scheme");
    app.add_option("--order", o.order, "Order of godunov's differences, 1 or 2 [2]")
        ->type_name("N")
        ->check(wholeNumber(1, 2))
        ->group("Scheme");

    const char* results = "Results";
    app.add_option("-o,--output", o.output,
                   "Distances as a VDB file; - writes to stdout [<sdf>_geodesic.vdb, here]")
        ->type_name("FILE.vdb")
        ->group(results);
    app.add_option("--grids", o.with,
                   "More grids in the output: surface (psi, first), gradient (of the distance), "
                   "label (nearest seed), color, logmap, weight, curvature, engraved (isolines and "
                   "paths cut into psi)")
        ->type_name("LIST")
        ->delimiter(',')
        ->allow_extra_args(false)
        ->check(oneOf(
            {"surface", "gradient", "label", "color", "logmap", "weight", "curvature", "engraved"}))
        ->group(results);
    app.add_flag("--extend", o.extend,
                 "Cover the whole narrow band of the level set, not only the band marched")
        ->group(results);
    app.add_option("--name", o.name, "Name of the distance grid [<psi>_geodesic]")
        ->type_name("GRID")
        ->group(results);
    app.add_option("--paths", o.paths,
                   "Geodesics from all targets, and walks of --shoot, as polylines: .json "
                   "(docs/geodesics.schema.json) or "
                   ".obj; - writes JSON to stdout")
        ->type_name("FILE")
        ->group(results);
    app.add_flag("--straighten", o.straighten,
                 "Relax the geodesics to locally shortest curves, free of the march's error")
        ->group(results);
    app.add_option(
           "--isolines", o.isolines,
           "Lines of equal distance on the surface: .json (docs/isolines.schema.json), .obj "
           "or .ply; - writes JSON to stdout")
        ->type_name("FILE")
        ->group(results);
    auto* levels = app.add_option("--levels", o.levels, "How many levels isolines have")
                       ->type_name("N")
                       ->check(wholeNumber(1, 100000))
                       ->group(results);
    app.add_option("--spacing", o.spacing,
                   "Distance between isolines, world units times weight [a round one, about 16 "
                   "lines]")
        ->type_name("D")
        ->check(number(/*mayBeZero=*/false))
        ->excludes(levels)
        ->group(results);
    app.add_option("--mesh-out", o.meshOut,
                   "The surface as triangles with distance, label and color: .ply or .obj; - "
                   "writes PLY to stdout")
        ->type_name("FILE")
        ->group(results);
    app.add_option("--matrix", o.matrix,
                   "All distances from seeds to targets, or between the seeds if there is no "
                   "target: .csv, .json or .npy; - writes CSV to stdout")
        ->type_name("FILE")
        ->group(results);

    app.add_option(
           "--matrix-rows", o.matrixRows,
           "Only the K-th of N parts of the rows, as .json; batch merge --matrix joins them")
        ->type_name("K/N")
        ->group(results);
    app.add_option("--pairs-out", o.pairsOut,
                   "Distances of --pairs: .csv or .json (docs/pairs.schema.json); - writes CSV to "
                   "stdout [-]")
        ->type_name("FILE")
        ->group(results);

    const char* picture = "Picture";
    app.add_option("--image", o.image, "The surface as a picture: distances, isolines, paths")
        ->type_name("FILE.png")
        ->group(picture);
    app.add_option("--image-size", o.imageSize, "In pixels [1280x960]")
        ->type_name("WxH")
        ->group(picture);
    app.add_option("--camera", o.camera,
                   "Where the camera is and what it looks at, world units [chosen; the middle]")
        ->type_name("X,Y,Z[,X,Y,Z]")
        ->group(picture);
    app.add_option_function<std::string>(
           "--up", [&o](const std::string& s) { o.upZ = s == "z"; },
           "The axis that points up: y or z [y]")
        ->type_name("AXIS")
        ->check(oneOf({"y", "z"}))
        ->group(picture);
    app.add_option("--color-map", o.colorMap,
                   "Colors of picture, mesh and color grid: viridis, magma, cividis, turbo, gray "
                   "[viridis]")
        ->type_name("NAME")
        ->check(oneOf(igeo::ColorMap::names()))
        ->group(picture);

    app.add_option("--report", o.json,
                   "Report: parameters, counts, snap distances, timings; - writes to stdout")
        ->type_name("FILE")
        ->group(results);
    app.add_option("--memory-limit", o.memoryLimit,
                   "Refuse what needs more memory, before it is taken, GiB [what the machine has]")
        ->type_name("G")
        ->check(number(/*mayBeZero=*/false))
        ->group("Run");
}

std::vector<std::string> split(const std::string& list) {
    std::vector<std::string> items;
    std::istringstream in(list);
    for (std::string item; std::getline(in, item, ',');) items.push_back(item);
    return items;
}

/// What `option` takes, as the check says that it has, and its value's name.
void describeValue(CLI::Option& option, OptionDescription& d) {
    if (option.get_type_size() == 0) return;  // a flag
    d.value = option.get_type_name();
    d.separator = option.get_delimiter();
    d.repeatable = option.get_expected_max() > 1;
    const CLI::Validator* check = nullptr;
    try {
        check = option.get_validator(0);
    } catch (const CLI::OptionNotFound&) {
        return;
    }
    const std::string taken = check->get_description();
    if (check->get_name() == kChoices)
        d.choices = split(taken);
    else if (check->get_name() == kRange)
        d.range = taken;
    else
        return;
    d.value.resize(d.value.size() - taken.size() - 1);  // CLI11 appends ":" and the description
}

OptionDescription describe(CLI::Option& option, const std::vector<CLI::Option*>& all) {
    OptionDescription d;
    for (const std::string& name : option.get_snames()) d.names.push_back("-" + name);
    for (const std::string& name : option.get_lnames()) d.names.push_back("--" + name);
    if (option.get_positional())
        d.names = {option.get_name(true)};
    else
        d.group = option.get_group();
    describeValue(option, d);
    d.required = option.get_required();
    // The sets of CLI11 are in the order of addresses.
    const std::set<CLI::Option*> needs = option.get_needs(), excludes = option.get_excludes();
    for (CLI::Option* other : all) {
        if (needs.count(other) > 0) d.needs.push_back(other->get_name());
        if (excludes.count(other) > 0) d.excludes.push_back(other->get_name());
    }
    d.text = option.get_description();
    return d;
}

CommandDescription describe(CLI::App& app, const std::string& name) {
    CommandDescription d;
    d.name = name;
    d.about = app.get_description();
    const std::vector<CLI::Option*> options = app.get_options();
    for (CLI::Option* option : options)
        (option->get_positional() ? d.arguments : d.options).push_back(describe(*option, options));
    for (const Ending& ending : kEndings)
        if (ending.command == name) {
            d.exitCodes = ending.exitCodes;
            d.examples = ending.examples;
        }
    for (CLI::App* command : app.get_subcommands([](CLI::App*) { return true; }))
        d.commands.push_back(describe(*command, name + " " + command->get_name()));
    return d;
}

/// The command that the command line names.
CommandDescription describeParsed(CLI::App& app) {
    CLI::App* command = &app;
    std::string name = kProgram;
    while (!command->get_subcommands().empty()) {
        command = command->get_subcommands().front();
        name += " " + command->get_name();
    }
    return describe(*command, name);
}

/// OpenVDB's tools spell their options with one dash: -help and -version work here as well.
std::vector<std::string> argumentsOf(int argc, char** argv) {
    std::vector<std::string> args(argv + 1, argv + argc);
    for (std::string& a : args)
        if (a == "-help" || a == "-version") a = "-" + a;
    std::reverse(args.begin(), args.end());  // CLI11 takes them last first
    return args;
}

}  // namespace

ParseResult parseOptions(int argc, char** argv, Options& options) {
    CLI::App app{
        "How far is it, and which way, along a surface: a signed-distance volume, a mesh or "
        "points.\n"
        "Lengths are in world units of the surface; defaults are in brackets.",
        kProgram};
    addOptions(app, options);
    addRunOptions(app, options);
    addInfo(app, options);
    addBatch(app, options);
    addHelp(app);
    app.set_version_flag("-V,--version", versionText,
                         "Print the versions of the program and of what it is built with")
        ->group("Run");
    if (argc == 2 && argv[1] == std::string("--dump-options")) {
        results() << descriptionJson(describe(app, kProgram));
        return ParseResult::Done;
    }
    try {
        app.parse(argumentsOf(argc, argv));
    } catch (const CLI::CallForHelp&) {
        results() << helpText(describeParsed(app));
        return ParseResult::Done;
    } catch (const CLI::Success& e) {
        app.exit(e, results(), std::cerr);
        return ParseResult::Done;
    } catch (const CLI::ParseError& e) {
        std::cerr << "implicit-geodesic: error: " << e.what() << "\n"
                  << "  see implicit-geodesic --help\n";
        return ParseResult::Usage;
    }
    return ParseResult::Run;
}

Options parseJob(const std::vector<std::string>& arguments) {
    Options options;
    CLI::App app;
    app.set_help_flag();
    addOptions(app, options);
    try {
        app.parse(std::vector<std::string>(arguments.rbegin(), arguments.rend()));
    } catch (const CLI::ParseError& e) {
        usageError(e.what(), "see implicit-geodesic --help");
    }
    return options;
}
