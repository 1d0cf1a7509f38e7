#include <igeo/march/jet.h>

#include <igeo/base/error.h>
#include <igeo/march/detail/jet_march.h>

#include <algorithm>

namespace igeo {

namespace {

std::shared_ptr<JetCore> coreOf(const Band& band, MetricPtr metric) {
    if (!(band.h >= std::sqrt(0.75)))
        throw Error(Error::Kind::InvalidArgument, "a band of " + std::to_string(band.h) +
                                                      " voxels is too narrow: jet needs sqrt(3)/2");
    return buildJetCore(band, std::move(metric));
}

void requireUsable(const Band& band, const std::vector<SurfacePoint>& seeds,
                   const JetOptions& options) {
    using Kind = Error::Kind;
    if (seeds.empty()) throw Error(Kind::InvalidArgument, "a march needs at least one seed");
    if (!(options.maxDistance > 0))
        throw Error(Kind::InvalidArgument, "the largest distance must be positive");
    if (options.below && options.below->size() != band.size())
        throw Error(Kind::InvalidArgument,
                    "JetOptions::below has " + std::to_string(options.below->size()) +
                        " values for " + std::to_string(band.size()) + " nodes");
}

Field marchOnCore(const JetCorePtr& core, const std::vector<SurfacePoint>& seeds,
                  const JetOptions& options, Progress& progress) {
    JetMarch march(core, seeds, options);
    march.march(progress);
    return march.take();
}

/// Extends the field to the band, if the options say so.
Field finished(Field field, const JetOptions& options) {
    if (options.extend)
        extendToBand(field);
    else
        field.summarize();
    return field;
}

}  // namespace

JetCorePtr jetCore(const Band& band, MetricPtr metric) {
    const std::shared_ptr<JetCore> core = coreOf(band, std::move(metric));
    if (core->links.empty()) buildLinks(*core);
    return core;
}

std::vector<NodeIndex> coreAround(const Band& band, const std::vector<SurfacePoint>& points) {
    constexpr double kReach = 3;  // voxels
    std::vector<NodeIndex> nodes;
    for (const SurfacePoint& p : points)
        for (const NodeIndex i : nodesAround(band, p, kReach))
            if (const NodeIndex core = band.coreNode(i); core != kNoNode) nodes.push_back(core);
    std::sort(nodes.begin(), nodes.end());
    nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
    return nodes;
}

Field marchJet(const JetCorePtr& core, const std::vector<SurfacePoint>& seeds,
               const JetOptions& options, Progress& progress) {
    requireUsable(core->band, seeds, options);
    return finished(marchOnCore(core, seeds, options, progress), options);
}

Field marchJet(const Band& band, MetricPtr metric, const std::vector<SurfacePoint>& seeds,
               const JetOptions& options, Progress& progress) {
    requireUsable(band, seeds, options);
    const std::shared_ptr<JetCore> core = coreOf(band, std::move(metric));
    Field field = marchOnCore(core, seeds, options, progress);
    core->links = {};
    return finished(std::move(field), options);
}

}  // namespace igeo
