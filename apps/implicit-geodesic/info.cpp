#include "info.h"

#include <fmt/core.h>
#include <igeo/base/detail/text.h>
#include <igeo/base/digest.h>
#include <igeo/io/vdb_write.h>
#include <igeo/io/volume_file.h>
#include <igeo/results/field_grids.h>
#include <igeo/results/survey.h>
#include <igeo/surface/volume_mesh.h>
#include <igeo/view.h>
#include "output/report.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <iostream>
#include <numbers>
#include <utility>

#include "exit_code.h"
#include "input/guarded_read.h"
#include "input/surface_input.h"
#include "option_words.h"
#include "output/output_files.h"
#include "output/stdout.h"
#include "printable.h"
#include "process.h"
#include "usage_error.h"

using igeo::FileSurvey;
using igeo::SurfaceComponent;
using igeo::Vec3d;

namespace {

std::string count(std::uint64_t n, const char* one) {
    return std::to_string(n) + " " + one + (n == 1 ? "" : "s");
}

/// Text of a length in voxels, with world units.
std::string lengthOf(double voxels, double dx) {
    return fmt::format("{:.4g} voxels ({:.4g})", voxels, voxels * dx);
}

std::string radiusOf(double curvature, double dx) {
    return curvature > 1e-6 ? lengthOf(1 / curvature, dx) : "without bound";
}

std::string describe(const igeo::GridEntry& grid, bool chosen) {
    std::string line = grid.name + ": " + grid.type + ", " + grid.gridClass;
    if (grid.activeVoxels) line += ", " + count(*grid.activeVoxels, "active voxel");
    std::string uses;
    for (const auto& [can, option] : {std::pair(grid.surface, "--sdf"),
                                      {grid.weight && !grid.surface, "--sdf with --rebuild,"},
                                      {grid.weight, "--weight"},
                                      {grid.obstacle, "--obstacle"},
                                      {igeo::holdsPoints(grid), "--points"}})
        if (can) uses += (uses.empty() ? "" : " ") + std::string(option);
    line += uses.empty() ? "; not usable here" : "; for " + uses;
    return line + (chosen ? " (chosen)" : "");
}

std::string describe(const igeo::VolumeFacts& v) {
    return fmt::format("{}, {} x {} x {} of {:.4g} x {:.4g} x {:.4g}, values {:.6g} {} {:.6g}",
                       v.kind, v.size[0], v.size[1], v.size[2], v.spacing.x, v.spacing.y,
                       v.spacing.z, double(v.range.low), v.range.isMask ? "and" : "to",
                       double(v.range.high)) +
           (v.range.isMask ? " (a mask)" : "");
}

std::string describe(const igeo::MeshFacts& mesh) {
    std::string line = count(mesh.triangles, "triangle") + ", " + count(mesh.points, "point") +
                       ", " + count(mesh.components, "component");
    if (mesh.closed) line += ", closed";
    if (const std::string open = openness(mesh); !open.empty()) line += ", " + open;
    if (mesh.nonManifoldEdges > 0)
        line += ", " + count(mesh.nonManifoldEdges, "edge") + " of three triangles or more";
    if (mesh.nonOrientable > 0) line += ", " + std::to_string(mesh.nonOrientable) + " one-sided";
    if (mesh.crossingPairs > 0) line += ", " + crossingsOf(mesh);
    if (mesh.junctions > 0) line += "; " + splitsOf(mesh);
    if (mesh.dropped > 0) line += "; " + count(mesh.dropped, "triangle") + " dropped";
    return line;
}

std::string describe(const igeo::CloudDensity& cloud) {
    std::string line = count(cloud.points, "point") +
                       fmt::format(", {:.4g} apart (99 %: {:.4g}), scatter {:.2g}", cloud.spacing,
                                   cloud.spacing99, cloud.noise) +
                       ", " + count(cloud.pieces, "component");
    if (cloud.duplicates > 0) line += "; " + count(cloud.duplicates, "duplicate");
    if (cloud.isolated > 0) line += "; " + std::to_string(cloud.isolated) + " left out";
    return line;
}

/// Orientation of the index axes in world space.
std::string describe(const igeo::Similarity& t) {
    const double sign = t.mirrors() ? -1 : 1;
    const double trace = sign * (t.axis[0].x + t.axis[1].y + t.axis[2].z);
    const double degrees =
        std::acos(std::clamp((trace - 1) / 2, -1.0, 1.0)) * 180 / std::numbers::pi;
    std::string words = "uniform scale";
    if (t.mirrors()) words += ", reflected";
    // acos near 1 turns a rounding of 1e-12 in the trace into 1e-4 degrees.
    if (degrees > 1e-3) words += fmt::format(", rotated by {:.4g} degrees", degrees);
    return words + fmt::format(", voxel size dx {:.6g}", t.dx);
}

std::string describe(const SurfaceComponent& p, double dx) {
    const Vec3d size = p.high - p.low;
    std::string line = fmt::format("area {:.6g}, box {:.4g}", p.area * dx * dx, size.x) +
                       fmt::format(" x {:.4g} x {:.4g}", size.y, size.z);
    if (p.parts == 0)
        return line + ", cut off from a larger component by sheets that face each other";
    line += p.rims == 0 ? ", closed" : ", cut along " + count(std::uint64_t(p.rims), "rim");
    line += ", genus " + std::to_string(p.genus);
    if (p.parts > 1) line += ", of " + std::to_string(p.parts) + " parts that nearly touch";
    return line;
}

/// Lines "name  text" with padded names.
class Table {
public:
    void row(const std::string& name, const std::string& text) {
        results() << name << std::string(name.size() < kWidth ? kWidth - name.size() : 1, ' ')
                  << printable(text) << "\n";
    }

private:
    static constexpr std::size_t kWidth = 12;
};

void printComponents(Table& table, const igeo::SurfaceSurvey& s, double dx) {
    constexpr std::size_t kMost = 8;
    if (s.components.size() == 1)
        return table.row("components", "1: " + describe(s.components[0], dx));
    table.row("components", std::to_string(s.components.size()) + ": " +
                                fmt::format("area {:.6g}", s.area * dx * dx));
    for (std::size_t k = 0; k < std::min(s.components.size(), kMost); ++k)
        table.row("", describe(s.components[k], dx));
    if (s.components.size() > kMost)
        table.row("", "and " + count(s.components.size() - kMost, "smaller component"));
}

void printRoom(Table& table, const igeo::SurfaceSurvey& s, double dx) {
    if (s.medialRadius == igeo::kInfinity)
        return table.row("clearance", "95 % of the surface is without bends or sheets beside it");
    table.row("clearance", "95 % of the surface is clear for balls of radius " +
                               lengthOf(s.medialRadius, dx) + " on both sides");
    if (s.facingRadius < igeo::kInfinity)
        table.row("", "99 % is " + lengthOf(2 * s.facingRadius, dx) +
                          " or more from sheets that face it");
}

/// Prints advice on the voxel size.
void printVoxels(Table& table, const FileSurvey& file) {
    const igeo::SurfaceSurvey& s = *file.surface;
    const double dx = file.levelSet.transform.dx;
    std::string text = fmt::format("of {:.6g}", dx);
    // Sharp edges would need finer voxels than any grid has; only sheets must be separated.
    if (s.facingRadius < igeo::kInfinity && s.facingRadius > s.medialRadius)
        text +=
            fmt::format("; up to {:.4g} separate its sheets", s.facingRadius / std::sqrt(3.0) * dx);
    if (s.resolvingSize < igeo::kInfinity)
        text += fmt::format("; up to {:.4g} resolve 95 % of the surface", s.resolvingSize * dx);
    table.row("voxels", text);
}

void printSurface(Table& table, const FileSurvey& file) {
    const igeo::SurfaceSurvey& s = *file.surface;
    const igeo::LevelSetStats& stats = file.levelSet.stats;
    const double dx = file.levelSet.transform.dx, n = double(file.band.size());
    printComponents(table, s, dx);
    if (file.mesh && file.mesh->components != s.components.size())
        table.row("",
                  count(file.mesh->components, "component") +
                      " in the file; parts thinner than the voxels fall apart or are missing here");
    table.row("curvature", "radius at least " + radiusOf(stats.largestCurvature, dx) +
                               " on 95 % of the surface, " + radiusOf(s.largestCurvature, dx) +
                               " everywhere");
    table.row("reach",
              stats.reach < stats.halfWidth
                  ? "sheets meet within " + lengthOf(stats.reach, dx)
                  : "no sheets meet within " +
                        (file.ofGrid() ? "the half-width" : lengthOf(stats.halfWidth, dx)));
    table.row("", igeo::percent(s.facingShare) + " of the surface has a sheet that faces it");
    printRoom(table, s, dx);
    const std::string least = lengthOf(s.bounds.lower, dx);
    table.row("band", s.bounds.resolved ? "h from " + least + " to below " +
                                              lengthOf(s.bounds.upper, dx) + ", " + s.bounds.why
                                        : "h = " + least + ", more than " + s.bounds.why);
    table.row("", "by default jet takes " +
                      fmt::format("{:.4g}, godunov {:.4g} voxels", s.bounds.lower, s.godunovBand));
    std::string why;
    using Causes = std::array<const char*, igeo::kUnreliableCauses>;
    const Causes causes = file.ofGrid() ? Causes{"bends", "facing sheets", "|grad psi|", "cuts"}
                                        : Causes{"bends", "facing sheets", "kinks", "rims"};
    for (std::size_t k = 0; k < igeo::kUnreliableCauses; ++k)
        if (s.unreliableBy[k] > 0)
            why += (why.empty() ? ": " : ", ") + std::string(causes[k]) + " " +
                   std::to_string(s.unreliableBy[k]);
    printVoxels(table, file);
    table.row("unreliable", fmt::format("{} of {:.0f} band voxels (", s.unreliable, n) +
                                igeo::percent(double(s.unreliable) / n) + ")" + why);
    table.row("a run", fmt::format("about {:.3g} MB, {:.2g} s on one core", double(s.bytes) / 1e6,
                                   s.seconds));
}

void print(const FileSurvey& file) {
    const igeo::LevelSet& levelSet = file.levelSet;
    const igeo::LevelSetStats& stats = levelSet.stats;
    const double dx = levelSet.transform.dx;
    Table table;
    table.row("file", file.file);
    for (const igeo::GridEntry& grid : file.grids)
        table.row("grid", describe(grid, levelSet.psi && grid.name == levelSet.name));
    if (file.voxels) table.row("volume", describe(*file.voxels));
    if (file.mesh) table.row("mesh", describe(*file.mesh));
    if (file.points) table.row("points", describe(*file.points));
    if (file.ofGrid())
        table.row("transform", dx > 0 ? describe(levelSet.transform) : "refused, see below");
    if (stats.activeVoxels > 0) {
        if (file.ofGrid()) table.row("half-width", lengthOf(stats.halfWidth, dx));
        table.row(file.ofGrid() ? "volume" : "box",
                  igeo::textOf(file.low) + " to " + igeo::textOf(file.high));
    }
    if (file.ofGrid() && stats.nearSurface > 0)
        table.row("|grad psi|",
                  fmt::format("{:.3f} (median), within [0.75, 1.25] at {:.1f} % of the voxels",
                              stats.gradientMedian, 100 * stats.gradientShare));
    if (stats.conversionUndone)
        table.row("conversion", "of a mesh by OpenVDB: psi gets back what its last step took away");
    if (file.surface) printSurface(table, file);
    for (const std::string& warning : file.warnings) table.row("warning", warning);
    results() << printable(inOptionWords(file.verdict())) << "\n";
}

/// Surveys the file as a given kind of surface.
FileSurvey surveyAs(SurfaceKind kind, const InfoOptions& options, igeo::Progress& progress) {
    if (kind == SurfaceKind::Volume)
        return guardedRead(options.source.file,
                           [&] { return igeo::surveyFile(options.source, progress); });
    SurfaceOptions surfaceOptions;
    surfaceOptions.kind = kind;
    surfaceOptions.source = options.source;
    surfaceOptions.voxelSize = options.voxelSize;
    surfaceOptions.resolution = options.resolution;
    surfaceOptions.iso = options.iso;
    const igeo::Surface surface = readSurface(surfaceOptions, progress);
    surface.requireMemory(surface.bandWidth(igeo::Scheme::Jet), machineMemory());
    const double dx = surface.transform().dx;
    if (surface.triangles())
        return igeo::surveyMesh(*surface.triangles(), *surface.facts().mesh, dx, progress);
    FileSurvey survey = igeo::surveyPoints(*surface.points(), dx, progress);
    survey.warnings = surface.facts().warnings;
    return survey;
}

/// The same, with a refusal as part of the survey.
FileSurvey tryAs(SurfaceKind kind, const InfoOptions& options, igeo::Progress& progress) {
    try {
        return surveyAs(kind, options, progress);
    } catch (const igeo::Error& e) {
        if (e.kind() != igeo::Error::Kind::BadInput && e.kind() != igeo::Error::Kind::Io) throw;
        FileSurvey file;
        file.file = options.source.text();
        file.refusal = e;
        return file;
    }
}

/// Also surveys a volume whose surface is refused, such as one without --iso.
FileSurvey surveyVoxels(const InfoOptions& options, igeo::Progress& progress) {
    const std::string name = options.source.text();
    std::optional<igeo::VolumeFacts> facts;
    try {
        facts = guardedRead(name, [&] { return igeo::volumeFacts(igeo::readVolume(name)); });
    } catch (const igeo::Error&) {
        // The survey reports the reason.
    }
    FileSurvey file = tryAs(SurfaceKind::VoxelVolume, options, progress);
    file.voxels = facts;
    return file;
}

/// Surveys a file according to its content.
FileSurvey surveyOf(const InfoOptions& options, igeo::Progress& progress) {
    const std::string name = options.source.text();
    const SurfaceKind kind = kindByName(name);
    if (kind == SurfaceKind::VoxelVolume) return surveyVoxels(options, progress);
    if (options.iso)
        usageError("--iso is for volumes of voxels, as .nii and .nrrd", "leave it out");
    if (kind == SurfaceKind::Points) return tryAs(kind, options, progress);
    if (kind == SurfaceKind::Volume) {
        if (options.voxelSize > 0 || options.resolution > 0)
            usageError("--voxel-size and --resolution are for meshes and points",
                       "a volume has a fixed voxel size: leave them out");
        // A volume reports the reason for its refusal.
        FileSurvey file = surveyAs(SurfaceKind::Volume, options, progress);
        const bool points = std::any_of(file.grids.begin(), file.grids.end(), igeo::holdsPoints);
        const bool surface = std::any_of(file.grids.begin(), file.grids.end(),
                                         [](const igeo::GridEntry& g) { return g.surface; });
        if (!file.refusal || surface || !points) return file;
        FileSurvey asPoints = tryAs(SurfaceKind::Points, options, progress);
        asPoints.grids = file.grids;
        return asPoints;
    }
    FileSurvey mesh = tryAs(SurfaceKind::Mesh, options, progress);
    if (!mesh.refusal) return mesh;
    // .ply and .obj may also hold points.
    FileSurvey points = tryAs(SurfaceKind::Points, options, progress);
    return points.refusal ? mesh : points;
}

/// Checks that come before the survey.
void checkUnreliable(const InfoOptions& options) {
    checkOutputFiles({{"--unreliable", options.unreliable, ".vdb .html"}}, {options.source.file});
    if (endingOf(options.unreliable) == ".html" && !igeo::hasViewer())
        usageError(
            "--unreliable FILE.html: this program was built without three.js, which draws its "
            "pages",
            "write a .vdb file; or install three.js (Debian: libjs-three), configure and build "
            "again");
}

void writeUnreliable(const std::string& name, const FileSurvey& file, igeo::Progress& progress) {
    if (endingOf(name) == ".html")
        return writeDocument(name, igeo::viewPage(igeo::viewScene(file, {}, progress)));
    igeo::writeVdb(name, {igeo::unreliableGrid(file.band, file.surface->unreliability,
                                               file.levelSet.psi->transform(),
                                               file.levelSet.psi->getName() + "_unreliable")});
}

}  // namespace

int info(const InfoOptions& options, Console& console, ConsoleProgress& progress) {
    const std::string& unreliable = options.unreliable;
    if (!unreliable.empty()) checkUnreliable(options);
    const auto start = std::chrono::steady_clock::now();
    FileSurvey file = surveyOf(options, progress);
    for (std::string& warning : file.warnings) warning = inOptionWords(warning);
    // A refusal is a result here, but the reader may still have damaged the heap.
    const FileGuard reporting(options.source.text(), FileGuard::kNoLimit);
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
    const bool asked = file.surface && !unreliable.empty();
    const Provenance provenance{withoutProcessOptions(options.words),
                                {{options.source.text(), igeo::digestOfFile(options.source.file)}},
                                {{"survey", seconds.count()}},
                                peakMemory()};
    if (asked) writeUnreliable(unreliable, file, progress);
    progress.clear();
    console.detail(fmt::format("surveyed in {:.3f} s", seconds.count()));
    if (options.json)
        writeDocument("-", surveyJson(file, provenance));
    else
        print(file);
    if (asked)
        console.info(count(file.surface->unreliable, "unreliable voxel") + " in " + unreliable);
    return file.refusal ? kUnusable : kDone;
}
