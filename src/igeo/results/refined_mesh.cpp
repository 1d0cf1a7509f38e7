#include <igeo/results/refined_mesh.h>

#include <fmt/core.h>
#include <igeo/base/error.h>

#include <string>
#include <utility>

namespace igeo {

namespace {

using Triangle = SurfaceMesh::Triangle;
constexpr std::uint32_t kWhole = std::numeric_limits<std::uint32_t>::max();

/// Splits a triangle at the midpoints of its edges, where there are any.
/// @param m  the midpoint of the edge from corner k to k + 1, or kWhole
void cut(Triangle t, std::array<std::uint32_t, 3> m, const std::vector<Vec3d>& p,
         std::vector<Triangle>& out) {
    int count = 0;
    for (const std::uint32_t i : m) count += i != kWhole;
    if (count == 0) {
        out.push_back(t);
        return;
    }
    if (count == 3) {
        out.insert(
            out.end(),
            {{t[0], m[0], m[2]}, {m[0], t[1], m[1]}, {m[2], m[1], t[2]}, {m[0], m[1], m[2]}});
        return;
    }
    // Rotated so that the first edge is split and the last is whole.
    while (m[0] == kWhole || m[2] != kWhole) {
        t = {t[1], t[2], t[0]};
        m = {m[1], m[2], m[0]};
    }
    if (count == 1) {
        out.insert(out.end(), {{t[0], m[0], t[2]}, {m[0], t[1], t[2]}});
        return;
    }
    // A corner, and a quadrilateral cut along its shorter diagonal.
    out.push_back({m[0], t[1], m[1]});
    if (length(p[m[0]] - p[t[2]]) <= length(p[t[0]] - p[m[1]]))
        out.insert(out.end(), {{t[0], m[0], t[2]}, {m[0], m[1], t[2]}});
    else
        out.insert(out.end(), {{t[0], m[0], m[1]}, {t[0], m[1], t[2]}});
}

/// @return whether an edge was too long
bool halve(SurfaceMesh& mesh, double longest) {
    const MeshEdges edges = meshEdges(mesh);
    std::vector<std::uint32_t> middle(edges.ends.size(), kWhole);
    bool any = false;
    for (std::size_t e = 0; e < middle.size(); ++e) {
        const Vec3d a = mesh.position[edges.ends[e][0]], b = mesh.position[edges.ends[e][1]];
        if (length(b - a) <= longest) continue;
        middle[e] = std::uint32_t(mesh.position.size());
        mesh.position.push_back(0.5 * (a + b));
        any = true;
    }
    if (!any) return false;
    std::vector<Triangle> finer;
    finer.reserve(2 * mesh.triangles.size());
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        const auto& e = edges.ofTriangle[t];
        cut(mesh.triangles[t], {middle[e[0]], middle[e[1]], middle[e[2]]}, mesh.position, finer);
    }
    mesh.triangles.swap(finer);
    return true;
}

}  // namespace

SurfaceMesh meshAsGiven(const TriangleMesh& given, const Similarity& transform) {
    TriangleMesh oriented = given;
    orientConsistently(oriented);
    SurfaceMesh mesh;
    mesh.triangles = std::move(oriented.triangles);
    mesh.position.reserve(oriented.points.size());
    for (const Vec3d& p : oriented.points) mesh.position.push_back(transform.indexFromWorld(p));
    return mesh;
}

SurfaceMesh refinedMesh(const TriangleMesh& given, const Field& field, double longest,
                        Progress& progress) {
    if (!(longest > 0))
        throw Error(Error::Kind::InvalidArgument,
                    fmt::format("edges of at most {:g} voxels; more than 0 is allowed", longest),
                    "1 is usual");
    constexpr std::size_t kMost = std::size_t(1) << 31;
    progress.update("mesh", 0);
    SurfaceMesh mesh = meshAsGiven(given, field.band->transform);
    while (halve(mesh, longest)) {
        progress.throwIfCancelled();
        if (mesh.triangles.size() > kMost / 4)
            throw Error(
                Error::Kind::InvalidArgument,
                fmt::format("edges of at most {:g} voxels make more than 2147483648 triangles",
                            longest),
                "allow longer edges");
    }
    progress.update("mesh", 0.5);
    sampleField(mesh, field, progress);
    return mesh;
}

}  // namespace igeo
