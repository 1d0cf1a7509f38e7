#include <igeo/march/detail/jet_core.h>

#include <igeo/base/error.h>
#include <igeo/base/parallel.h>

#include <algorithm>

namespace igeo {

Jet Surroundings::update(std::uint32_t& from) const {
    if (all.count() == 0) return {};
    from = label[0];
    if (oneLabel) return jetUpdate(all);
    Jet best;
    std::uint32_t next = *std::min_element(label.begin(), label.begin() + all.count());
    while (next != kNoBucket) {
        const std::uint32_t current = next;
        next = kNoBucket;
        JetNeighbors part;
        part.smooth = all.smooth;
        part.rim = all.rim;
        part.pull = all.pull;
        part.far2 = all.far2;
        for (int k = 0; k < all.count(); ++k) {
            const std::uint32_t l = label[std::size_t(k)];
            if (l == current) part.add({all.a(k), all.g(k), all.base() + double(all.u(k))});
            if (l > current) next = std::min(next, l);
        }
        const Jet jet = jetUpdate(part);
        if (jet.u < best.u) best = jet, from = current;
    }
    return best;
}

JetCore::JetCore(const Band& aBand, const Metric& aMetric, const std::vector<SurfacePoint>& aSeeds,
                 double aStartRadius)
    : band(aBand),
      metric(aMetric),
      startRadius(aStartRadius),
      seeds(aSeeds),
      source(sourcesOf(aSeeds)),
      nodes(band.coreSize()) {
    if (metric.anisotropic()) stretch.resize(nodes.size());
    float largestRatio = 1;  // of the costs along the two axes in a tangent plane
    NodeIndex worst = kNoNode;
    struct Extremes {
        double least = kInfinity, most = 0;  ///< of the least cost at a node, over the leaf
        float ratio = 1;
        NodeIndex worst = kNoNode;
    };
    std::vector<Extremes> extremes(band.leaves.size());
    parallelFor(band.leaves.size(), 64, [&](std::size_t begin, std::size_t end) {
        for (std::size_t l = begin; l < end; ++l) {
            const BandLeaf& leaf = band.leaves[l];
            NodeIndex k = leaf.core.first;
            for (NodeIndex i = leaf.band.first; i < leaf.band.first + leaf.band.count; ++i) {
                const std::uint16_t o = band.offset[i];
                if (!(leaf.core.mask[o >> 6] >> (o & 63) & 1)) continue;
                Extremes& e = extremes[l];
                float weight;
                double cost;
                if (stretch.empty()) {
                    cost = metric.at(i);
                    weight = float(cost);
                } else {
                    const PlaneMetric plane = metric.inPlane(TangentFrame(band.normal[i]), i);
                    weight = float(plane.weight);
                    cost = plane.least();
                    stretch[k] = plane.stretch;
                    const float s = plane.stretch.largest();
                    if (s * s > e.ratio) e.ratio = s * s, e.worst = i;
                }
                e.least = std::min(e.least, cost), e.most = std::max(e.most, cost);
                nodes[k++] = {kInfinity,
                              {},
                              band.foot[i],
                              band.normal[i],
                              LeafIndex(l),
                              kNoBucket,
                              o,
                              metric.sight.empty() ? Metric::Clear : metric.sight[i],
                              weight};
            }
        }
    });
    leastCost = stretch.empty() ? metric.least() : kInfinity;
    double most = 0;
    for (const Extremes& e : extremes) {
        leastCost = std::min(leastCost, e.least);
        most = std::max(most, e.most);
        if (e.ratio > largestRatio) largestRatio = e.ratio, worst = e.worst;
    }
    varied = most > leastCost;
    constexpr float kRounding = 1.001f;
    if (largestRatio > kRounding * kLargestRatio)
        throw Error(Error::Kind::InvalidArgument,
                    "the metric at " + worldPlace(band, worst) + " costs " +
                        shortText(double(largestRatio)) +
                        " times as much in one direction along the surface as in another; jet "
                        "takes up to " +
                        shortText(double(kLargestRatio)),
                    "bring the eigenvalues of the tensors closer together");
    if (metric.obstacles) placeRimNodes();
    if (largestRatio > kLinksRatio) buildStencils();
    if (!source.empty() && source.back() > 0) label.assign(nodes.size(), 0);
    // Tensors stretch start discs by as much.
    seedsNear = SeedsNear(seeds, startRadius * double(largestRatio));
    for (SurfacePoint& s : seeds) {
        const PsiSample psi = samplePsi(band, s.pIndex + 0.5 * s.piece);
        // Where two faces share a cell their gradients cancel.
        const bool clear = psi.valid && length(psi.gradient) > 0.5;
        seedNormal.push_back(clear ? Vec3f(normalized(psi.gradient)) : band.normal[s.node]);
        if (!stretch.empty())
            seedPlane.push_back(metric.inPlane(TangentFrame(band.normal[s.node]), s.node));
        s.weight = stretch.empty() ? metric.at(s.node) : seedPlane.back().weight;
        first = std::min(first, s.start);
    }
}

void JetCore::placeRimNodes() {
    // So far outside that steps of 1.5 voxels along a rim with a radius of 6 voxels stay outside.
    constexpr float kOff = 0.05f;
    std::vector<std::pair<NodeIndex, Vec3f>> rim;
    for (std::size_t k = 0; k < nodes.size(); ++k) {
        const auto i = NodeIndex(k);
        const Node& node = nodes[i];
        if (node.sight != Metric::Inside) continue;
        const Vec3d normal(node.normal);
        float nearest = float(kInfinity);
        Vec3f place;
        band.forNeighbors(&BandLeaf::core, node.leaf, node.offset,
                          [&](NodeIndex j, int dx, int dy, int dz) {
                              const Node& outside = nodes[j];
                              if (outside.sight == Metric::Inside ||
                                  igeo::dot(node.normal, outside.normal) < Band::kOtherSheet)
                                  return;
                              const Vec3f step = node.foot - outside.foot - Vec3f(Ijk{dx, dy, dz});
                              const Vec3d from = footOf(outside);
                              // To a thousandth of a voxel.
                              float free = 0, blocked = 1;
                              for (int round = 0; round < 10; ++round) {
                                  const float t = (free + blocked) / 2;
                                  const Vec3d p = from + Vec3d(t * step);
                                  (metric.blocked(p, p, normal) ? blocked : free) = t;
                              }
                              const float len = igeo::length(step), back = (1 - free) * len + kOff;
                              if (back > len || back >= nearest) return;
                              nearest = back;
                              place = node.foot - (back / len) * step;
                          });
        if (nearest < float(kInfinity)) rim.emplace_back(i, place);
    }
    for (const auto& [i, place] : rim) nodes[i].foot = place, nodes[i].sight = Metric::Beside;
}

Place JetCore::placeInBand(NodeIndex i) const {
    const TangentFrame frame(band.normal[i], band.faceted);
    if (stretch.empty()) return {frame, metric.at(i), {}};
    const PlaneMetric plane = metric.inPlane(frame, i);
    return {frame, plane.weight, plane.stretch};
}

double JetCore::seedCost(std::uint32_t k, const Vec3f& chord) const {
    const Vec2f way = TangentFrame(band.normal[seeds[k].node]).flat(chord);
    const float l = length(way);
    return l > 0 ? seedPlane[k].cost((igeo::length(chord) / l) * way) : 0;
}

bool JetCore::discJet(std::uint32_t k, const Place& place, const Vec3d& foot, Solved& s) const {
    const SurfacePoint& seed = seeds[k];
    const TangentFrame& frame = place.frame;
    const Vec3f chord(foot - seed.nearestTo(foot)), &normal = frame.normal();
    const float cosine = igeo::dot(normal, seedNormal[k]), c = igeo::length(chord);
    // With tensors as far in cost as such a chord where it is dearest: along the cheap axis the
    // lattice is coarse beside the bends of the front, further out than elsewhere.
    const double there = stretch.empty() ? 0 : seedCost(k, chord);
    if (c > float(startRadius) && (stretch.empty() || there > startRadius * seedPlane[k].largest()))
        return false;
    // Across a crease chords say nothing, and the march begins next to the seed; but a seed on the
    // crease itself lies in the planes of all its faces.
    constexpr float kSmooth = 0.8f, kInPlane = 0.05f;
    if (cosine < kSmooth && std::abs(igeo::dot(normal, chord)) >= kInPlane * c) return false;
    const Vec2f way =
        cosine < kSmooth ? frame.flat(chord) : frame.way(chord, seedNormal[k], cosine);
    const float u = length(way);
    if (stretch.empty()) {
        s = {seed.start + (seed.weight + place.weight) / 2 * double(u), {}, source[k], false};
        if (u > 1e-6f) s.g = frame.lift((1 / u) * way);
        return true;
    }
    // The way at the price of both ends, each in its own plane.
    const Vec2f here = place.stretch.way(way);
    const double arc = c > 0 ? double(u / c) : 1;
    s = {
        seed.start + (place.weight * double(length(here)) + arc * there) / 2, {}, source[k], false};
    if (u > 1e-6f) s.g = frame.lift(place.stretch.covectorBack((1 / length(here)) * here));
    return true;
}

}  // namespace igeo
