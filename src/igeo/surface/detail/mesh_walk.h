/// Walks over the triangles of a mesh: the distance of two points along it. Internal.
#pragma once

#include <igeo/band/detail/short_walk.h>
#include <igeo/io/triangle_mesh.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace igeo {

/// Adjacency of triangles through edges of any number of triangles.
class MeshAdjacency {
public:
    /// @param mesh, topology  must outlive it
    MeshAdjacency(const TriangleMesh& mesh, const MeshTopology& topology);

    const TriangleMesh& mesh() const { return mesh_; }
    const TriangleMesh::Triangle& operator[](std::size_t t) const { return mesh_.triangles[t]; }
    const Vec3d& corner(std::size_t t, std::size_t k) const {
        return mesh_.points[mesh_.triangles[t][k % 3]];
    }
    /// Unit normal of a triangle; zero for one without area.
    Vec3d normal(std::size_t t) const {
        const Vec3d& a = corner(t, 0);
        return normalized(cross(corner(t, 1) - a, corner(t, 2) - a));
    }
    bool mayJoin(std::uint32_t t, std::uint32_t u) const {
        return componentOf(t) == componentOf(u);
    }
    /// Calls visit(u) for the triangles beyond the edge from corner k of triangle t to the next
    /// corner.
    template <typename Visit>
    void forBeyond(std::uint32_t t, std::size_t k, const Visit& visit) const {
        const std::uint32_t u = topology_.neighbor[t][k];
        if (u < MeshTopology::kMany) return visit(u);
        if (u == MeshTopology::kNone) return;
        for (auto at = firstAtEdge(t, k); at != many_.end() && at->first == edge(t, k); ++at)
            if (at->second != t) visit(at->second);
    }
    std::size_t components() const { return topology_.components; }
    std::uint32_t componentOf(std::uint32_t t) const { return topology_.component[t]; }
    bool isBoundary(std::uint32_t t, std::size_t k) const {
        return topology_.neighbor[t][k] == MeshTopology::kNone;
    }
    /// Whether three or more triangles meet in the edge.
    bool isMany(std::uint32_t t, std::size_t k) const {
        return topology_.neighbor[t][k] == MeshTopology::kMany;
    }
    /// Whether exactly one triangle lies beyond the edge.
    bool isPlain(std::uint32_t t, std::size_t k) const {
        return topology_.neighbor[t][k] < MeshTopology::kMany;
    }

private:
    using Edge = std::pair<std::uint32_t, std::uint32_t>;
    using AtEdge = std::pair<Edge, std::uint32_t>;

    Edge edge(std::uint32_t t, std::size_t k) const {
        return std::minmax({mesh_.triangles[t][k], mesh_.triangles[t][(k + 1) % 3]});
    }
    std::vector<AtEdge>::const_iterator firstAtEdge(std::uint32_t t, std::size_t k) const;

    const TriangleMesh& mesh_;
    const MeshTopology& topology_;
    std::vector<AtEdge> many_;  ///< triangles at edges of three or more, sorted
};

using MeshWalk = ShortWalk<MeshAdjacency>;

}  // namespace igeo
