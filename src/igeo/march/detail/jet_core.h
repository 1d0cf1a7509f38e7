/// What scheme `jet` knows while it runs: the core's nodes, their jets, and how they see each
/// other. Filled by the march (jet.cpp), read by the extension to the rest of the band
/// (jet_extend.cpp).
#pragma once

#include <igeo/band/band.h>
#include <igeo/band/surface_point.h>
#include <igeo/band/tangent_frame.h>
#include <igeo/march/detail/jet_update.h>
#include <igeo/march/field.h>
#include <igeo/metric/metric.h>

#include <array>
#include <vector>

namespace igeo {

/// Costs along the two axes of a metric in a tangent plane may differ by this much before links are
/// too few neighbors, and by this much at all: measured, docs/method.md.
constexpr float kLinksRatio = 2, kLargestRatio = 20;

constexpr std::uint32_t kNoBucket = std::numeric_limits<std::uint32_t>::max();

/// What a solve found out about a node.
struct Solved {
    double u = kInfinity;
    Vec3f g;                  ///< gradient over the node's weight
    std::uint32_t label = 0;  ///< the source whose front it is
    bool guarded = false;
    bool stands = false;  ///< no node still to come can change it
};

/// Nodes around a foot point that have a jet, as the local solve sees them, and whose fronts they
/// belong to.
struct Surroundings {
    JetNeighbors all;
    std::array<std::uint32_t, JetNeighbors::kMax> label;
    bool oneLabel = true;

    void add(const JetNeighbor& n, std::uint32_t from) {
        const auto k = std::size_t(all.count());
        label[k] = from;
        oneLabel &= from == label[0];
        all.add(n);
    }
    bool full() const { return all.count() == JetNeighbors::kMax; }
    /// jetUpdate; fronts of different sources are never fitted together, the lesser value counts,
    /// and the earlier source where they are equal. In the picture's coordinates.
    Jet update(std::uint32_t& from) const;
};

/// A foot point to solve at: its tangent plane and the metric in it.
struct Place {
    TangentFrame frame;
    double weight;    ///< of the isotropic metric, or PlaneMetric's
    Stretch stretch;  ///< none where the metric is isotropic
};

/// Whether two foot points, `chord` apart, lie on either side of a gap or a plate rather than of a
/// crease: both normals along the chord, and the chord longer than between neighbors on one sheet
/// (sqrt(3), and a bit). In gaps of about two voxels psi bends normals away from each other, and
/// Band::kOtherSheet alone does not tell.
inline bool acrossGap(const Vec3f& chord, const Vec3f& a, const Vec3f& b) {
    constexpr float kFar2 = 3.2f, kAlong2 = 0.25f;
    const float c2 = dot(chord, chord), alongA = dot(a, chord), alongB = dot(b, chord);
    return c2 > kFar2 && alongA * alongB < 0 &&
           std::min(alongA * alongA, alongB * alongB) > kAlong2 * c2;
}

/// The core of a band in a metric, with its seeds.
struct JetCore {
    /// All that a march touches of a core node, side by side.
    struct Node {
        double u = kInfinity;  ///< +inf until accepted
        Vec3f g, foot, normal;
        LeafIndex leaf;
        std::uint32_t bucket = kNoBucket;  ///< the bucket it waits in; 0 once it is taken out
        std::uint16_t offset;
        Metric::Sight sight;
        float weight;
    };

    /// @throws Error  InvalidArgument where costs along S differ by more than kLargestRatio
    JetCore(const Band& band, const Metric& metric, const std::vector<SurfacePoint>& seeds,
            double startRadius);

    const Band& band;
    const Metric& metric;
    const double startRadius;
    std::vector<SurfacePoint> seeds;
    std::vector<std::uint32_t> source;  ///< per seed (sourcesOf)
    SeedsNear seedsNear;                ///< finds those whose start discs hold a place
    std::vector<Vec3f> seedNormal;
    std::vector<PlaneMetric> seedPlane;  ///< in the frames of their nodes; empty: isotropic
    double first = kInfinity;            ///< the least start value
    double leastCost = kInfinity;        ///< per unit length, of the core along S
    bool varied = false;                 ///< costs differ from node to node
    std::vector<Node> nodes;
    std::vector<Stretch> stretch;      ///< per core node; empty: isotropic
    std::vector<std::uint32_t> label;  ///< per core node; empty for one source
    /// The neighbors of node i from stencilFirst[i] on, where links are not enough (kLinksRatio);
    /// empty: links. If j is one of i's, i is one of j's: an accepted node keys whoever sees it.
    std::vector<NodeIndex> stencil;
    std::vector<std::uint32_t> stencilFirst;
    static constexpr std::size_t kMaxStencil = 64;  ///< per node
    double discEnd = 0;                             ///< the largest value in a start disc

    std::uint32_t labelOf(NodeIndex core) const { return label.empty() ? 0 : label[core]; }
    Ijk voxelOf(const Node& node) const {
        return band.leaves[node.leaf].origin +
               Ijk{node.offset >> 6, node.offset >> 3 & 7, node.offset & 7};
    }
    Vec3d footOf(const Node& node) const { return Vec3d(voxelOf(node)) + Vec3d(node.foot); }
    Place placeOf(NodeIndex core) const {
        return {TangentFrame(nodes[core].normal, band.faceted), double(nodes[core].weight),
                stretch.empty() ? Stretch{} : stretch[core]};
    }
    /// The place of any node of the band.
    Place placeInBand(NodeIndex i) const;

    /// Whether an obstacle hides core node j from a point of S.
    bool hidden(const Node& j, const Vec3d& p, const Vec3f& normal) const {
        return j.sight == Metric::Inside ||
               (j.sight == Metric::Beside &&
                metric.blocked(p, footOf(j), Vec3d(normalized(normal))));
    }

    /// Whether nothing comes between two nodes next to each other: another sheet, or an obstacle.
    /// @param chord, cosine  from the foot point of `other`; between their normals
    bool sees(const Node& node, const Node& other, const Vec3f& chord, float cosine) const {
        return cosine >= Band::kOtherSheet && !stacked(chord, node.normal, other.normal) &&
               !(cosine < 0.5f && acrossGap(chord, node.normal, other.normal)) &&
               !(node.sight != Metric::Clear &&
                 hidden(other, footOf(node), node.normal + other.normal));
    }
    /// Calls visit(j, step, chord, cosine) for the nodes within a voxel that node i sees.
    template <typename Visit>
    void forLinks(NodeIndex i, const Visit& visit) const {
        const Node& node = nodes[i];
        band.forNeighbors(
            &BandLeaf::core, node.leaf, node.offset, [&](NodeIndex j, int dx, int dy, int dz) {
                const Node& other = nodes[j];
                const float cosine = igeo::dot(node.normal, other.normal);
                const Vec3f chord = node.foot - other.foot - Vec3f{float(dx), float(dy), float(dz)};
                if (sees(node, other, chord, cosine)) visit(j, Ijk{dx, dy, dz}, chord, cosine);
            });
    }
    /// The same for the nodes of its stencil.
    template <typename Visit>
    void forStencil(NodeIndex i, const Visit& visit) const {
        const Node& node = nodes[i];
        const Ijk voxel = voxelOf(node);
        for (std::size_t k = stencilFirst[i]; k < stencilFirst[i + 1]; ++k) {
            const Node& other = nodes[stencil[k]];
            const float cosine = igeo::dot(node.normal, other.normal);
            if (cosine < Band::kOtherSheet) continue;
            const Ijk step = voxelOf(other) - voxel;
            visit(stencil[k], step, node.foot - other.foot - Vec3f(step), cosine);
        }
    }

    /// Adds an accepted node to what is seen from a place.
    /// @param chord, cosine  from its foot point to the place; between their normals
    void see(NodeIndex j, const Vec3f& chord, float cosine, const Place& place,
             Surroundings& from) const {
        const Node& other = nodes[j];
        if (cosine < 0.9f) from.all.smooth = false;
        const auto here = float(place.weight);
        // Relative to the start: near a source the solve takes u for the distance to it.
        const double u = (other.u - first) / place.weight;
        from.add(stretch.empty()
                     ? flattened(place.frame, meanWeight(other.weight, here) * chord, other.normal,
                                 cosine, other.g, u)
                     : stretched(place.stretch, flattened(place.frame, chord, other.normal, cosine,
                                                          (other.weight / here) * other.g, u)),
                 labelOf(j));
    }
    /// Square of the cost of a chord from a place to a foot point nearby.
    /// @param chord  times the weight there
    double squaredCost(const Place& from, const Vec3f& chord) const {
        const float c2 = igeo::dot(chord, chord);
        if (stretch.empty()) return c2;
        const Vec2f flat = from.frame.flat(chord), way = from.stretch.way(flat);
        return c2 * dot(way, way) / std::max(dot(flat, flat), 1e-12f);
    }
    /// Per unit length, along S.
    double leastCostAt(NodeIndex core) const {
        const double weight = nodes[core].weight;
        return stretch.empty() ? weight : weight / double(stretch[core].largest());
    }
    double largestCost(NodeIndex core) const {
        const double weight = nodes[core].weight;
        return stretch.empty() ? weight : weight * double(stretch[core].largest());
    }

    /// A jet of the picture, back on S.
    Solved fromPicture(const Place& place, const Jet& jet, std::uint32_t from) const {
        return {first + place.weight * jet.u,
                place.frame.lift(stretch.empty() ? jet.g : place.stretch.covectorBack(jet.g)), from,
                jet.guarded};
    }
    /// What a place knows from what it sees.
    Solved solve(const Place& place, Surroundings& known) const {
        if (!stretch.empty()) {
            // In the picture the lattice is stretched, and segments between neighbors with it.
            const float l = place.stretch.largest();
            known.all.far2 *= l * l;
        }
        // Neighbors far to the sides say little about g, and fits would swing.
        if (!stencil.empty()) known.all.pull = 0.1f;
        std::uint32_t from = 0;
        const Jet jet = known.update(from);
        return fromPicture(place, jet, from);
    }

    /// The exact jet of seed k at a place, if that lies within its start disc.
    bool discJet(std::uint32_t k, const Place& place, const Vec3d& foot, Solved& s) const;

private:
    /// Nodes inside an obstacle, but next to one outside, stand on its rim, so that fronts go along
    /// the rim and not along the voxels outside of it.
    void placeRimNodes();
    void buildStencils();
    /// Cost of a chord at seed k, turned into its tangent plane.
    double seedCost(std::uint32_t k, const Vec3f& chord) const;
};

/// Fills distance, gradient and label of a field on the whole band: core nodes have their own jets,
/// the others take those of the core around their foot points.
/// @param limit  distances beyond it are not wanted
/// @param everywhere  whether the march reached all of the core; if not, leaves nobody came near
///                    to cost next to nothing
void extendJets(const JetCore& core, double limit, bool everywhere, Field& field);

}  // namespace igeo
