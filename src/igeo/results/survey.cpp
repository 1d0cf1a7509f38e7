#include <igeo/results/survey.h>

#include <fmt/core.h>
#include <igeo/base/detail/box.h>
#include <igeo/base/detail/disjoint_sets.h>
#include <igeo/base/detail/steps.h>
#include <igeo/base/parallel.h>
#include <igeo/march/detail/jet_state.h>
#include <igeo/results/surface_mesh.h>
#include <igeo/surface/detail/leaf_block.h>
#include <igeo/surface/level_set_band.h>
#include <igeo/surface/level_set_check.h>
#include <igeo/surface/medial_radii.h>
#include <igeo/surface/mesh_band.h>
#include <igeo/surface/point_band.h>

#include <algorithm>
#include <atomic>
#include <map>
#include <utility>

namespace igeo {

namespace {

/// Per core node, the number of its band node.
std::vector<NodeIndex> coreNodes(const Band& band) {
    std::vector<NodeIndex> nodes(band.coreSize());
    for (NodeIndex i = 0; i < band.size(); ++i)
        if (const NodeIndex c = band.coreNode(i); c != kNoNode) nodes[c] = i;
    return nodes;
}

// Unreliable nodes

/// Factors by which a core node exceeds the bounds; below 1: it meets them.
struct Judgement {
    std::array<float, kUnreliableCauses> factor{};
    float curvature = 0;

    void add(Unreliable kind, double value) {
        float& f = factor[std::size_t(kind)];
        f = std::max(f, float(value));
    }
};

std::vector<Judgement> judgeCore(const LevelSet& levelSet, const Band& band,
                                 const std::vector<NodeIndex>& nodes, double lower,
                                 Progress& progress) {
    std::vector<Judgement> all(nodes.size());
    Steps steps(progress, "survey", band.leaves.size(), 0, 0.3);
    parallelFor(band.leaves.size(), 32, progress, [&](std::size_t begin, std::size_t end) {
        LeafBlock block;
        const LeafBlock::Accessor psi(levelSet.psi->constTree());
        for (std::size_t l = begin; l < end; ++l) {
            const BandLeaf& here = band.leaves[l];
            if (here.core.count == 0) continue;
            const Ijk& o = here.origin;
            block.gather(psi, openvdb::Coord(o.x, o.y, o.z), band.transform.dx);
            for (NodeIndex c = here.core.firstNode; c < here.core.firstNode + here.core.count;
                 ++c) {
                const NodeIndex i = nodes[c];
                const int at = int(band.placeOf(i).offset), x = at >> 6, y = at >> 3 & 7,
                          z = at & 7;
                Judgement& judged = all[c];
                const PsiDifferences d(block, x, y, z);
                if (cutBeside(d, band.psi[i], levelSet.stats.halfWidth))
                    judged.add(Unreliable::Cut, 1);
                if (d.complete()) {
                    judged.add(Unreliable::Rough,
                               std::abs(length(d.central()) - 1) / kGradientTolerance);
                    const double k = double(RowCurvatures(block, x, y).largest[std::size_t(z)]);
                    if (!std::isnan(k)) {
                        judged.curvature = float(k);
                        judged.add(Unreliable::Bend, k * lower);
                    }
                }
                if (band.facing[i] & Band::kFacing)
                    judged.add(Unreliable::Facing, lower / reachAt(band, i));
            }
        }
        steps.add(end - begin);
    });
    return all;
}

/// Stores the factors of the core, and gives the rest of the band those of the core around.
void spreadDoubts(const Band& band, const std::vector<Judgement>& core, SurfaceSurvey& s) {
    s.unreliability.assign(band.size(), 0);
    std::vector<std::uint8_t> kinds(band.size());
    parallelFor(band.size(), 4096, [&](std::size_t begin, std::size_t end) {
        for (auto i = NodeIndex(begin); i < end; ++i) {
            auto take = [&](NodeIndex c) {
                for (std::size_t k = 0; k < kUnreliableCauses; ++k) {
                    const float f = core[c].factor[k];
                    if (!(f >= 1)) continue;
                    s.unreliability[i] = std::max(s.unreliability[i], f);
                    kinds[i] = std::uint8_t(kinds[i] | 1u << k);
                }
            };
            if (const NodeIndex c = band.coreNode(i); c != kNoNode)
                take(c);
            else
                band.forCornersOfFoot(&BandLeaf::core, i,
                                      [&](NodeIndex j, float, const Vec3f&) { take(j); });
        }
    });
    for (const std::uint8_t any : kinds) {
        s.unreliable += any != 0;
        for (std::size_t k = 0; k < kUnreliableCauses; ++k) s.unreliableBy[k] += any >> k & 1;
    }
}

// Clearance

void measureRoom(const Band& band, const std::vector<NodeIndex>& nodes, SurfaceSurvey& s) {
    // A sample of this size shows every feature that voxels resolve, except on the largest
    // surfaces.
    constexpr std::size_t kMost = 2000000;
    const std::size_t stride = nodes.size() / kMost + 1;
    std::vector<Vec3d> points, normals;
    for (std::size_t c = 0; c < nodes.size(); c += stride) {
        points.push_back(band.footPoint(nodes[c]));
        normals.push_back(Vec3d(band.normal[nodes[c]]));
    }
    const MedialRadii radii = medialRadii(points, normals);
    s.medialRadius = MedialRadii::quantile(radii.radius, 0.05);
    s.facingRadius = MedialRadii::quantile(radii.facing, 0.01);
    s.resolvingSize = std::min(s.medialRadius, s.facingRadius) / std::sqrt(3.0);
}

// Components

/// Per core node the least node that a front from it reaches.
std::vector<NodeIndex> connect(const Band& band, const std::vector<NodeIndex>& nodes) {
    DisjointSets sets(nodes.size());
    for (NodeIndex c = 0; c < nodes.size(); ++c) {
        const NodeIndex i = nodes[c];
        band.forNeighbors(&BandLeaf::core, i, [&](NodeIndex next, int, int, int) {
            if (next < c && band.linked(i, nodes[next])) sets.join(c, next);
        });
        band.forBridges(i, [&](const Bridge& b) { sets.join(c, band.coreNode(b.to)); });
    }
    std::vector<NodeIndex> component(nodes.size());
    for (NodeIndex c = 0; c < nodes.size(); ++c) component[c] = sets.first(c);
    return component;
}

/// Per vertex of the mesh, the component of the core node that contributes most to the values in
/// its cell.
std::vector<NodeIndex> componentsOfVertices(const Band& band, const SurfaceMesh& mesh,
                                            const std::vector<NodeIndex>& component) {
    std::vector<NodeIndex> of(mesh.position.size(), kNoNode);
    parallelFor(of.size(), 1024, [&](std::size_t begin, std::size_t end) {
        for (std::size_t v = begin; v < end; ++v) {
            BandCell cell = cellAt(band, mesh.position[v]);
            dropFacingCorners(band, cell, Vec3d(mesh.normal[v]));
            double most = 0;
            for (std::size_t k = 0; k < 8; ++k) {
                const NodeIndex c = cell.node[k] == kNoNode ? kNoNode : band.coreNode(cell.node[k]);
                if (c != kNoNode && cell.weight[k] > most)
                    most = cell.weight[k], of[v] = component[c];
            }
        }
    });
    return of;
}

/// A connected part of a mesh.
struct MeshPart {
    int euler = 0;  ///< corners - edges + triangles; a corner is one fan of triangles
    int rims = 0;
    std::map<NodeIndex, double> area;  ///< by component, square voxels
};

std::vector<MeshPart> partsOf(const SurfaceMesh& mesh, const std::vector<NodeIndex>& ofVertex) {
    const MeshEdges edges = meshEdges(mesh);
    const std::size_t corners = 3 * mesh.triangles.size();
    // Corners are joined around a vertex from triangle to triangle, so that sheets which touch only
    // at a vertex stay separate and every part is a manifold; then parts and rims are joined.
    DisjointSets fans(corners), parts(mesh.triangles.size()), rims(corners);
    constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
    // 3 triangle + corner, the first found
    std::vector<std::uint32_t> side(edges.ends.size(), kNone);
    std::vector<std::uint8_t> paired(edges.ends.size());
    const auto next = [](std::uint32_t k) { return k % 3 == 2 ? k - 2 : k + 1; };
    for (std::uint32_t k = 0; k < corners; ++k) {
        const std::uint32_t e = edges.ofTriangle[k / 3][k % 3], other = side[e];
        if (other == kNone) {
            side[e] = k;
            continue;
        }
        paired[e] = 1;
        fans.join(k, next(other));
        fans.join(next(k), other);
        parts.join(k / 3, other / 3);
    }
    for (std::size_t e = 0; e < side.size(); ++e)
        if (!paired[e]) rims.join(fans.first(side[e]), fans.first(next(side[e])));

    std::map<std::uint32_t, MeshPart> found;
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
        MeshPart& part = found[parts.first(t)];
        ++part.euler;
        const auto& v = mesh.triangles[t];
        const Vec3d &a = mesh.position[v[0]], &b = mesh.position[v[1]], &c = mesh.position[v[2]];
        const auto known =
            std::find_if(v.begin(), v.end(), [&](auto i) { return ofVertex[i] != kNoNode; });
        part.area[known == v.end() ? kNoNode : ofVertex[*known]] += length(cross(b - a, c - a)) / 2;
        for (std::uint32_t k = 3 * t; k < 3 * t + 3; ++k) part.euler += fans.first(k) == k;
    }
    std::vector<std::uint8_t> atRim(corners);
    for (std::size_t e = 0; e < side.size(); ++e) {
        --found[parts.first(side[e] / 3)].euler;
        if (!paired[e]) atRim[rims.first(fans.first(side[e]))] = 1;
    }
    for (std::uint32_t k = 0; k < corners; ++k)
        if (atRim[k]) ++found[parts.first(k / 3)].rims;

    std::vector<MeshPart> all;
    for (auto& [first, part] : found) all.push_back(std::move(part));
    return all;
}

void findPieces(const Band& band, const SurfaceMesh& mesh, const std::vector<NodeIndex>& nodes,
                SurfaceSurvey& s) {
    const std::vector<NodeIndex> component = connect(band, nodes);
    std::map<NodeIndex, SurfaceComponent> found;
    for (const MeshPart& part : partsOf(mesh, componentsOfVertices(band, mesh, component))) {
        const auto most =
            std::max_element(part.area.begin(), part.area.end(),
                             [](const auto& a, const auto& b) { return a.second < b.second; });
        for (const auto& [first, area] : part.area) {
            s.area += area;
            if (first != kNoNode) found[first].area += area;
        }
        if (most->first == kNoNode) continue;
        SurfaceComponent& p = found[most->first];
        // A manifold whose rims are not filled has Euler number 2 - 2 genus - rims.
        p.genus += (2 - part.euler - part.rims) / 2;
        p.rims += part.rims;
        ++p.parts;
    }
    for (std::size_t c = 0; c < nodes.size(); ++c) {
        const auto p = found.find(component[c]);
        if (p == found.end()) continue;
        const Vec3d q = band.transform.worldFromIndex(band.footPoint(nodes[c]));
        for (int a = 0; a < 3; ++a) {
            p->second.low[a] = std::min(p->second.low[a], q[a]);
            p->second.high[a] = std::max(p->second.high[a], q[a]);
        }
    }
    for (const auto& [first, p] : found) s.components.push_back(p);
    std::stable_sort(s.components.begin(), s.components.end(),
                     [](const auto& a, const auto& b) { return a.area > b.area; });
}

}  // namespace

SurfaceSurvey survey(const LevelSet& levelSet, const Band& band, const SurfaceMesh& mesh,
                     Progress& progress) {
    const LevelSetStats& stats = levelSet.stats;
    SurfaceSurvey s;
    s.bounds = bandBounds(stats);
    s.godunovBand = defaultBandWidth(2, stats.largestCurvature, s.bounds);
    const std::vector<NodeIndex> nodes = coreNodes(band);
    const std::vector<Judgement> judged =
        judgeCore(levelSet, band, nodes, s.bounds.lower, progress);
    // The percentile over all voxels may exceed it by rounding.
    s.largestCurvature = stats.largestCurvature;
    for (const Judgement& j : judged)
        s.largestCurvature = std::max(s.largestCurvature, double(j.curvature));
    s.facingShare = facingShare(band);
    spreadDoubts(band, judged, s);
    measureRoom(band, nodes, s);
    progress.throwIfCancelled();
    findPieces(band, mesh, nodes, s);
    progress.throwIfCancelled();
    return s;
}

namespace {

/// The box of the active voxels' centers, in world space.
void measureBox(FileSurvey& file) {
    const openvdb::CoordBBox box = file.levelSet.psi->evalActiveVoxelBoundingBox();
    if (box.empty()) return;
    const openvdb::Coord &lo = box.min(), &hi = box.max();
    Box world;
    for (int k = 0; k < 8; ++k)
        world.include(file.levelSet.transform.worldFromIndex({double(k & 4 ? hi.x() : lo.x()),
                                                              double(k & 2 ? hi.y() : lo.y()),
                                                              double(k & 1 ? hi.z() : lo.z())}));
    file.low = world.low, file.high = world.high;
}

/// Makes a level set for the survey of a surface that is no grid; `fill` makes its band of a given
/// width.
template <typename Fill>
void putOnGrid(FileSurvey& file, bool closed, const std::string& name, const Fill& fill,
               Progress& progress) {
    constexpr double kRoomForDifferences = 3;
    file.levelSet = levelSetFromBand(fill(kRoomForDifferences), closed, file.file, name, progress);
    // These warnings concern volumes, where a rim is an error.
    file.levelSet.warnings.clear();
    file.band = fill(std::sqrt(3.0));
    Box world;
    for (NodeIndex i = 0; i < file.band.size(); ++i)
        world.include(file.band.transform.worldFromIndex(file.band.footPoint(i)));
    file.low = world.low, file.high = world.high;
}

/// @param bytes  of memory, beside kProgramBytes
void estimate(FileSurvey& file, double bytes, double secondsPerNode) {
    file.surface->bytes = std::uint64_t(kProgramBytes + bytes);
    file.surface->seconds = secondsPerNode * double(file.band.size());
}
void estimate(FileSurvey& file, const RunCost& cost) {
    estimate(file, cost.bytesPerNode * double(file.band.size()), cost.secondsPerNode);
}

/// The most that a march on a level set takes: the level set itself, the band, the core with its
/// jets, and about so much per node of the band for links around the front.
double marchBytes(const LevelSet& levelSet, const Band& band) {
    constexpr double kFront = 3;
    return double(levelSet.psi->memUsage() + band.memUsage()) +
           double(sizeof(JetNode) + sizeof(JetState)) * double(band.coreSize()) +
           kFront * double(band.size());
}

/// The given triangles, without normals.
SurfaceMesh trianglesOf(const TriangleMesh& mesh, const Similarity& transform) {
    SurfaceMesh surface;
    for (const Vec3d& p : mesh.points) surface.position.push_back(transform.indexFromWorld(p));
    surface.normal.resize(mesh.points.size());
    surface.triangles = mesh.triangles;
    return surface;
}

}  // namespace

bool FileSurvey::withCare() const {
    return surface && !(surface->bounds.resolved && warnings.empty());
}

std::string FileSurvey::verdict() const {
    if (refusal) return std::string("not usable: ") + refusal->what() + "; " + refusal->remedy();
    const std::vector<SurfaceComponent>& components = surface->components;
    int rims = 0, genus = 0;
    for (const SurfaceComponent& p : components) {
        rims += p.rims;
        genus += p.genus;
    }
    std::string line = withCare() ? "usable with care: " : "usable: ";
    line += rims == 0 ? "closed surface, " : "surface with a rim, ";
    const std::size_t count = mesh ? mesh->components : components.size();
    line += fmt::format("{}{}", count, count == 1 ? " component" : " components");
    line += fmt::format(", genus {}{}", genus, components.size() == 1 ? "" : " together");
    if (surface->bounds.resolved) return line + ", resolved";
    return fmt::format(
        "{}; the surface bends or folds within {:.2g} voxels on {} of it, less than the grid "
        "resolves",
        line, surface->bounds.lower, percent(surface->bounds.unresolvedShare));
}

bool holdsPoints(const GridEntry& grid) {
    return grid.type == openvdb::typeNameAsString<openvdb::PointDataIndex32>();
}

FileSurvey surveyFile(const GridSource& source, Progress& progress) {
    FileSurvey file;
    file.file = source.file == "-" ? "standard input" : source.file;
    try {
        progress.update("read", 0);
        LoadedGrid loaded = readLevelSetGrid(source, &file.grids);
        checkLevelSet(std::move(loaded), file.levelSet, progress);
    } catch (const Error& e) {
        if (e.kind() != Error::Kind::BadInput && e.kind() != Error::Kind::Io) throw;
        file.refusal = e;
    }
    file.warnings = file.levelSet.warnings;
    if (file.levelSet.transform.dx > 0 && file.levelSet.psi) measureBox(file);
    if (file.refusal) return file;
    const LevelSetStats& stats = file.levelSet.stats;
    const BandBounds bounds = bandBounds(stats);
    file.band = bandFromLevelSet(file.levelSet, bounds.lower, {}, progress);
    file.surface =
        survey(file.levelSet, file.band, surfaceMesh(file.levelSet, file.band, progress), progress);
    file.surface->unresolved = unresolvedOf(file.levelSet, file.band);
    for (const std::string& w : unresolvedWarnings(file.surface->unresolved))
        file.warnings.push_back(w);
    // Of doubles that were read, pages stay: 2.5 to 5.6 MB of spheres, of 63 to 377 MB in all.
    constexpr double kPagesLeft = 4e6;
    const bool ofDoubles = std::any_of(file.grids.begin(), file.grids.end(), [&](const auto& g) {
        return g.name == file.levelSet.name && g.type == "double";
    });
    estimate(file, marchBytes(file.levelSet, file.band) + (ofDoubles ? kPagesLeft : 0),
             kVolumeSecondsPerNode);
    return file;
}

FileSurvey surveyMesh(const TriangleMesh& mesh, const MeshFacts& facts, double dx,
                      Progress& progress) {
    FileSurvey file;
    file.file = mesh.file;
    file.mesh = facts;
    file.warnings = mesh.warnings;
    for (const std::string& w : meshWarnings(*file.mesh)) file.warnings.push_back(w);
    putOnGrid(
        file, file.mesh->closed, "mesh",
        [&](double h) { return bandFromMesh(mesh, dx, h, progress); }, progress);
    const Box box(mesh.points);
    file.low = box.low, file.high = box.high;
    file.surface =
        survey(file.levelSet, file.band, trianglesOf(mesh, file.band.transform), progress);
    file.surface->unresolved = unresolvedOf(facts, file.band);
    file.surface->unresolved.facing.reset();  // facingShare reports it
    for (const std::string& w : unresolvedWarnings(file.surface->unresolved))
        file.warnings.push_back(w);
    estimate(file, kMeshCost);
    file.surface->seconds += kSecondsPerTriangle * double(mesh.triangles.size());
    return file;
}

FileSurvey surveyPoints(const PointSurface& surface, double dx, Progress& progress) {
    FileSurvey file;
    file.file = surface.file();
    file.points = surface.density();
    file.warnings = densityWarnings(surface.density(), surface.file());
    putOnGrid(
        file, /*closed=*/false, "points",
        [&](double h) { return bandFromPoints(surface, PointBandKind::Fits, dx, h, progress); },
        progress);
    file.surface =
        survey(file.levelSet, file.band, surfaceMesh(file.levelSet, file.band, progress), progress);
    estimate(file, kPointsCost);
    return file;
}

}  // namespace igeo
