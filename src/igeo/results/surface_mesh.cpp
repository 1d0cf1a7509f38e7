#include <igeo/results/surface_mesh.h>

#include <fmt/core.h>
#include <igeo/base/detail/steps.h>
#include <igeo/base/error.h>
#include <igeo/base/parallel.h>
#include <igeo/surface/level_set.h>

#include <openvdb/tools/VolumeToMesh.h>

#include <algorithm>
#include <utility>

namespace igeo {

namespace {

using Quad = std::array<std::uint32_t, 4>;

/// The mesh that OpenVDB extracts, in index space, with quadrilaterals counter-clockwise seen from
/// outside.
struct Extracted {
    std::vector<Vec3d> points;
    std::vector<Quad> quads;
};

Extracted extract(const openvdb::FloatGrid& psi) {
    // A copy of the tree with coordinates relative to its corner, because OpenVDB returns points in
    // single precision.
    const openvdb::CoordBBox box = psi.evalActiveVoxelBoundingBox();
    if (box.dim()[box.maxExtent()] > kFarthestInFloat)
        throw Error(Error::Kind::BadInput,
                    fmt::format("the surface is {} voxels across; OpenVDB places the vertices of "
                                "meshes in single precision, which is good for {}",
                                box.dim()[box.maxExtent()], kFarthestInFloat),
                    "ask for no mesh of it, or for each of its pieces by itself");
    const openvdb::Coord low = box.min();
    const auto grid =
        openvdb::FloatGrid::create(openvdb::ConstPtrCast<openvdb::FloatTree>(psi.constTreePtr()));
    grid->setGridClass(openvdb::GRID_LEVEL_SET);  // otherwise the faces are turned inward
    grid->setTransform(openvdb::math::Transform::createLinearTransform(1.0));
    grid->transform().preTranslate(-low.asVec3d());

    std::vector<openvdb::Vec3s> points;
    std::vector<openvdb::Vec4I> quads;
    openvdb::tools::volumeToMesh(*grid, points, quads, 0.0);

    Extracted mesh;
    const Vec3d corner(low.x(), low.y(), low.z());
    mesh.points.reserve(points.size());
    for (const auto& p : points) mesh.points.push_back(corner + Vec3d(p.x(), p.y(), p.z()));
    mesh.quads.reserve(quads.size());
    // OpenVDB's order is clockwise.
    for (const auto& q : quads) mesh.quads.push_back({q[3], q[2], q[1], q[0]});
    return mesh;
}

/// Whether the sign of psi changes in the cell without a surface: over an edge that leaves the
/// volume, or along which psi jumps by twice what a distance may (as at the rim of a widened level
/// set). The surface ends there, and OpenVDB closes it with a wall.
bool atWall(const openvdb::FloatGrid::ConstAccessor& psi, double dx, const Vec3d& p) {
    const Ijk cell = floorToIjk(p);
    std::array<bool, 8> active;
    std::array<float, 8> value;
    for (unsigned k = 0; k < 8; ++k) {
        const openvdb::Coord c(cell.x + int(k >> 2), cell.y + int(k >> 1 & 1), cell.z + int(k & 1));
        active[k] = psi.probeValue(c, value[k]);
    }
    for (unsigned k = 0; k < 8; ++k)
        for (unsigned bit = 1; bit < 8; bit *= 2) {
            const unsigned j = k ^ bit;
            if ((value[k] < 0) != (value[j] < 0) &&
                (!active[k] || std::abs(value[k] - value[j]) > 2 * dx))
                return true;
        }
    return false;
}

/// Removes faces that touch a wall, and unused points.
void dropWalls(const LevelSet& levelSet, Extracted& mesh) {
    std::vector<std::uint8_t> wall(mesh.points.size());
    parallelFor(wall.size(), 1024, [&](std::size_t begin, std::size_t end) {
        const auto psi = levelSet.psi->getConstAccessor();
        for (std::size_t i = begin; i < end; ++i)
            wall[i] = atWall(psi, levelSet.transform.dx, mesh.points[i]);
    });
    mesh.quads.erase(std::remove_if(mesh.quads.begin(), mesh.quads.end(),
                                    [&](const Quad& q) {
                                        return wall[q[0]] || wall[q[1]] || wall[q[2]] || wall[q[3]];
                                    }),
                     mesh.quads.end());
    constexpr std::uint32_t kUnused = std::numeric_limits<std::uint32_t>::max();
    std::vector<std::uint32_t> number(mesh.points.size(), kUnused);
    for (const Quad& q : mesh.quads)
        for (const std::uint32_t v : q) number[v] = 0;
    std::uint32_t count = 0;
    for (std::size_t i = 0; i < number.size(); ++i) {
        if (number[i] == kUnused) continue;
        mesh.points[count] = mesh.points[i];
        number[i] = count++;
    }
    mesh.points.resize(count);
    for (Quad& q : mesh.quads)
        for (std::uint32_t& v : q) v = number[v];
}

/// Splits quadrilaterals along the diagonal whose worse triangle is better. Quality is area over
/// the squares of the sides, negative for a flipped triangle.
std::vector<SurfaceMesh::Triangle> split(const std::vector<Quad>& quads,
                                         const std::vector<Vec3d>& p) {
    std::vector<SurfaceMesh::Triangle> triangles(2 * quads.size());
    parallelFor(quads.size(), 1024, [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) {
            const auto [a, b, c, d] = quads[k];
            const Vec3d n = normalized(cross(p[c] - p[a], p[d] - p[b]));
            auto quality = [&](std::uint32_t i, std::uint32_t j, std::uint32_t l) {
                const Vec3d ij = p[j] - p[i], jl = p[l] - p[j], li = p[i] - p[l];
                return dot(cross(ij, jl), n) / (dot(ij, ij) + dot(jl, jl) + dot(li, li));
            };
            const double ac = std::min(quality(a, b, c), quality(a, c, d));
            const double bd = std::min(quality(b, c, d), quality(b, d, a));
            triangles[2 * k] = ac >= bd ? SurfaceMesh::Triangle{a, b, c} : std::array{b, c, d};
            triangles[2 * k + 1] = ac >= bd ? SurfaceMesh::Triangle{a, c, d} : std::array{b, d, a};
        }
    });
    return triangles;
}

/// Per vertex the unit mean normal of its triangles, weighted by area.
std::vector<Vec3f> vertexNormals(const SurfaceMesh& mesh) {
    std::vector<Vec3d> sum(mesh.position.size());
    for (const auto& [a, b, c] : mesh.triangles) {
        const Vec3d n =
            cross(mesh.position[b] - mesh.position[a], mesh.position[c] - mesh.position[a]);
        sum[a] += n, sum[b] += n, sum[c] += n;
    }
    std::vector<Vec3f> normal(sum.size());
    for (std::size_t i = 0; i < sum.size(); ++i) normal[i] = Vec3f(normalized(sum[i]));
    return normal;
}

}  // namespace

SurfaceMesh surfaceMesh(const LevelSet& levelSet, const Band& band, Progress& progress) {
    progress.update("mesh", 0);
    Extracted extracted = extract(*levelSet.psi);
    dropWalls(levelSet, extracted);
    progress.throwIfCancelled();

    SurfaceMesh mesh;
    mesh.position = std::move(extracted.points);
    const std::size_t n = mesh.position.size();
    Steps projecting(progress, "mesh", n, 0.45, 0.6);
    parallelFor(n, 1024, [&](std::size_t begin, std::size_t end) {
        if (projecting.cancelled()) return;
        for (std::size_t i = begin; i < end; ++i) {
            Vec3d p = mesh.position[i];
            // Beyond a voxel the projection is on another sheet.
            if (projectToSurface(band, p) && length(p - mesh.position[i]) < 1) mesh.position[i] = p;
        }
        projecting.add(end - begin);
    });
    progress.throwIfCancelled();
    mesh.triangles = split(extracted.quads, mesh.position);
    mesh.normal = vertexNormals(mesh);
    return mesh;
}

SurfaceMesh surfaceMesh(const LevelSet& levelSet, const Field& field, Progress& progress) {
    SurfaceMesh mesh = surfaceMesh(levelSet, *field.band, progress);
    sampleField(mesh, field, progress);
    return mesh;
}

void sampleDistances(SurfaceMesh& mesh, const Field& field, Progress& progress) {
    const std::size_t n = mesh.position.size();
    mesh.distance.resize(n);
    mesh.label.resize(n);
    parallelFor(n, 1024, progress, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const Arrival first = arrivalAt(field, mesh.position[i], Vec3d(mesh.normal[i]));
            mesh.distance[i] = first.distance;
            mesh.label[i] = first.distance < kInfinity ? first.source : kNoLabel;
        }
    });
}

void sampleField(SurfaceMesh& mesh, const Field& field, Progress& progress) {
    const std::size_t n = mesh.position.size();
    mesh.normal = vertexNormals(mesh);
    mesh.distance.resize(n);
    mesh.label.resize(n);
    mesh.gradient.resize(n);
    Steps reading(progress, "mesh", n, 0.7, 1);
    parallelFor(n, 1024, [&](std::size_t begin, std::size_t end) {
        if (reading.cancelled()) return;
        for (std::size_t i = begin; i < end; ++i) {
            const Vec3d p = mesh.position[i], sheetNormal(mesh.normal[i]);
            const SurfaceCell cell(*field.band, *field.metric, p, sheetNormal);
            if (cell.normal != Vec3d{}) mesh.normal[i] = Vec3f(cell.normal);
            const Arrival first = arrivalAt(field, p, sheetNormal);
            mesh.distance[i] = first.distance;
            mesh.label[i] = first.distance < kInfinity ? first.source : kNoLabel;
            mesh.gradient[i] = Vec3f(gradientAt(field, first, p, cell));
        }
        reading.add(end - begin);
    });
    progress.throwIfCancelled();
}

SurfaceMesh inWorld(SurfaceMesh mesh, const Similarity& transform) {
    for (Vec3d& p : mesh.position) p = transform.worldFromIndex(p);
    for (std::vector<Vec3f>* vectors : {&mesh.normal, &mesh.gradient})
        for (Vec3f& v : *vectors) v = Vec3f(transform.worldFromIndexDirection(Vec3d(v)));
    for (double& d : mesh.distance) d *= transform.dx;
    if (transform.mirrors())
        for (auto& [a, b, c] : mesh.triangles) std::swap(b, c);
    return mesh;
}

MeshEdges meshEdges(const SurfaceMesh& mesh) {
    struct HalfEdge {
        std::uint32_t low, high;
        bool up;          // from low to high
        std::uint32_t k;  // 3 * triangle + corner
        bool operator<(const HalfEdge& o) const {
            return std::tie(low, high, up, k) < std::tie(o.low, o.high, o.up, o.k);
        }
    };
    std::vector<HalfEdge> half;
    half.reserve(3 * mesh.triangles.size());
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
        for (std::size_t k = 0; k < 3; ++k) {
            const std::uint32_t a = mesh.triangles[t][k], b = mesh.triangles[t][(k + 1) % 3];
            half.push_back({std::min(a, b), std::max(a, b), a < b, std::uint32_t(3 * t + k)});
        }
    std::sort(half.begin(), half.end());

    MeshEdges edges;
    edges.ofTriangle.resize(mesh.triangles.size());
    for (std::size_t begin = 0; begin < half.size();) {
        // Edges down come first; the i-th of them and the i-th edge up are the two sides of one
        // edge.
        std::size_t up = begin, end = begin;
        for (; end < half.size() && half[end].low == half[begin].low &&
               half[end].high == half[begin].high;
             ++end)
            if (!half[end].up) ++up;
        for (std::size_t i = 0; i < std::max(up - begin, end - up); ++i) {
            const auto edge = std::uint32_t(edges.ends.size());
            edges.ends.push_back({half[begin].low, half[begin].high});
            for (const auto& [from, to] : {std::pair{begin, up}, std::pair{up, end}})
                if (from + i < to) {
                    const std::uint32_t k = half[from + i].k;
                    edges.ofTriangle[k / 3][k % 3] = edge;
                }
        }
        begin = end;
    }
    return edges;
}

}  // namespace igeo
