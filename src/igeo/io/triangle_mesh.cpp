#include <igeo/io/triangle_mesh.h>

#include <fmt/core.h>
#include <igeo/base/detail/box.h>
#include <igeo/base/detail/disjoint_sets.h>
#include <igeo/base/error.h>
#include <igeo/io/detail/mesh_edges.h>

#include <algorithm>
#include <unordered_map>
#include <utility>

namespace igeo {

namespace {

using Kind = Error::Kind;
using Triangle = TriangleMesh::Triangle;
constexpr std::uint32_t kNone = MeshTopology::kNone;

/// Per point in a box, the earliest point within `tolerance` that is not itself replaced by
/// another; others stay as they are.
std::vector<std::uint32_t> earliestNear(const std::vector<Vec3d>& points, const Box& box,
                                        double tolerance) {
    std::vector<std::uint32_t> same(points.size());
    const Vec3d low = box.low;
    // Cells of four tolerances: most points read one cell only. A cell number has 21 bits per axis.
    const double cells = tolerance > 0 ? 1 / (4 * tolerance) : 0;
    auto cellOf = [&](const Vec3d& p) {
        std::array<std::uint64_t, 3> c{};
        for (int a = 0; a < 3; ++a)
            c[std::size_t(a)] = std::uint64_t(std::max(0.0, (p[a] - low[a]) * cells));
        return c;
    };
    auto key = [](std::uint64_t x, std::uint64_t y, std::uint64_t z) {
        return x << 42 | y << 21 | z;
    };
    // Per cell a chain of the points that are not replaced.
    std::unordered_map<std::uint64_t, std::uint32_t> newest;
    std::vector<std::uint32_t> older(points.size(), kNone);
    newest.reserve(points.size() / 2);
    const Vec3d reach{tolerance, tolerance, tolerance};
    for (std::size_t i = 0; i < points.size(); ++i) {
        same[i] = std::uint32_t(i);
        if (!box.contains(points[i])) continue;
        std::uint32_t found = kNone;
        const auto from = cellOf(points[i] - reach), to = cellOf(points[i] + reach);
        for (auto x = from[0]; x <= to[0]; ++x)
            for (auto y = from[1]; y <= to[1]; ++y)
                for (auto z = from[2]; z <= to[2]; ++z) {
                    const auto at = newest.find(key(x, y, z));
                    for (std::uint32_t j = at == newest.end() ? kNone : at->second; j != kNone;
                         j = older[j])
                        if (length(points[j] - points[i]) <= tolerance) found = std::min(found, j);
                }
        if (found != kNone) {
            same[i] = found;
            continue;
        }
        const auto c = cellOf(points[i]);
        const auto [at, isNew] = newest.try_emplace(key(c[0], c[1], c[2]), std::uint32_t(i));
        if (!isNew) older[i] = std::exchange(at->second, std::uint32_t(i));
    }
    return same;
}

/// Which triangles to flip to agree with the first of their component, and which components cannot
/// be oriented.
struct Turns {
    std::vector<bool> turned;
    std::vector<bool> oneSided;  ///< per component
};

/// Triangles joined through edges of two, oriented alike.
class Patches {
public:
    Patches(const TriangleMesh& mesh, const MeshTopology& topology, Turns& turns)
        : mesh_(mesh), topology_(topology), turns_(turns), patch_(mesh.triangles.size(), kNone) {
        for (std::uint32_t t = 0; t < patch_.size(); ++t)
            if (patch_[t] == kNone) grow(t);
        if (topology.nonManifoldEdges > 0) joinAtManyEdges();
    }

private:
    void grow(std::uint32_t start) {
        const auto number = std::uint32_t(members_.size());
        std::vector<std::uint32_t> queue(1, start);
        patch_[start] = number;
        for (std::size_t at = 0; at < queue.size(); ++at) {
            const std::uint32_t t = queue[at];
            for (std::size_t k = 0; k < 3; ++k) {
                const std::uint32_t u = topology_.neighbor[t][k];
                if (u == kNone || u == MeshTopology::kMany) continue;
                const bool turn = turns_.turned[t] != runsAlike(t, u, k);
                if (patch_[u] == kNone)
                    patch_[u] = number, turns_.turned[u] = turn, queue.push_back(u);
                else if (turns_.turned[u] != turn)
                    turns_.oneSided[topology_.component[t]] = true;
            }
        }
        if (2 * turnedOf(queue) > queue.size()) turnOver(queue);
        members_.push_back(std::move(queue));
    }

    /// At edges of three or more triangles, orients each patch by the next, as far as that closes
    /// no cycle. The smaller part is flipped.
    void joinAtManyEdges() {
        DisjointSets joined(members_.size());
        forEdges(
            mesh_.points.size(), mesh_.triangles, [&](const HalfEdge* first, const HalfEdge* last) {
                for (const HalfEdge* e = first; last - first > 2 && e + 1 < last; ++e) {
                    std::uint32_t a = joined.first(patch_[e[0].triangle]),
                                  b = joined.first(patch_[e[1].triangle]);
                    if (a == b) continue;
                    if (members_[a].size() < members_[b].size()) std::swap(a, b);
                    const bool alike = (e[0].up != turns_.turned[e[0].triangle]) ==
                                       (e[1].up != turns_.turned[e[1].triangle]);
                    if (alike) turnOver(members_[b]);
                    members_[a].insert(members_[a].end(), members_[b].begin(), members_[b].end());
                    std::vector<std::uint32_t>().swap(members_[b]);
                    joined.join(a, b);
                    members_[joined.first(a)].swap(members_[a]);
                }
            });
    }

    bool runsAlike(std::uint32_t t, std::uint32_t u, std::size_t k) const {
        const std::uint32_t from = mesh_.triangles[t][k], to = mesh_.triangles[t][(k + 1) % 3];
        for (std::size_t m = 0; m < 3; ++m)
            if (mesh_.triangles[u][m] == from && mesh_.triangles[u][(m + 1) % 3] == to) return true;
        return false;
    }
    std::size_t turnedOf(const std::vector<std::uint32_t>& part) const {
        return std::size_t(std::count_if(part.begin(), part.end(),
                                         [&](std::uint32_t t) { return turns_.turned[t]; }));
    }
    void turnOver(const std::vector<std::uint32_t>& part) {
        for (const std::uint32_t t : part) turns_.turned[t] = !turns_.turned[t];
    }

    const TriangleMesh& mesh_;
    const MeshTopology& topology_;
    Turns& turns_;
    std::vector<std::uint32_t> patch_;                 ///< per triangle
    std::vector<std::vector<std::uint32_t>> members_;  ///< per patch
};

Turns findTurns(const TriangleMesh& mesh, const MeshTopology& topology) {
    Turns turns{std::vector<bool>(mesh.triangles.size()), std::vector<bool>(topology.components)};
    const Patches patches(mesh, topology, turns);
    return turns;
}

}  // namespace

void weld(TriangleMesh& mesh) {
    mesh.unsplit.clear();
    // A point without a triangle, however far away, says nothing about the size of S.
    Box box;
    for (const Triangle& t : mesh.triangles)
        for (const std::uint32_t v : t) box.include(mesh.points[v]);
    const auto same = earliestNear(mesh.points, box, TriangleMesh::kSame * length(box.size()));
    for (Triangle& t : mesh.triangles)
        for (std::uint32_t& v : t) v = same[v];

    // Of equal triangles the first is kept.
    std::vector<std::pair<Triangle, std::uint32_t>> sorted;
    sorted.reserve(mesh.triangles.size());
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        sorted.emplace_back(mesh.triangles[t], std::uint32_t(t));
        std::sort(sorted.back().first.begin(), sorted.back().first.end());
    }
    std::sort(sorted.begin(), sorted.end());
    std::vector<bool> drop(mesh.triangles.size());
    for (std::size_t k = 0; k < sorted.size(); ++k) {
        const auto& [a, b, c] = sorted[k].first;
        const bool thin = a == b || b == c,
                   again = !thin && k > 0 && sorted[k].first == sorted[k - 1].first;
        mesh.repeated += again;
        drop[sorted[k].second] = thin || again;
    }
    std::size_t kept = 0;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
        if (!drop[t]) mesh.triangles[kept++] = mesh.triangles[t];
    mesh.dropped += mesh.triangles.size() - kept;
    mesh.triangles.resize(kept);

    std::vector<std::uint32_t> name(mesh.points.size(), kNone);
    for (const Triangle& t : mesh.triangles)
        for (const std::uint32_t v : t) name[v] = 0;
    std::uint32_t count = 0;
    for (std::size_t i = 0; i < name.size(); ++i)
        if (name[i] != kNone) mesh.points[count] = mesh.points[i], name[i] = count++;
    mesh.points.resize(count);
    for (Triangle& t : mesh.triangles)
        for (std::uint32_t& v : t) v = name[v];
    if (!mesh.source) return;
    mesh.pointOfVertex.resize(same.size());
    for (std::size_t v = 0; v < same.size(); ++v) mesh.pointOfVertex[v] = name[same[v]];
}

MeshTopology meshTopology(const TriangleMesh& mesh) {
    MeshTopology topology;
    topology.neighbor.assign(mesh.triangles.size(), {kNone, kNone, kNone});
    DisjointSets joined(mesh.triangles.size());
    forEdges(mesh.points.size(), mesh.triangles, [&](const HalfEdge* first, const HalfEdge* last) {
        topology.boundaryEdges += last - first == 1;
        topology.nonManifoldEdges += last - first > 2;
        for (const HalfEdge* e = first + 1; e < last; ++e)
            joined.join(first->triangle, e->triangle);
        if (last - first > 2)
            for (const HalfEdge* e = first; e < last; ++e)
                topology.neighbor[e->triangle][e->corner] = MeshTopology::kMany;
        if (last - first != 2) return;
        topology.neighbor[first[0].triangle][first[0].corner] = first[1].triangle;
        topology.neighbor[first[1].triangle][first[1].corner] = first[0].triangle;
    });
    topology.component.resize(mesh.triangles.size());
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
        // The first member of a set already has a number.
        const std::uint32_t root = joined.first(t);
        topology.component[t] =
            root == t ? std::uint32_t(topology.components++) : topology.component[root];
    }
    const Turns turns = findTurns(mesh, topology);
    topology.nonOrientable =
        std::size_t(std::count(turns.oneSided.begin(), turns.oneSided.end(), true));
    return topology;
}

namespace {

/// Turns all triangles of closed components if these enclose a negative volume in all. A single one
/// may, as the wall of a cavity.
void turnInsideOut(const TriangleMesh& mesh, const MeshTopology& topology, Turns& turns) {
    std::vector<bool> open(topology.components);
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
        for (const std::uint32_t beyond : topology.neighbor[t])
            if (beyond == kNone || beyond == MeshTopology::kMany)
                open[topology.component[t]] = true;
    auto isClosed = [&](std::size_t t) {
        const std::uint32_t c = topology.component[t];
        return !open[c] && !turns.oneSided[c];
    };
    double volume = 0;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        if (!isClosed(t)) continue;
        const Triangle& v = mesh.triangles[t];
        const Vec3d a = mesh.points[v[0]] - mesh.points[0], b = mesh.points[v[1]] - mesh.points[0],
                    c = mesh.points[v[2]] - mesh.points[0];
        volume += (turns.turned[t] ? -1 : 1) * dot(a, cross(b, c));
    }
    if (!(volume < 0)) return;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
        if (isClosed(t)) turns.turned[t] = !turns.turned[t];
}

}  // namespace

std::size_t orientConsistently(TriangleMesh& mesh, MeshTopology& topology) {
    Turns turns = findTurns(mesh, topology);
    turnInsideOut(mesh, topology, turns);
    std::size_t count = 0;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        if (!turns.turned[t]) continue;
        std::swap(mesh.triangles[t][1], mesh.triangles[t][2]);
        std::swap(topology.neighbor[t][0], topology.neighbor[t][2]);
        ++count;
    }
    return count;
}
std::size_t orientConsistently(TriangleMesh& mesh) {
    MeshTopology topology = meshTopology(mesh);
    return orientConsistently(mesh, topology);
}

double meshArea(const TriangleMesh& mesh) {
    double area = 0;
    for (const auto& [a, b, c] : mesh.triangles)
        area += length(cross(mesh.points[b] - mesh.points[a], mesh.points[c] - mesh.points[a])) / 2;
    return area;
}

double estimatedVoxels(const TriangleMesh& mesh, double dx, double halfWidth) {
    return meshArea(mesh) / (dx * dx) * 2 * halfWidth;
}

void requireReasonable(const TriangleMesh& mesh, double dx, double halfWidth) {
    const std::string where = " (" + mesh.file + ")";
    if (mesh.triangles.empty())
        throw Error(Kind::BadInput, "the mesh has no triangles" + where, "give a surface");
    if (!(dx > 0) || !std::isfinite(dx))
        throw Error(Kind::InvalidArgument,
                    fmt::format("a voxel size of {:.4g} is not a positive number{}", dx, where),
                    "give a length in the units of the mesh");
    const Box box(mesh.points);
    constexpr double kMostVoxels = 1e9;
    const double voxels = estimatedVoxels(mesh, dx, halfWidth);
    if (!(voxels <= kMostVoxels))
        throw Error(
            Kind::InvalidArgument,
            fmt::format("at a voxel size of {:.4g} the mesh fills about {:.4g} voxels, {:.4g} are "
                        "the most{}",
                        dx, voxels, kMostVoxels, where),
            fmt::format("take a voxel size of {:.4g} or more; its bounding box is {:.4g} across",
                        dx * std::sqrt(voxels / kMostVoxels), length(box.size())));
    if (const double farthest = box.farthest() / dx; !(farthest < kFarthestIndex))
        throw Error(Kind::InvalidArgument,
                    fmt::format("at a voxel size of {:.4g} the mesh lies {:.4g} voxels from the "
                                "origin, {:.4g} are the most{}",
                                dx, farthest, double(kFarthestIndex), where),
                    "move the mesh to the origin, or take larger voxels");
}

}  // namespace igeo
