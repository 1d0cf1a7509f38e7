/// What scheme `jet` knows while it runs, as plain data: the nodes of the core with their jets, the
/// neighbors they use, and the seeds. Filled by buildJetCore (jet_core.cpp), changed by the march
/// (jet.cpp), read by the extension to the rest of the band (jet_extend.cpp).
#pragma once

#include <igeo/band/band.h>
#include <igeo/band/surface_point.h>
#include <igeo/band/tangent_frame.h>
#include <igeo/march/field.h>
#include <igeo/metric/metric.h>

#include <algorithm>
#include <limits>
#include <vector>

namespace igeo {

/// Costs along the two axes of a metric in a tangent plane may differ by this much before links are
/// too few neighbors, and by this much at all: measured, docs/trials.md, "Tensors".
constexpr float kLinksRatio = 2, kLargestRatio = 20;

constexpr std::uint32_t kNoBucket = std::numeric_limits<std::uint32_t>::max();

/// The jet of a node as a solve leaves it.
struct Solved {
    double u = kInfinity;
    Vec3f g;                    ///< gradient over the node's weight
    std::uint32_t label = 0;    ///< the source whose front it is
    bool usedFallback = false;  ///< from fermatUpdate
    bool isFinal = false;       ///< no node still to come can change it
};

/// The chart of a foot point: its tangent plane and the metric in it.
struct LocalFrame {
    TangentFrame frame;
    double weight;    ///< of the isotropic metric, or PlaneMetric's
    Stretch stretch;  ///< identity where the metric is isotropic
};

/// All that a march touches of a core node, side by side.
struct JetNode {
    double u = kInfinity;  ///< +inf until accepted
    Vec3f g, foot, normal;
    LeafIndex leaf;
    std::uint32_t bucket = kNoBucket;  ///< in which it waits, 0 once taken out: jet_queue.h
    std::uint16_t offset;
    Metric::ObstacleState obstacleState;
    std::uint8_t facing;  ///< Band::facing
    float weight;
};

/// The neighbors of core nodes where links are not enough (kLinksRatio). If j is one of i's, i is
/// one of j's: so an accepted node enqueues all that use it.
struct JetStencil {
    static constexpr std::size_t kMax = 64;  ///< per node
    std::vector<NodeIndex> node;             ///< those of node i from begin[i] to begin[i + 1]
    std::vector<std::uint32_t> begin;

    bool empty() const { return node.empty(); }
};

struct JetSeeds {
    std::vector<SurfacePoint> points;
    std::vector<std::uint32_t> source;  ///< per seed (sourcesOf)
    SeedsNear near;                     ///< finds those whose start discs hold a point
    std::vector<Vec3f> normal;          ///< of S at the seed
    std::vector<PlaneMetric> plane;     ///< in the frames of their nodes; empty: isotropic
    double startRadius = 0;             ///< of the start discs, voxels
    double leastStart = kInfinity;      ///< the least start value
    double largestInDisc = 0;           ///< the largest value in a start disc
    StraightLines lines;                ///< below which no value is
};

/// The core of a band in a metric, with its seeds.
struct JetCore {
    const Band& band;
    const Metric& metric;
    JetSeeds seeds;
    std::vector<JetNode> nodes;
    std::vector<Stretch> stretch;      ///< per core node; empty: isotropic
    std::vector<std::uint32_t> label;  ///< per core node; empty for one source
    JetStencil stencil;                ///< empty: links
    double leastCost = kInfinity;      ///< per unit length along S, over the core
    bool variableCost = false;         ///< costs differ from node to node

    std::uint32_t labelOf(NodeIndex core) const { return label.empty() ? 0 : label[core]; }
    Ijk voxelOf(const JetNode& node) const {
        return band.leaves[node.leaf].origin +
               Ijk{node.offset >> 6, node.offset >> 3 & 7, node.offset & 7};
    }
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

    /// Cost per unit length along S, in the cheapest and in the dearest direction.
    double leastCostAt(NodeIndex core) const {
        const double weight = nodes[core].weight;
        return stretch.empty() ? weight : weight / double(stretch[core].largest());
    }
    double largestCostAt(NodeIndex core) const {
        const double weight = nodes[core].weight;
        return stretch.empty() ? weight : weight * double(stretch[core].largest());
    }
};

/// @throws Error  InvalidArgument where costs along S differ by more than kLargestRatio
/// Time O(n), in parallel.
JetCore buildJetCore(const Band& band, const Metric& metric, const std::vector<SurfacePoint>& seeds,
                     double startRadius);

/// The neighbors of every node by Selling's reduction of the metric in its tangent plane, the nodes
/// that use it, and its links. Time O(n), in parallel.
JetStencil buildStencil(const JetCore& core);

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

/// Calls visit(j, chord) for the nodes that a node's jumps lead to.
template <typename Visit>
void forJumps(const JetCore& core, NodeIndex i, const Visit& visit) {
    const JetNode& node = core.nodes[i];
    if (!(node.facing & Band::kBridged)) return;
    core.band.forBridges(core.inBand(node), [&](const Bridge& b) {
        const NodeIndex j = core.band.coreNode(b.to);
        if (b.jump && core.nodes[j].obstacleState != Metric::Inside)
            visit(j, b.stretch * Vec3f(core.footOf(node) - core.footOf(core.nodes[j])));
    });
}

/// Calls visit(j, step, chord, cosine) for the nodes within a voxel that are linked to node i, and
/// over bridges.
template <typename Visit>
void forLinks(const JetCore& core, NodeIndex i, const Visit& visit) {
    const JetNode& node = core.nodes[i];
    const std::uint32_t severed = core.severedSteps(node);
    core.band.forNeighbors(
        &BandLeaf::core, node.leaf, node.offset, [&](NodeIndex j, int dx, int dy, int dz) {
            if (severed & SeveredLinks::bit(dx, dy, dz)) return;
            const JetNode& other = core.nodes[j];
            const float cosine = dot(node.normal, other.normal);
            const Vec3f chord = node.foot - other.foot - Vec3f{float(dx), float(dy), float(dz)};
            if (isLinked(core, node, other, chord, cosine))
                visit(j, Ijk{dx, dy, dz}, chord, cosine);
        });
    if (node.facing & Band::kBridged) forBridges(core, node, visit);
}

/// The same for the nodes of its stencil, or for its links where there are no stencils.
template <typename Visit>
void forStencil(const JetCore& core, NodeIndex i, const Visit& visit) {
    if (core.stencil.empty()) return forLinks(core, i, visit);
    const JetNode& node = core.nodes[i];
    const Ijk voxel = core.voxelOf(node);
    for (std::size_t k = core.stencil.begin[i]; k < core.stencil.begin[i + 1]; ++k) {
        const NodeIndex j = core.stencil.node[k];
        const JetNode& other = core.nodes[j];
        const float cosine = dot(node.normal, other.normal);
        if (cosine < Band::kOtherSheet) continue;
        const Ijk step = core.voxelOf(other) - voxel;
        visit(j, step, node.foot - other.foot - Vec3f(step), cosine);
    }
}

}  // namespace igeo
