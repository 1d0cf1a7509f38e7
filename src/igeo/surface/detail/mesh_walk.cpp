#include <igeo/surface/detail/mesh_walk.h>

#include <algorithm>

namespace igeo {

MeshAdjacency::MeshAdjacency(const TriangleMesh& mesh, const MeshTopology& topology)
    : mesh_(mesh), topology_(topology) {
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t)
        for (std::size_t k = 0; k < 3; ++k)
            if (topology.neighbor[t][k] == MeshTopology::kMany) many_.emplace_back(edge(t, k), t);
    std::sort(many_.begin(), many_.end());
}

std::vector<MeshAdjacency::AtEdge>::const_iterator MeshAdjacency::firstAtEdge(std::uint32_t t,
                                                                              std::size_t k) const {
    return std::lower_bound(many_.begin(), many_.end(), AtEdge(edge(t, k), 0));
}

}  // namespace igeo
