#include <igeo/surface/detail/mesh_walk.h>

#include <igeo/base/detail/box.h>
#include <igeo/base/detail/disjoint_sets.h>
#include <igeo/base/nearest_on_triangle.h>
#include <igeo/base/point_tree.h>

#include <algorithm>

namespace igeo {

MeshAdjacency::MeshAdjacency(const TriangleMesh& mesh, const MeshTopology& topology)
    : mesh_(mesh), topology_(topology) {
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t)
        for (std::size_t k = 0; k < 3; ++k)
            if (topology.neighbor[t][k] == MeshTopology::kMany) many_.emplace_back(edge(t, k), t);
    std::sort(many_.begin(), many_.end());
    if (topology.boundaryEdges > 0) findSeams();
    numberComponents();
}

bool MeshAdjacency::overlap(const Side& a, const Side& b, double tolerance) const {
    auto on = [&](const Vec3d& p, const Side& s) {
        return distanceToSegment(p, end(s, 0), end(s, 1)) <= tolerance;
    };
    int ends = 0;
    Vec3d first;
    for (std::size_t k = 0; k < 2; ++k)
        for (const auto& [p, s] : {std::pair(end(a, k), b), std::pair(end(b, k), a)}) {
            // Two ends at one point are a common corner.
            if (!on(p, s) || (ends > 0 && length(p - first) <= 2 * tolerance)) continue;
            if (ends++ == 0) first = p;
        }
    return ends >= 2;
}

void MeshAdjacency::findSeams() {
    constexpr double kTolerance = 1e-6;  // as weld
    const double tolerance = kTolerance * length(Box(mesh_.points).size());
    std::vector<Side> sides;
    std::vector<Vec3d> middles;
    auto halfOf = [&](const Side& s) { return length(end(s, 1) - end(s, 0)) / 2; };
    for (std::uint32_t t = 0; t < mesh_.triangles.size(); ++t)
        for (std::uint32_t k = 0; k < 3; ++k)
            if (isBoundary(t, k)) {
                sides.emplace_back(t, k);
                middles.push_back(0.5 * (end(sides.back(), 0) + end(sides.back(), 1)));
            }
    PointTree tree(middles);
    std::vector<double> reach;
    for (std::size_t k = 0; k < sides.size(); ++k)
        reach.push_back(halfOf(sides[tree.inputIndex(k)]));
    tree.setReach(std::move(reach));
    for (std::size_t k = 0; k < sides.size(); ++k)
        tree.forReaching(middles[k], halfOf(sides[k]) + tolerance, [&](PointTree::Index i) {
            const std::size_t other = tree.inputIndex(i);
            if (other <= k || !overlap(sides[k], sides[other], tolerance)) return;
            seams_.emplace_back(sides[k], sides[other].first);
            seams_.emplace_back(sides[other], sides[k].first);
        });
    std::sort(seams_.begin(), seams_.end());
}

void MeshAdjacency::numberComponents() {
    component_ = topology_.component;
    components_ = topology_.components;
    if (seams_.empty()) return;
    DisjointSets joined(components_);
    for (const auto& [side, u] : seams_) joined.join(component_[side.first], component_[u]);
    std::vector<std::uint32_t> number(components_);
    components_ = 0;
    for (std::uint32_t c = 0; c < number.size(); ++c)
        number[c] = joined.first(c) == c ? std::uint32_t(components_++) : number[joined.first(c)];
    for (std::uint32_t& c : component_) c = number[c];
}

std::vector<MeshAdjacency::AtEdge>::const_iterator MeshAdjacency::firstAtEdge(std::uint32_t t,
                                                                              std::size_t k) const {
    return std::lower_bound(many_.begin(), many_.end(), AtEdge(edge(t, k), 0));
}

}  // namespace igeo
