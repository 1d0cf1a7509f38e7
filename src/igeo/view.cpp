#include <igeo/view.h>

#include <fmt/core.h>
#include <igeo/base/atomic_file.h>
#include <igeo/base/detail/text.h>
#include <igeo/base/error.h>
#include <igeo/base/parallel.h>
#include <igeo/base/version.h>
#include <igeo/results/detail/camera.h>
#include <igeo/results/detail/drawn_picture.h>
#include <igeo/results/picture.h>
#include <igeo/results/refined_mesh.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

namespace igeo {

namespace {

/// The area in voxels squared.
double areaOf(const TriangleMesh& mesh, double dx) {
    double sum = 0;
    for (const auto& [a, b, c] : mesh.triangles)
        sum += length(cross(mesh.points[b] - mesh.points[a], mesh.points[c] - mesh.points[a])) / 2;
    return sum / (dx * dx);
}

/// The mesh itself, with long edges halved within a limit of `most` triangles.
SurfaceMesh ownTriangles(const TriangleMesh& mesh, const Field& field, std::size_t most,
                         Progress& progress) {
    // Halved edges leave triangles of about a fifth of the square of the longest; half of `most` is
    // kept for triangles that are small already.
    const double area = areaOf(mesh, field.band->transform.dx);
    double longest =
        std::max(2.0, std::sqrt(area / (0.1 * double(std::max<std::size_t>(most, 1)))));
    while (true) {
        SurfaceMesh refined = refinedMesh(mesh, field, longest, progress);
        if (refined.triangles.size() <= most || refined.triangles.size() == mesh.triangles.size())
            return refined;
        longest *= 1.5;
    }
}

/// For each point of a mesh the first vertex of its file that was merged into it; empty without a
/// file.
std::vector<std::uint32_t> vertexNumbers(const TriangleMesh& mesh) {
    std::vector<std::uint32_t> number;
    if (!mesh.source) return number;
    number.resize(mesh.points.size(), ViewScene::kNoNumber);
    for (std::size_t v = mesh.pointOfVertex.size(); v-- > 0;)
        if (mesh.pointOfVertex[v] != TriangleMesh::kNoPoint)
            number[mesh.pointOfVertex[v]] = std::uint32_t(v);
    return number;
}

std::vector<std::uint8_t> blockedVertices(const SurfaceMesh& mesh, const Metric& metric) {
    std::vector<std::uint8_t> blocked;
    if (!metric.obstacles) return blocked;
    blocked.resize(mesh.position.size());
    parallelFor(blocked.size(), 1024, [&](std::size_t begin, std::size_t end) {
        for (std::size_t v = begin; v < end; ++v)
            blocked[v] = metric.blocked(mesh.position[v], mesh.position[v], Vec3d(mesh.normal[v]));
    });
    return blocked;
}

/// Seeds that are points, and the segments of curves and rims as lines.
void addSeeds(ViewScene& scene, const Distance& distance) {
    const Similarity& t = distance.band().transform;
    const std::vector<SurfacePoint>& seeds = distance.seeds();
    const std::vector<std::uint32_t>& source = distance.marched()->source;
    for (std::size_t k = 0; k < seeds.size(); ++k) {
        const SurfacePoint& seed = seeds[k];
        const std::string name = fmt::format("seed {}", source[k]);
        const Vec3d from = t.worldFromIndex(seed.pIndex);
        if (seed.segment == Vec3d{}) {
            const bool piece = seed.joined || (k + 1 < seeds.size() && seeds[k + 1].joined);
            if (!piece) scene.seeds.push_back({name, from});
            continue;
        }
        const Vec3d to = t.worldFromIndex(seed.pIndex + seed.segment);
        if (!seed.joined || scene.lines.empty() || scene.lines.back().points.back() != from) {
            scene.lines.emplace_back();
            scene.lines.back().name = name;
            scene.lines.back().points.push_back(from);
        }
        scene.lines.back().points.push_back(to);
    }
}

void addTargets(ViewScene& scene, const Distance& distance) {
    const std::vector<double> to = distance.atTargets();
    for (std::size_t k = 0; k < to.size(); ++k) {
        if (distance.targets()[k].offSurface) continue;
        scene.targets.push_back(
            {fmt::format("target {}", k),
             distance.band().transform.worldFromIndex(distance.targets()[k].pIndex), to[k]});
    }
}

/// The paths of a picture, index space.
std::vector<Path> asPaths(const std::vector<NamedCurve>& lines, const Similarity& t) {
    std::vector<Path> paths;
    for (const NamedCurve& line : lines) {
        paths.emplace_back();
        for (const Vec3d& p : line.points) paths.back().vertices.push_back({t.indexFromWorld(p)});
    }
    return paths;
}

/// The level set that pictures show, since the band of a volume may be a part of it; null: the
/// band.
const LevelSet* shownLevelSet(const Distance& distance, Progress& progress) {
    const bool volume = distance.surface().facts().kind == SurfaceFacts::Kind::LevelSet;
    return volume ? &distance.levelSet(progress) : nullptr;
}

/// The field as the march left it, with the largest distance on the band.
Field shownField(const Distance& distance) {
    Field field = *distance.marched();
    field.maxDistance = distance.extent().maxDistance;
    return field;
}

/// The triangles of a page for its picture: at most one for each five pixels, on both sides.
DrawnSurface drawnSurface(const Band& band, SurfaceMesh mesh, bool closed) {
    constexpr std::size_t kMost = 15000, kMany = 2 * kMost;
    std::vector<std::uint32_t> kept;
    if (mesh.triangles.size() > kMany) thinOut(mesh, kMost, kept);
    return DrawnSurface(band, std::move(mesh), closed);
}

/// The first view, and a picture from there.
void addPicture(ViewScene& scene, const DrawnSurface& surface, const Field& field,
                const std::vector<Path>& paths, const PictureOptions& picture, Progress& progress) {
    const double aspect = double(picture.height) / picture.width;
    const View view = chooseView(surface, field, paths, picture, aspect);
    scene.toEye = view.back;
    scene.up = normalized(picture.up);
    scene.still = renderPng(surface, field, ArrivalReader(field), paths, picture, &view, progress);
}

/// Simplifies the mesh to the limit, with a note.
std::vector<std::uint32_t> keepToLimit(ViewScene& scene, SurfaceMesh& mesh,
                                       const ViewLimits& limits) {
    const std::size_t all = mesh.triangles.size();
    std::vector<std::uint32_t> kept;
    if (thinOut(mesh, limits.triangles, kept))
        scene.notes.push_back(fmt::format(
            "Drawn with {} of {} triangles; what is read is linear between the vertices left.",
            mesh.triangles.size(), all));
    return kept;
}

/// The title: bunny, or torus:psi for a grid in a file.
std::string titleOf(const SurfaceFacts& facts) {
    const std::string file = facts.file == "-" ? "" : stemOf(facts.file);
    return file.empty() || file == facts.name ? facts.name : file + ":" + facts.name;
}

std::string creator() { return fmt::format("implicit-geodesic {}", kVersion); }

/// The largest factor among the voxels around a point; +infinity if all are reliable.
double largestAround(const FileSurvey& survey, const Vec3d& pIndex) {
    double largest = 0;
    for (const NodeIndex i : cellAt(survey.band, pIndex).node)
        if (i != kNoNode) largest = std::max(largest, double(survey.surface->unreliability[i]));
    return largest > 0 ? largest : kInfinity;
}

/// By how many rings of triangles marks grow: a line one voxel wide is invisible on a large model.
int ringsToSee(const SurfaceMesh& mesh) {
    Vec3d low = mesh.position.at(0), high = low;
    for (const Vec3d& p : mesh.position)
        for (int axis = 0; axis < 3; ++axis)
            low[axis] = std::min(low[axis], p[axis]), high[axis] = std::max(high[axis], p[axis]);
    const Vec3d size = high - low;
    return 1 + int(std::lround(std::max({size.x, size.y, size.z}) / 256));
}

/// Gives each vertex the largest finite value within `rings` triangles.
void widenMarks(SurfaceMesh& mesh, int rings) {
    for (; rings > 0; --rings) {
        std::vector<double> wide = mesh.distance;
        for (const auto& triangle : mesh.triangles) {
            double most = 0;
            for (const std::uint32_t v : triangle)
                if (mesh.distance[v] < kInfinity) most = std::max(most, mesh.distance[v]);
            for (const std::uint32_t v : triangle)
                if (most > 0) wide[v] = wide[v] < kInfinity ? std::max(wide[v], most) : most;
        }
        mesh.distance.swap(wide);
    }
}

/// The survey as a distance field, for pictures.
Field fieldOf(const FileSurvey& survey) {
    Field field;
    field.band = &survey.band;
    for (const float factor : survey.surface->unreliability)
        field.distance.push_back(factor > 0 ? double(factor) : kInfinity);
    field.summarize();
    return field;
}

}  // namespace

PictureOptions viewPicture() {
    PictureOptions picture;
    picture.width = 320, picture.height = 240;
    return picture;
}

ViewScene viewScene(const Distance& distance, const std::vector<NamedCurve>& lines,
                    const PictureOptions& picture, const ViewLimits& limits, Progress& progress) {
    const Surface& surface = distance.surface();
    const TriangleMesh* given = surface.triangles();
    const std::optional<Field> core = given ? std::nullopt : std::optional(shownField(distance));
    const Field& field = core ? *core : distance.field();
    ViewScene scene;
    scene.title = titleOf(surface.facts());
    scene.creator = creator();
    scene.voxels = field.band->transform;
    if (!picture.unit.empty()) scene.unit = picture.unit;
    if (field.metric->weighted()) scene.unit += " times weight";

    SurfaceMesh mesh = given ? ownTriangles(*given, field, limits.triangles, progress)
                             : surfaceMesh(distance.levelSet(progress), *field.band, progress);
    const std::vector<std::uint32_t> kept = keepToLimit(scene, mesh, limits);
    if (!given) sampleDistances(mesh, field, progress);
    const LevelSet* volume = shownLevelSet(distance, progress);
    const bool closed = volume && volume->stats.cutVoxels == 0;
    addPicture(scene, given ? DrawnSurface(*field.band) : drawnSurface(*field.band, mesh, closed),
               field, asPaths(lines, field.band->transform), picture, progress);
    if (given) {
        const std::vector<std::uint32_t> number = vertexNumbers(*given);
        for (const std::uint32_t v : kept)
            if (!number.empty())
                scene.number.push_back(v < number.size() ? number[v] : ViewScene::kNoNumber);
    }
    scene.blocked = blockedVertices(mesh, *field.metric);
    scene.mesh = inWorld(std::move(mesh), field.band->transform);
    scene.lines = lines;
    addSeeds(scene, distance);
    addTargets(scene, distance);
    for (std::size_t k = 0; k < field.sourceCount(); ++k)
        scene.labelNames.push_back(fmt::format("seed {}", k));
    if (field.stoppedEarly) scene.rest = "beyond the distance marched";
    scene.colorMap = picture.colorMap;
    const double dx = field.band->transform.dx;
    scene.range = {{field.leastStart * dx, field.maxDistance * dx}};
    scene.isolineSpacing = picture.isolineCount > 0 ? (field.maxDistance - field.leastStart) * dx /
                                                          (picture.isolineCount + 1)
                                                    : picture.isolineSpacing;
    return scene;
}

std::string renderPng(const Distance& distance, const std::vector<NamedCurve>& lines,
                      const PictureOptions& options, Progress& progress) {
    const Field field = shownField(distance);
    return renderPng(shownLevelSet(distance, progress), field, ArrivalReader(field),
                     asPaths(lines, field.band->transform), options, progress);
}

ViewScene viewScene(const FileSurvey& survey, const ViewLimits& limits, Progress& progress) {
    const Field field = fieldOf(survey);
    ViewScene scene;
    scene.title = stemOf(survey.file);
    scene.creator = creator();
    scene.voxels = survey.band.transform;
    scene.quantity = "factor";
    scene.unit = "by which a bound on reliable distances is passed";
    scene.rest = "reliable";
    scene.grows = false;
    scene.colorMap = "magma";  // its middle differs from gray
    SurfaceMesh mesh = surfaceMesh(survey.levelSet, survey.band, progress);
    mesh.distance.resize(mesh.position.size());
    parallelFor(mesh.position.size(), 1024, [&](std::size_t begin, std::size_t end) {
        for (std::size_t v = begin; v < end; ++v)
            mesh.distance[v] = largestAround(survey, mesh.position[v]);
    });
    const int rings = ringsToSee(mesh);
    widenMarks(mesh, rings);
    scene.notes.push_back(fmt::format("Marks are drawn {} wider on each side.",
                                      rings > 1 ? fmt::format("{} voxels", rings) : "a voxel"));
    scene.restShare = 1 - double(survey.surface->unreliable) / double(survey.band.size());
    keepToLimit(scene, mesh, limits);
    PictureOptions picture = viewPicture();
    picture.legend = false;
    picture.isolineSpacing = -1;
    picture.colorMap = scene.colorMap;
    addPicture(scene, drawnSurface(survey.band, mesh, false), field, {}, picture, progress);
    scene.range = {{0, field.maxDistance}};
    scene.mesh = std::move(mesh);
    for (Vec3d& p : scene.mesh.position) p = field.band->transform.worldFromIndex(p);
    scene.notes.push_back(survey.verdict());
    scene.notes.insert(scene.notes.end(), survey.warnings.begin(), survey.warnings.end());
    return scene;
}

void writeView(const std::string& file, const Distance& distance,
               const std::vector<NamedCurve>& lines, const PictureOptions& picture,
               Progress& progress) {
    writeFile(file, viewPage(viewScene(distance, lines, picture, {}, progress)));
}

}  // namespace igeo
