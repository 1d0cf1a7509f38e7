#include <igeo/march/detail/jet_core.h>

#include <igeo/base/error.h>
#include <igeo/base/parallel.h>

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <optional>

namespace igeo {

namespace {

constexpr std::uint32_t kNoRim = ~0u;  ///< a node that is not on a rim

/// Extremes of the cost over nodes of the core.
struct CostRange {
    double least = kInfinity, most = 0;  ///< of the least cost at a node
    float ratio = 1;            ///< the largest of the costs along the two axes in a tangent plane
    NodeIndex worst = kNoNode;  ///< band node at which it is

    void add(NodeIndex i, double cost, float stretch) {
        least = std::min(least, cost), most = std::max(most, cost);
        if (stretch * stretch > ratio) ratio = stretch * stretch, worst = i;
    }
    void add(const CostRange& other) {
        least = std::min(least, other.least), most = std::max(most, other.most);
        if (other.ratio > ratio) ratio = other.ratio, worst = other.worst;
    }
};

/// Fills the core nodes of a leaf, with the metric in their tangent planes.
CostRange fillLeaf(JetCore& core, LeafIndex l) {
    const Band& band = core.band;
    const Metric& metric = core.metric;
    const BandLeaf& leaf = band.leaves[l];
    CostRange costs;
    NodeIndex k = leaf.core.firstNode;
    auto fill = [&](unsigned o) {
        const NodeIndex i = leaf.band.numberOf(o);
        float weight;
        if (core.stretch.empty()) {
            const double cost = metric.at(i);
            weight = float(cost);
            costs.add(i, cost, 1);
        } else {
            const PlaneMetric plane = metric.inPlane(TangentFrame(band.normal[i]), i);
            weight = float(plane.weight);
            core.stretch[k] = plane.stretch;
            costs.add(i, plane.least(), plane.stretch.largest());
        }
        core.nodes[k++] = {band.footOf(i),
                           band.normal[i],
                           weight,
                           std::uint16_t(o),
                           metric.obstacleState.empty() ? Metric::Clear : metric.obstacleState[i],
                           band.facing[i],
                           l};
    };
    for (unsigned x = 0; x < 8; ++x)
        for (std::uint64_t bits = leaf.core.mask[x]; bits; bits &= bits - 1)
            fill(x << 6 | unsigned(std::countr_zero(bits)));
    return costs;
}

CostRange fillNodes(JetCore& core) {
    const Band& band = core.band;
    resizeByAll(core.nodes, band.coreSize());
    core.rims.resize(core.nodes.size());
    if (core.metric.anisotropic()) core.stretch.resize(core.nodes.size());
    std::vector<CostRange> ofLeaf(band.leaves.size());
    parallelFor(band.leaves.size(), 64, [&](std::size_t begin, std::size_t end) {
        for (std::size_t l = begin; l < end; ++l) ofLeaf[l] = fillLeaf(core, LeafIndex(l));
    });
    CostRange all;
    if (!core.metric.anisotropic()) all.least = core.metric.least();
    for (const CostRange& costs : ofLeaf) all.add(costs);
    return all;
}

void refuseLargeRatio(const Band& band, const CostRange& costs) {
    constexpr float kRounding = 1.001f;
    if (costs.ratio <= kRounding * kLargestRatio) return;
    throw Error(Error::Kind::InvalidArgument,
                "the metric at " + worldPlace(band, costs.worst) + " costs " +
                    shortText(double(costs.ratio)) +
                    " times as much in one direction along the surface as in another; jet takes "
                    "up to " +
                    shortText(double(kLargestRatio)),
                "bring the eigenvalues of the tensors closer together");
}

/// The metric with weights in place of tensors, where these cost the same in all directions along
/// S everywhere; the metric itself elsewhere.
MetricPtr asWeights(const Band& band, MetricPtr metric) {
    constexpr double kSame = 1e-4;   // of the costs along the two axes
    constexpr double kEqual = 1e-5;  // of costs: rounding of the tensors
    if (!metric->anisotropic()) return metric;
    std::vector<float> weights(band.size());
    std::atomic<bool> isotropic = true;
    parallelFor(band.size(), 4096, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end && isotropic.load(std::memory_order_relaxed); ++i) {
            const PlaneMetric plane = metric->inPlane(TangentFrame(band.normal[i]), NodeIndex(i));
            weights[i] = float(plane.weight);
            if (plane.largest() > (1 + kSame) * plane.least()) isotropic = false;
        }
    });
    if (!isotropic) return metric;
    const auto plain = std::make_shared<Metric>(*metric);
    plain->tensor.clear();
    const auto [least, most] = std::minmax_element(weights.begin(), weights.end());
    const double lowest = double(*least);
    if (double(*most) > (1 + kEqual) * lowest)
        plain->weight = std::move(weights);
    else if (std::abs(lowest - 1) > kEqual)
        plain->weight.assign(band.size(), *least);
    return plain;
}

/// How far a point goes from `from` along `step` before an obstacle, as a part of the step, to a
/// thousandth.
float freePart(const Metric& metric, const Vec3d& from, const Vec3f& step, const Vec3d& normal) {
    float free = 0, blocked = 1;
    for (int round = 0; round < 10; ++round) {
        const float t = (free + blocked) / 2;
        const Vec3d p = from + Vec3d(t * step);
        (metric.blocked(p, p, normal) ? blocked : free) = t;
    }
    return free;
}

/// A node inside an obstacle, or just outside of it, that moves onto its rim.
struct RimNode {
    std::size_t node;
    Vec3f inside, out;  ///< its foot point, and the direction to the rim along a link, unit
    float rim, length;  ///< how far the rim is, and the node outside
    float off;          ///< of the moved foot point beyond the rim

    Vec3f foot() const { return inside + (rim + off) * out; }
};

/// The point of the rim nearest to a node inside an obstacle, on its links to nodes outside.
std::optional<RimNode> nearestRim(const JetCore& core, std::size_t k) {
    // So far outside that steps of 1.5 voxels along a rim with a radius of 6 voxels stay outside.
    constexpr float kOff = 0.05f;
    const JetNode& node = core.nodes[k];
    std::optional<RimNode> nearest;
    const std::uint32_t severed = core.severedSteps(node);
    core.band.forNeighbors(
        &BandLeaf::core, node.leaf, node.offset, [&](NodeIndex j, int dx, int dy, int dz) {
            const JetNode& outside = core.nodes[j];
            if (outside.obstacleState == Metric::Inside ||
                severed & SeveredLinks::bit(dx, dy, dz) ||
                dot(node.normal, outside.normal) < Band::kOtherSheet)
                return;
            const Vec3f step = node.foot - outside.foot - Vec3f(Ijk{dx, dy, dz});
            const float free =
                freePart(core.metric, core.footOf(outside), step, Vec3d(node.normal));
            const float len = length(step), back = (1 - free) * len;
            if (back + kOff > len || (nearest && back >= nearest->rim)) return;
            nearest = {k, node.foot, (-1 / len) * step, back, len, kOff};
        });
    return nearest;
}

/// The point of the rim nearest to a node outside an obstacle, on its links to nodes inside, if it
/// is nearer than nodes are that move onto the rim: steps along it would be blocked.
std::optional<RimNode> closeRim(const JetCore& core, std::size_t k) {
    constexpr float kNear = 0.05f;  // voxels; it moves as far off
    const JetNode& node = core.nodes[k];
    std::optional<RimNode> nearest;
    float least = kNear;
    const std::uint32_t severed = core.severedSteps(node);
    core.band.forNeighbors(
        &BandLeaf::core, node.leaf, node.offset, [&](NodeIndex j, int dx, int dy, int dz) {
            const JetNode& inside = core.nodes[j];
            if (inside.obstacleState != Metric::Inside || severed & SeveredLinks::bit(dx, dy, dz) ||
                dot(node.normal, inside.normal) < Band::kOtherSheet)
                return;
            const Vec3f step = inside.foot + Vec3f(Ijk{dx, dy, dz}) - node.foot;
            const float len = length(step), ahead = freePart(core.metric, core.footOf(node), step,
                                                             Vec3d(inside.normal)) *
                                                    len;
            if (ahead >= least) return;
            least = ahead;
            nearest = {k, node.foot + (ahead / len) * step, (-1 / len) * step, 0, len, kNear};
        });
    if (!nearest) return {};
    // Between two obstacles it stays.
    const Vec3d moved = core.footOf(node) + Vec3d(nearest->foot() - node.foot);
    return core.metric.blocked(moved, moved, Vec3d(node.normal)) ? std::nullopt : nearest;
}

/// Whether the obstacle blocks the step from a node of the rim to a neighbor on the same side of
/// it: a small ball bends more between them than their distance from it allows.
/// @param numbers  per core node: its place in `rim`, or kNoRim
bool isStepBlocked(const JetCore& core, const std::vector<RimNode>& rim,
                   const std::vector<std::uint32_t>& numbers, const RimNode& here) {
    constexpr float kSameSide = 0.5f;  // of the directions outward: not through a thin wall
    const JetNode& node = core.nodes[here.node];
    const std::uint32_t severed = core.severedSteps(node);
    bool blocked = false;
    core.band.forNeighbors(
        &BandLeaf::core, node.leaf, node.offset, [&](NodeIndex j, int dx, int dy, int dz) {
            if (blocked || numbers[j] == kNoRim || severed & SeveredLinks::bit(dx, dy, dz) ||
                dot(rim[numbers[j]].out, here.out) < kSameSide)
                return;
            const JetNode& other = core.nodes[j];
            blocked = core.metric.blocked(core.footOf(node), core.footOf(other),
                                          Vec3d(normalized(node.normal + other.normal)));
        });
    return blocked;
}

/// Moves nodes of the rim outward, by up to 0.16 voxels, until steps between them go around it.
void clearSteps(JetCore& core, std::vector<RimNode>& rim) {
    constexpr int kRounds = 8;
    constexpr float kMore = 0.02f;
    std::vector<std::uint32_t> numbers(core.nodes.size(), kNoRim), check(rim.size());
    for (std::size_t r = 0; r < rim.size(); ++r) numbers[rim[r].node] = check[r] = std::uint32_t(r);
    for (int round = 0; round < kRounds && !check.empty(); ++round) {
        std::vector<std::uint8_t> blocked(check.size());
        parallelFor(check.size(), 64, [&](std::size_t begin, std::size_t end) {
            for (std::size_t k = begin; k < end; ++k)
                blocked[k] = isStepBlocked(core, rim, numbers, rim[check[k]]);
        });
        std::size_t left = 0;
        for (std::size_t k = 0; k < check.size(); ++k) {
            RimNode& node = rim[check[k]];
            if (!blocked[k] || node.rim + node.off + kMore > node.length) continue;
            node.off += kMore;
            core.nodes[node.node].foot = node.foot();
            check[left++] = check[k];
        }
        check.resize(left);
    }
}

/// Moves nodes inside an obstacle, but next to one outside, and those just outside onto its rim, so
/// that fronts go along the rim and not along the voxels outside of it.
void placeRimNodes(JetCore& core) {
    std::vector<RimNode> rim;
    for (std::size_t k = 0; k < core.nodes.size(); ++k) {
        const auto state = core.nodes[k].obstacleState;
        if (state == Metric::Clear) continue;
        if (const auto found = state == Metric::Inside ? nearestRim(core, k) : closeRim(core, k))
            rim.push_back(*found);
    }
    for (const RimNode& moved : rim) {
        JetNode& node = core.nodes[moved.node];
        node.foot = moved.foot(), node.obstacleState = Metric::Beside;
    }
    if (!rim.empty()) clearSteps(core, rim);
}

}  // namespace

std::unique_ptr<JetCore> buildJetCore(const Band& band, MetricPtr metric) {
    if (!metric) metric = std::make_shared<Metric>();
    metric->check(band);
    if (band.coreSize() > JetLink::kMostNodes)
        throw Error(Error::Kind::InvalidArgument, "jet marches up to 2^31 nodes of the core",
                    "take larger voxels");
    auto core = std::make_unique<JetCore>(band, asWeights(band, std::move(metric)));
    const CostRange costs = fillNodes(*core);
    core->leastCost = costs.least;
    core->largestRatio = costs.ratio;
    refuseLargeRatio(band, costs);
    if (core->metric.obstacles) placeRimNodes(*core);
    core->stenciled = costs.ratio > kLinksRatio;
    core->costsVary = costs.most > costs.least;
    if (core->stenciled) buildLinks(*core, buildStencil(*core));
    return core;
}

}  // namespace igeo
