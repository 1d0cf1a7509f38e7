#include <igeo/march/detail/jet_extend.h>

#include <igeo/base/parallel.h>
#include <igeo/march/detail/jet_blend.h>
#include <igeo/march/detail/jet_neighborhood.h>
#include <igeo/march/detail/jet_start.h>

namespace igeo {

namespace {

/// Gives nodes outside the core the jets of the core around their foot points.
class Extension {
public:
    explicit Extension(const JetCore& core) : core_(core), band_(core.band), metric_(core.metric) {}

    /// A jet for a band node outside the core.
    /// @param l, at  its leaf and offset
    Solved extendTo(NodeIndex i, LeafIndex l, unsigned at) const;

    double weightOf(NodeIndex i) const {
        return metric_.anisotropic() ? core_.localFrameInBand(i).weight : metric_.at(i);
    }

private:
    /// Whether no severed links part node i from a core node.
    bool isJoined(NodeIndex i, const JetNode& other) const {
        return !(band_.facing[i] & Band::kBesideSevered) || band_.joined(i, core_.inBand(other));
    }
    double largestCost(NodeIndex i) const {
        if (!metric_.anisotropic()) return metric_.at(i);
        const LocalFrame local = core_.localFrameInBand(i);
        return local.weight * double(local.stretch.largest());
    }
    /// Core nodes beside a foot point.
    struct Corners {
        struct Corner {
            const JetNode* node;
            float weight;  ///< trilinear
            Vec3f chord;   ///< from its foot point
        };
        std::array<Corner, 8> corner;
        std::size_t count = 0;
    };

    Neighborhood neighborsOf(NodeIndex i, const Corners& corners, const LocalFrame& local) const;
    /// Every corner carries its jet to the foot point by the circular step (jet_fit.h).
    /// @param sum  of their gradients, weighted
    /// @return false where they are not of one front
    bool carryInSpace(NodeIndex i, const Corners& corners, const Vec3f& sum, Solved& s) const;
    /// The same with tensors.
    Solved carryInPlane(NodeIndex i, const Corners& corners, std::uint32_t label) const;
    /// Where the core around the foot point is not of one smooth front: as in the march.
    Solved solveFromCore(NodeIndex i, LeafIndex l, unsigned at) const;
    /// Adds the nodes of the core around a node that have a jet.
    /// @return whether any of it is on the node's sheet, reached or not
    bool gatherAround(NodeIndex i, LeafIndex l, unsigned at, const Ijk& middle, int reach,
                      const LocalFrame& local, Neighborhood& found) const;
    /// The jet of the start disc that holds the foot point; s where none does.
    Solved exactNearSeed(NodeIndex i, const Solved& s) const {
        constexpr double kMargin = 3;  // voxels
        return s.u > core_.seeds.largestInDisc + kMargin * largestCost(i) ? s : inDisc(i, s);
    }
    Solved inDisc(NodeIndex i, const Solved& s) const;

    const JetCore& core_;
    const Band& band_;
    const Metric& metric_;
};

Solved Extension::extendTo(NodeIndex i, LeafIndex l, unsigned at) const {
    constexpr float kFlat = 0.8f;
    const Vec3f n = band_.normal[i];
    // The corners around the foot point that are in the core, and their mean gradient.
    Corners corners;
    Solved s;
    Vec3f sum;
    bool simple = true;
    band_.forCornersOfFoot(&BandLeaf::core, i, l, at, [&](NodeIndex j, float w, const Vec3f& from) {
        const JetNode& node = core_.nodes[j];
        if (corners.count == 0) s.label = core_.labelOf(j);
        simple &= node.u < kInfinity && core_.labelOf(j) == s.label &&
                  dot(n, node.normal) >= kFlat && isJoined(i, node);
        corners.corner[corners.count++] = {&node, w, from - node.foot};
        sum += w * node.g;
    });
    if (corners.count == 0 || !metric_.clear(i)) simple = false;
    if (simple && metric_.anisotropic())
        s = carryInPlane(i, corners, s.label);
    else if (simple)
        simple = carryInSpace(i, corners, sum, s);
    return simple ? exactNearSeed(i, s) : solveFromCore(i, l, at);
}

bool Extension::carryInSpace(NodeIndex i, const Corners& corners, const Vec3f& sum,
                             Solved& s) const {
    s.g = normalized(tangential(sum, band_.normal[i]));
    // Directions in space, not in one plane, change the step by (k c)^2 / 12 at curvature k.
    const double origin = corners.corner[0].node->u, weight = metric_.at(i);
    float value = 0, total = 0;
    bool close = true;
    for (std::size_t c = 0; c < corners.count; ++c) {
        const auto& [node, w, chord] = corners.corner[c];
        const float cosine = dot(s.g, node->g);
        if (!(cosine >= jet::kSameFront)) return false;
        close &= cosine >= jet::kClose;
        value +=
            w * (float((node->u - origin) / weight) + meanWeight(node->weight, float(weight)) *
                                                          dot(s.g + node->g, chord) / (1 + cosine));
        total += w;
    }
    s.u = origin + weight * double(value / total);
    return close || jet::ofOneFront(neighborsOf(i, corners, core_.localFrameInBand(i)).all);
}

Neighborhood Extension::neighborsOf(NodeIndex i, const Corners& corners,
                                    const LocalFrame& local) const {
    Neighborhood around;
    for (std::size_t c = 0; c < corners.count; ++c) {
        const auto& [node, w, chord] = corners.corner[c];
        addNeighbor(core_, NodeIndex(node - core_.nodes.data()), chord,
                    dot(band_.normal[i], node->normal), local, around);
    }
    return around;
}

Solved Extension::carryInPlane(NodeIndex i, const Corners& corners, std::uint32_t label) const {
    const LocalFrame local = core_.localFrameInBand(i);
    BlendWeights weight{};
    for (std::size_t c = 0; c < corners.count; ++c) weight[c] = corners.corner[c].weight;
    return fromChart(core_, local, blendJets(neighborsOf(i, corners, local).all, weight), label);
}

Solved Extension::inDisc(NodeIndex i, const Solved& s) const {
    // The core around such a node has been reached from its seed, so that it is on the same sheet;
    // in the long discs of tensors it may have been along another path.
    constexpr double kOtherPath = 1.2;
    const Vec3d foot = band_.footPoint(i);
    Solved best;
    double leastStart = kInfinity;
    auto visit = [&](std::size_t k) {
        const SurfacePoint& seed = core_.seeds.points[k];
        if (core_.seeds.source[k] != s.label) return;
        leastStart = std::min(leastStart, seed.start);
        const Vec3d from = seed.nearestTo(foot);
        Solved disc;
        if (!metric_.blocked(from, foot, Vec3d(core_.seeds.normal[k])) &&
            seedNeighborhoodJet(core_, std::uint32_t(k), core_.localFrameInBand(i), foot, disc) &&
            (length(foot - from) <= core_.seeds.startRadius ||
             s.u - seed.start <= kOtherPath * (disc.u - seed.start)) &&
            disc.u < best.u)
            best = disc;
    };
    core_.seeds.near.forNear(foot, visit);
    if (best.u < kInfinity) return best;
    best = s;
    if (leastStart < kInfinity) best.u = std::max(s.u, leastStart);
    return best;
}

bool Extension::gatherAround(NodeIndex i, LeafIndex l, unsigned at, const Ijk& middle, int reach,
                             const LocalFrame& local, Neighborhood& found) const {
    // Further off than a cell's diagonal it may be another surface.
    constexpr float kNear2 = 3;
    const Vec3f& normal = local.frame.normal();
    bool onSheet = false;
    band_.forBox(&BandLeaf::core, l, at, middle, reach, [&](NodeIndex j, const Ijk& step) {
        const JetNode& other = core_.nodes[j];
        const float cosine = dot(normal, other.normal);
        const Vec3f chord = band_.foot[i] - other.foot - Vec3f(step);
        if (cosine < Band::kOtherSheet || dot(chord, chord) > kNear2 ||
            stacked(chord, normal, other.normal) || !isJoined(i, other))
            return;
        if (!metric_.clear(i) && isHidden(core_, other, band_.footPoint(i), normal + other.normal))
            return;
        onSheet = true;
        if (!(other.u < kInfinity) || found.full()) return;
        addNeighbor(core_, j, chord, cosine, local, found);
    });
    return onSheet;
}

Solved Extension::solveFromCore(NodeIndex i, LeafIndex l, unsigned at) const {
    const LocalFrame local = core_.localFrameInBand(i);
    Neighborhood around;
    // Where the foot point is off, the core passes within two voxels all the same.
    if (!gatherAround(i, l, at, roundToIjk(Vec3d(band_.foot[i])), 1, local, around))
        gatherAround(i, l, at, {}, 2, local, around);
    return exactNearSeed(i, solveJet(core_, local, around));
}

/// Per leaf: whether it or one beside it has been reached, so that its nodes may have a jet.
std::vector<std::uint8_t> leavesReached(const JetCore& core) {
    const std::vector<BandLeaf>& leaves = core.band.leaves;
    std::vector<std::uint8_t> reached(leaves.size()), beside(reached);
    for (const JetNode& node : core.nodes)
        if (node.u < kInfinity) reached[node.leaf] = 1;
    for (std::size_t l = 0; l < beside.size(); ++l)
        for (const LeafIndex m : leaves[l].neighbor)
            if (m != kNoLeaf && reached[m]) beside[l] = 1;
    return beside;
}

}  // namespace

void extendJets(const JetCore& core, double limit, bool everywhere, Field& field) {
    const Band& band = core.band;
    const Extension extension(core);
    // In parallel: the first touch of fresh memory costs more than what is written there.
    parallelFor(3, 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) {
            if (k == 0) field.distance.resize(band.size());
            if (k == 1) field.gradient.resize(band.size());
            if (k == 2 && !core.label.empty()) field.label.resize(band.size());
        }
    });
    const auto beside = everywhere ? std::vector<std::uint8_t>() : leavesReached(core);
    parallelFor(band.leaves.size(), 16, [&](std::size_t begin, std::size_t end) {
        for (std::size_t l = begin; l < end; ++l) {
            const BandLeaf& leaf = band.leaves[l];
            if (!everywhere && !beside[l]) {
                std::fill_n(field.distance.begin() + leaf.band.firstNode, leaf.band.count,
                            kInfinity);
                continue;
            }
            for (NodeIndex i = leaf.band.firstNode; i < leaf.band.firstNode + leaf.band.count;
                 ++i) {
                const unsigned at = band.offset[i];
                const NodeIndex k = leaf.core.node(at);
                Solved s = core.metric.inside(i) ? Solved{}
                           : k == kNoNode
                               ? extension.extendTo(i, LeafIndex(l), at)
                               : Solved{core.nodes[k].u, core.nodes[k].g, core.labelOf(k), false};
                if (k == kNoNode && s.u < kInfinity)
                    s.u = std::max(s.u, core.seeds.lines.from(s.label, band.footPoint(i)));
                const bool withinLimit = s.u <= limit;
                field.distance[i] = withinLimit ? s.u : kInfinity;
                field.gradient[i] = withinLimit ? float(extension.weightOf(i)) * s.g : Vec3f();
                if (!core.label.empty()) field.label[i] = s.label;
            }
        }
    });
}

}  // namespace igeo
