/// The core of a band in a metric, as scheme `jet` marches it: its nodes, and, for many marches,
/// the links between them. It depends on no seed, so all marches on a band share it. Filled by
/// buildJetCore (jet_core.cpp).
#pragma once

#include <igeo/band/band.h>
#include <igeo/band/detail/mesh_ways.h>
#include <igeo/band/surface_point.h>
#include <igeo/band/tangent_frame.h>
#include <igeo/march/detail/jet_link.h>
#include <igeo/march/detail/jet_neighbors.h>
#include <igeo/march/detail/jet_rim.h>
#include <igeo/march/detail/leaf_corners.h>
#include <igeo/metric/metric.h>

#include <algorithm>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

namespace igeo {

/// Costs along the two axes of a metric in a tangent plane may differ by this much before links are
/// too few neighbors, and by this much at all: measured, docs/trials.md, "Tensors".
constexpr float kLinksRatio = 2, kLargestRatio = 20;

/// The chart of a foot point: its tangent plane and the metric in it.
struct LocalFrame {
    TangentFrame frame;
    double weight;    ///< of the isotropic metric, or PlaneMetric's
    Stretch stretch;  ///< identity where the metric is isotropic
};

/// A core node on the surface. gatherCorners reads all but the leaf at once.
struct JetNode {
    Vec3f foot, normal;
    float weight;
    std::uint16_t offset;
    Metric::ObstacleState obstacleState;
    std::uint8_t facing;  ///< Band::facing
    LeafIndex leaf;
};

/// The core of a band in a metric.
struct JetCore {
    const Band& band;
    const MetricPtr metricPtr;
    const Metric& metric = *metricPtr;
    std::vector<JetNode> nodes;
    std::vector<Stretch> stretch;  ///< per core node; empty: isotropic
    JetLinks links;                ///< of all nodes; empty: each march makes them where it is
    JetRims rims;
    bool costsVary = false;        ///< from node to node
    bool stenciled = false;        ///< neighbors are those of JetStencil
    float largestRatio = 1;        ///< of the costs along the two axes in a tangent plane
    double leastCost = kInfinity;  ///< per unit length along S, over the core
    SharedLeafCorners corners;     ///< of the band; many marches share them

    JetCore(const Band& b, MetricPtr m) : band(b), metricPtr(std::move(m)) {}

    Ijk voxelOf(const JetNode& node) const {
        return band.leaves[node.leaf].origin +
               Ijk{node.offset >> 6, node.offset >> 3 & 7, node.offset & 7};
    }
    /// Whether a straight walk of any length costs as much per voxel as at its ends.
    bool isEven() const { return stretch.empty() && !costsVary && !metric.obstacles; }
    /// The band's number of a core node.
    NodeIndex inBand(const JetNode& node) const {
        return band.leaves[node.leaf].band.numberOf(node.offset);
    }
    /// Band::severedSteps of a core node.
    std::uint32_t severedSteps(const JetNode& node) const {
        return node.facing & Band::kSevered ? band.severedSteps(inBand(node)) : 0;
    }
    Vec3d footOf(const JetNode& node) const { return Vec3d(voxelOf(node)) + Vec3d(node.foot); }
    LocalFrame localFrame(NodeIndex core) const {
        return {TangentFrame(nodes[core].normal, band.faceted), double(nodes[core].weight),
                stretch.empty() ? Stretch{} : stretch[core]};
    }
    /// That of any node of the band.
    LocalFrame localFrameInBand(NodeIndex i) const {
        const TangentFrame frame(band.normal[i], band.faceted);
        if (stretch.empty()) return {frame, metric.at(i), {}};
        const PlaneMetric plane = metric.inPlane(frame, i);
        return {frame, plane.weight, plane.stretch};
    }

    /// Of fits (JetLanes): where neighbors lie far to the left and right they say little about the
    /// gradient, and fits would swing.
    float pull() const { return stenciled ? 0.1f : 0.005f; }
    /// Of fermatUpdate (JetNeighbors): in a chart that is stretched segments between neighbors are
    /// so too.
    float longest2(const Stretch& here) const {
        if (stretch.empty()) return JetNeighbors::kLongest2;
        const float l = here.largest();
        return JetNeighbors::kLongest2 * l * l;
    }

    /// Cost per unit length along S, in the cheapest and in the most expensive direction.
    double leastCostAt(NodeIndex core) const {
        const double weight = nodes[core].weight;
        return stretch.empty() ? weight : weight / double(stretch[core].largest());
    }
    double largestCostAt(NodeIndex core) const {
        const double weight = nodes[core].weight;
        return stretch.empty() ? weight : weight * double(stretch[core].largest());
    }
};

/// Whether the march has a node at another point than its own foot point: at the rim or a corner of
/// an obstacle. Its jet belongs to that point.
inline bool isMoved(const JetCore& core, NodeIndex k) {
    constexpr float kOff = 0.1f;  // voxels
    const JetNode& node = core.nodes[k];
    return node.obstacleState != Metric::Clear &&
           length(node.foot - core.band.footOf(core.inBand(node))) > kOff;
}

/// @throws Error  InvalidArgument for a metric that does not fit the band, where costs along S
///         differ by more than kLargestRatio, or for more nodes than links can name
/// Time O(n), in parallel; 10 bytes per node of the band. With stencils the links of all nodes are
/// made as well. Tensors that cost the same in all directions along S everywhere become weights.
std::unique_ptr<JetCore> buildJetCore(const Band& band, MetricPtr metric);

/// The neighbors of every node by Selling's reduction of the metric in its tangent plane, the nodes
/// that use it, and its links. Time O(n), in parallel.
JetStencil buildStencil(const JetCore& core);
/// Moves nodes inside an obstacle, but next to one outside, and those just outside onto its rim,
/// and others to its corners, so that fronts go along the rim and not along the voxels outside of
/// it. Time O(nodes beside obstacles), in parallel; four bytes per node of the core.
void placeRimNodes(JetCore& core);
/// Makes the links of all nodes. Time O(n), in parallel; 46 bytes per node of the band.
void buildLinks(JetCore& core, const JetStencil& stencil = {});

/// Whether an obstacle lies between core node j and a point of S, or around j.
inline bool isHidden(const JetCore& core, const JetNode& j, const Vec3d& p, const Vec3f& normal) {
    return j.obstacleState == Metric::Inside ||
           (j.obstacleState == Metric::Beside &&
            core.metric.blocked(p, core.footOf(j), Vec3d(normalized(normal))));
}

/// Whether a front passes between two nodes next to each other: no other sheet lies between them,
/// and no obstacle.
/// @param chord, cosine  from the foot point of `other`; between their normals
inline bool isLinked(const JetCore& core, const JetNode& node, const JetNode& other,
                     const Vec3f& chord, float cosine) {
    return onOneSheet(chord, node.normal, other.normal, cosine) &&
           !(node.obstacleState != Metric::Clear &&
             isHidden(core, other, core.footOf(node), node.normal + other.normal));
}

/// Calls visit(j, step, chord, cosine) for the nodes at the other ends of a node's bridges.
template <typename Visit>
void forBridges(const JetCore& core, const JetNode& node, const Visit& visit) {
    core.band.forBridges(core.inBand(node), [&](const Bridge& b) {
        if (b.jump) return;
        const NodeIndex j = core.band.coreNode(b.to);
        const JetNode& other = core.nodes[j];
        if (node.obstacleState != Metric::Clear &&
            isHidden(core, other, core.footOf(node), node.normal + other.normal))
            return;
        const Ijk step = core.voxelOf(other) - core.voxelOf(node);
        visit(j, step, b.stretch * (node.foot - other.foot - Vec3f(step)),
              dot(node.normal, other.normal));
    });
}

/// Calls visit(j, chord) for the nodes that the jumps of a bridged node lead to.
template <typename Visit>
void forJumps(const JetCore& core, NodeIndex i, const Visit& visit) {
    constexpr float kFar = 6;  // voxels: farther than bridges, from the spine
    const JetNode& node = core.nodes[i];
    core.band.forBridges(core.inBand(node), [&](const Bridge& b) {
        const NodeIndex j = core.band.coreNode(b.to);
        if (!b.jump || core.nodes[j].obstacleState == Metric::Inside) return;
        const Vec3f chord(core.footOf(node) - core.footOf(core.nodes[j]));
        if (core.isEven() || length(chord) < kFar) visit(j, b.stretch * chord);
    });
}

/// Calls visit(j, line) for the nodes from which ways lead to a node.
template <typename Visit>
void forWays(const JetCore& core, NodeIndex i, const Visit& visit) {
    const JetNode& node = core.nodes[i];
    // Voxels. Costs may vary along longer lines, and links lead around rims as well.
    constexpr double kAsLinks = 3;
    if (!(node.facing & Band::kHasWays)) return;
    core.band.ways->forTo(core.inBand(node), [&](const MeshWay& way) {
        if (way.atRim && core.costsVary && way.line.length > kAsLinks) return;
        const NodeIndex j = core.band.coreNode(way.from);
        if (core.nodes[j].obstacleState != Metric::Inside) visit(j, way.line);
    });
}

/// Calls visit(j, step, chord, cosine) for the nodes within a voxel that are linked to node i, and
/// over bridges.
/// @param isWanted(j)  whether to look at a node within a voxel at all
template <typename Visit, typename IsWanted>
void forLinks(const JetCore& core, NodeIndex i, const Visit& visit, const IsWanted& isWanted) {
    const JetNode& node = core.nodes[i];
    const std::uint32_t severed = core.severedSteps(node);
    core.band.forNeighbors(
        &BandLeaf::core, node.leaf, node.offset, [&](NodeIndex j, int dx, int dy, int dz) {
            if (severed & SeveredLinks::bit(dx, dy, dz) || !isWanted(j)) return;
            const JetNode& other = core.nodes[j];
            const float cosine = dot(node.normal, other.normal);
            const Vec3f chord = node.foot - other.foot - Vec3f{float(dx), float(dy), float(dz)};
            if (isLinked(core, node, other, chord, cosine))
                visit(j, Ijk{dx, dy, dz}, chord, cosine);
        });
    if (node.facing & Band::kBridged) forBridges(core, node, visit);
}

template <typename Visit>
void forLinks(const JetCore& core, NodeIndex i, const Visit& visit) {
    forLinks(core, i, visit, [](NodeIndex) { return true; });
}

/// The same for the nodes of its stencil, or for its links where there are no stencils.
template <typename Visit>
void forStencil(const JetCore& core, const JetStencil& stencil, NodeIndex i, const Visit& visit) {
    if (stencil.empty()) return forLinks(core, i, visit);
    const JetNode& node = core.nodes[i];
    const Ijk voxel = core.voxelOf(node);
    for (std::size_t k = stencil.begin[i]; k < stencil.begin[i + 1]; ++k) {
        const NodeIndex j = stencil.node[k];
        const JetNode& other = core.nodes[j];
        const float cosine = dot(node.normal, other.normal);
        if (cosine < Band::kOtherSheet) continue;
        const Ijk step = core.voxelOf(other) - voxel;
        visit(j, step, node.foot - other.foot - Vec3f(step), cosine);
    }
}

}  // namespace igeo
