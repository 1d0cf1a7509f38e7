#include <igeo/march/detail/jet_core.h>

#include <igeo/base/error.h>
#include <igeo/base/parallel.h>

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>

namespace igeo {

namespace {

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
