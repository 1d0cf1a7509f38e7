#include <igeo/field.h>

#include <igeo/parallel.h>
#include <igeo/tangent_frame.h>

namespace igeo {

void Field::summarise() {
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
    reached = 0;
    maxDistance = 0;
    for (const Part& part : parts) {
        reached += part.reached;
        maxDistance = std::max(maxDistance, part.largest);
    }
}

namespace {

/// Difference along one axis over reached neighbours; 0 where neither side is reached.
double axisDifference(const Band& band, const std::vector<double>& d, NodeIndex i, int axis) {
    Ijk step{};
    step[axis] = 1;
    const NodeIndex lo = band.neighbour(i, -step.x, -step.y, -step.z);
    const NodeIndex hi = band.neighbour(i, step.x, step.y, step.z);
    const bool hasLo = lo != kNoNode && d[lo] < kInfinity;
    const bool hasHi = hi != kNoNode && d[hi] < kInfinity;
    if (hasLo && hasHi) {
        // A front meets itself between two neighbours that both lie below d[i]: there the central
        // difference cancels, and either side is a way down.
        if (d[lo] < d[i] && d[hi] < d[i]) return d[lo] <= d[hi] ? d[i] - d[lo] : d[hi] - d[i];
        return (d[hi] - d[lo]) / 2;
    }
    if (hasLo) return d[i] - d[lo];
    if (hasHi) return d[hi] - d[i];
    return 0;
}

}  // namespace

std::vector<Vec3f> surfaceGradient(const Band& band, const Field& field) {
    if (!field.gradient.empty()) return field.gradient;
    std::vector<Vec3f> gradient(band.size());
    parallelFor(band.size(), 4096, [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) {
            const auto i = NodeIndex(k);
            if (!(field.distance[i] < kInfinity)) continue;
            const Vec3d g{axisDifference(band, field.distance, i, 0),
                          axisDifference(band, field.distance, i, 1),
                          axisDifference(band, field.distance, i, 2)};
            gradient[i] = Vec3f(tangential(g, Vec3d(band.normal[i])));
        }
    });
    return gradient;
}

const SurfacePoint* seedAround(const Field& field, const Vec3d& pIndex, double d) {
    const SurfacePoint* nearest = nullptr;
    double least = field.startRadius;
    for (const SurfacePoint& s : field.seeds) {
        const double r = length(pIndex - s.pIndex);
        // The distance tells a seed on this sheet from one on a sheet close by.
        if (r < least && d - s.start < 1.5 * field.startRadius * s.weight) least = r, nearest = &s;
    }
    return nearest;
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

/// The weight in a cell, from its corners: gradients are as long as the weight.
double weightIn(const BandCell& cell, const Field& field) {
    if (!field.weighted) return 1;
    double sum = 0, total = 0;
    for (std::size_t k = 0; k < 8; ++k) {
        const NodeIndex j = cell.node[k];
        if (j == kNoNode || !(field.distance[j] < kInfinity)) continue;
        sum += (cell.weight[k] + 1e-6) * double(length(field.gradient[j]));
        total += cell.weight[k] + 1e-6;
    }
    return sum > 0 ? sum / total : 1;
}

double sampleJets(const Band& band, const BandCell& cell, const Field& field, const Vec3d& p,
                  const Vec3d& normal) {
    const double here = weightIn(cell, field);
    const TangentFrame frame{Vec3f(normal)};
    JetNeighbours all;
    std::array<float, JetNeighbours::kMax> weight{};
    for (std::size_t k = 0; k < 8; ++k) {
        const NodeIndex j = cell.node[k];
        if (j == kNoNode || !(field.distance[j] < kInfinity)) continue;
        const Vec3f nj = band.normal[j];
        const float cosine = dot(frame.normal(), nj);
        // A corner at p itself must not leave the sum empty.
        weight[std::size_t(all.count())] = float(cell.weight[k]) + 1e-6f;
        Vec3f chord(p - band.footPoint(j)), g = field.gradient[j];
        if (field.weighted) {
            const float there = length(g);
            chord *= float((1 + double(there) / here) / 2);
            g = normalized(g);
        }
        all.add(frame.neighbour(chord, nj, cosine, g, field.distance[j] / here));
    }
    return here * blendJets(all, weight).u;
}

}  // namespace

double sampleDistance(const Band& band, const Field& field, const Vec3d& pIndex,
                      const Vec3d& side) {
    BandCell cell = cellAt(band, pIndex);
    const Vec3d normal = dropFacingCorners(band, cell, side);
    const double d = field.atFootPoints ? sampleJets(band, cell, field, pIndex, normal)
                                        : sampleVoxels(cell, field);
    if (const SurfacePoint* s = seedAround(field, pIndex, d))
        return s->start + s->weight * length(pIndex - s->pIndex);
    return d;
}

}  // namespace igeo
