#include <igeo/march/field.h>

#include <igeo/band/tangent_frame.h>
#include <igeo/base/parallel.h>
#include <igeo/march/detail/jet_blend.h>

namespace igeo {

void Field::summarize() {
    constexpr std::size_t kChunk = 1 << 16;
    struct Part {
        std::size_t reached = 0;
        double largest = 0;
    };
    std::vector<Part> parts((distance.size() + kChunk - 1) / kChunk);
    parallelFor(parts.size(), 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t c = begin; c < end; ++c)
            for (std::size_t k = c * kChunk; k < std::min(distance.size(), (c + 1) * kChunk); ++k)
                if (distance[k] < kInfinity) {
                    ++parts[c].reached;
                    parts[c].largest = std::max(parts[c].largest, distance[k]);
                }
    });
    source = sourcesOf(seeds);
    seedsNear = SeedsNear(seeds, startRadius);
    if (!seeds.empty())
        leastStart = std::min_element(seeds.begin(), seeds.end(), [](auto& a, auto& b) {
                         return a.start < b.start;
                     })->start;
    reached = 0;
    maxDistance = 0;
    for (const Part& part : parts) {
        reached += part.reached;
        maxDistance = std::max(maxDistance, part.largest);
    }
}

namespace {

/// Difference along one axis over reached neighbors that no obstacle hides; 0 where there is none.
double axisDifference(const Field& field, NodeIndex i, int axis) {
    const Band& band = *field.band;
    const std::vector<double>& d = field.distance;
    const NodeIndex lo = band.neighbor(i, Band::faceStep(2 * axis));
    const NodeIndex hi = band.neighbor(i, Band::faceStep(2 * axis + 1));
    auto counts = [&](NodeIndex j) {
        return j != kNoNode && d[j] < kInfinity && !band.severed(i, j) &&
               !field.metric->blocked(band, i, j);
    };
    const bool hasLo = counts(lo), hasHi = counts(hi);
    if (hasLo && hasHi) {
        // A front meets itself between two neighbors that both lie below d[i]: there the central
        // difference cancels, and d falls to both sides.
        if (d[lo] < d[i] && d[hi] < d[i]) return d[lo] <= d[hi] ? d[i] - d[lo] : d[hi] - d[i];
        return (d[hi] - d[lo]) / 2;
    }
    if (hasLo) return d[i] - d[lo];
    if (hasHi) return d[hi] - d[i];
    return 0;
}

}  // namespace

std::vector<Vec3f> surfaceGradient(const Field& field) {
    const Band& band = *field.band;
    std::vector<Vec3f> gradient(band.size());
    parallelFor(band.size(), 4096, [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) {
            const auto i = NodeIndex(k);
            if (!(field.distance[i] < kInfinity)) continue;
            const Vec3d g{axisDifference(field, i, 0), axisDifference(field, i, 1),
                          axisDifference(field, i, 2)};
            gradient[i] = Vec3f(tangential(g, Vec3d(band.normal[i])));
        }
    });
    return gradient;
}

double costToSeed(const Field& field, const SurfacePoint& seed, const Vec3d& pIndex,
                  const Vec3d& normal) {
    const Vec3d chord = seed.nearestTo(pIndex) - pIndex;
    const double r = length(chord);
    if (!field.metric->anisotropic()) return seed.weight * r;
    return r * field.metric->stepCost(seed.node, normalized(tangential(chord, normal)));
}

const SurfacePoint* seedAround(const Field& field, const Vec3d& pIndex, const Vec3d& normal,
                               double d) {
    const SurfacePoint* nearest = nullptr;
    double least = field.startRadius;
    field.seedsNear.forNear(pIndex, [&](std::size_t k) {
        const SurfacePoint& s = field.seeds[k];
        const Vec3d at = s.nearestTo(pIndex);
        const double r = length(pIndex - at);
        // The distance tells a seed on this sheet from one on a sheet close by.
        const double cost = field.metric->anisotropic() && r > 0
                                ? costToSeed(field, s, pIndex, normal) / r
                                : s.weight;
        if (r < least && d - s.start < 1.5 * field.startRadius * cost &&
            !field.metric->blocked(pIndex, at, normal))
            least = r, nearest = &s;
    });
    return nearest;
}

SurfaceCell::SurfaceCell(const Band& band, const Metric& metric, const Vec3d& pIndex,
                         const Vec3d& sheetNormal)
    : BandCell(cellAt(band, pIndex)), normal(dropFacingCorners(band, *this, sheetNormal)) {
    metric.dropHiddenCorners(band, pIndex, normal, *this);
}

double segmentCost(const Band& band, const Metric& metric, const Vec3d& a, const Vec3d& b,
                   const Vec3d& sheetNormal) {
    if (!metric.weighted()) return length(b - a);
    return (metric.stepCost(SurfaceCell(band, metric, a, sheetNormal), b - a) +
            metric.stepCost(SurfaceCell(band, metric, b, sheetNormal), b - a)) /
           2;
}

namespace {

/// Trilinear over the reached corners: values belong to the voxels.
double sampleVoxels(const BandCell& cell, const Field& field) {
    double sum = 0, weight = 0, nearest = kInfinity;
    for (std::size_t k = 0; k < 8; ++k) {
        if (cell.node[k] == kNoNode) continue;
        const double d = field.distance[cell.node[k]];
        if (!(d < kInfinity)) continue;
        nearest = std::min(nearest, d);
        sum += cell.weight[k] * d;
        weight += cell.weight[k];
    }
    return weight > 0 ? sum / weight : nearest;
}

double sampleJets(const SurfaceCell& cell, const Field& field, const Vec3d& p) {
    const Band& band = *field.band;
    const Metric& metric = *field.metric;
    const TangentFrame frame(Vec3f(cell.normal), band.faceted);
    PlaneMetric plane;
    if (metric.anisotropic())
        plane = metric.inPlane(frame, cell);
    else
        plane.weight = metric.at(cell);
    const double here = plane.weight;
    JetNeighbors all;
    BlendWeights weight{};
    for (std::size_t k = 0; k < 8; ++k) {
        const NodeIndex j = cell.node[k];
        if (j == kNoNode || !(field.distance[j] < kInfinity)) continue;
        const Vec3f nj = band.normal[j];
        const float cosine = dot(frame.normal(), nj);
        // A corner at p itself must not leave the sum empty.
        weight[std::size_t(all.count())] = float(cell.weight[k]) + 1e-6f;
        Vec3f chord(p - band.footPoint(j)), g = field.gradient[j];
        if (metric.anisotropic()) {
            g *= float(1 / here);
        } else if (metric.weighted()) {
            chord *= float((1 + metric.at(j) / here) / 2);
            g = normalized(g);
        }
        const JetNeighbor n = flattened(frame, chord, nj, cosine, g, field.distance[j] / here);
        all.add(metric.anisotropic() ? stretched(plane.stretch, n) : n);
    }
    return here * blendJets(all, weight).u;
}

}  // namespace

double sampleDistance(const Field& field, const Vec3d& pIndex, const Vec3d& sheetNormal) {
    const SurfaceCell cell(*field.band, *field.metric, pIndex, sheetNormal);
    // Beside a seed in a groove jets are carried on past it.
    const double d = std::max(field.leastStart, field.atFootPoints ? sampleJets(cell, field, pIndex)
                                                                   : sampleVoxels(cell, field));
    const SurfacePoint* const s = seedAround(field, pIndex, cell.normal, d);
    if (!s) return d;
    const double straight = s->start + costToSeed(field, *s, pIndex, cell.normal);
    return s->rim ? std::min(d, straight) : straight;
}

}  // namespace igeo
