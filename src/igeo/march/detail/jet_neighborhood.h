/// The solve of scheme `jet` at a foot point: neighbors from S into its chart, jetUpdate there, and
/// the jet back on S.
#pragma once

#include <igeo/march/detail/jet_core.h>
#include <igeo/march/detail/jet_neighbors.h>

#include <array>

namespace igeo {

/// Nodes around a foot point that have a jet, in its chart, with the sources of their fronts.
struct Neighborhood {
    JetNeighbors all;
    std::array<std::uint32_t, JetNeighbors::kMax> label;
    bool oneLabel = true;

    void add(const JetNeighbor& n, std::uint32_t source) {
        const auto k = std::size_t(all.count());
        label[k] = source;
        oneLabel &= source == label[0];
        all.add(n);
    }
    bool full() const { return all.count() == JetNeighbors::kMax; }
};

/// jetUpdate, per source: fronts of different sources are never fitted together, the lesser value
/// counts, and the earlier source where they are equal.
/// @param source  of the front that counts
Jet updatePerSource(const Neighborhood& around, std::uint32_t& source);

/// Adds an accepted node to a neighborhood.
/// @param chord, cosine  from its foot point to that of `local`; between their normals
inline void addNeighbor(const JetCore& core, NodeIndex j, const Vec3f& chord, float cosine,
                        const LocalFrame& local, Neighborhood& around) {
    const JetNode& other = core.nodes[j];
    if (cosine < 0.9f) around.all.smooth = false;
    const auto here = float(local.weight);
    // Relative to the least start: near a source the solve takes u for the distance to it.
    const double u = (other.u - core.seeds.leastStart) / local.weight;
    around.add(core.stretch.empty()
                   ? flattened(local.frame, meanWeight(other.weight, here) * chord, other.normal,
                               cosine, other.g, u)
                   : stretched(local.stretch, flattened(local.frame, chord, other.normal, cosine,
                                                        (other.weight / here) * other.g, u)),
               core.labelOf(j));
}

/// Square of the cost of a chord from a foot point to one nearby.
/// @param chord  times the weight there
inline double squaredCost(const JetCore& core, const LocalFrame& from, const Vec3f& chord) {
    const float c2 = dot(chord, chord);
    if (core.stretch.empty()) return c2;
    const Vec2f flat = from.frame.flat(chord), v = from.stretch.vector(flat);
    return c2 * dot(v, v) / std::max(dot(flat, flat), 1e-12f);
}

/// A jet of the chart, back on S.
inline Solved fromChart(const JetCore& core, const LocalFrame& local, const Jet& jet,
                        std::uint32_t source) {
    return {core.seeds.leastStart + local.weight * jet.u,
            local.frame.lift(core.stretch.empty() ? jet.g : local.stretch.covectorBack(jet.g)),
            source, jet.usedFallback};
}

/// The jet at a foot point from its neighborhood; +inf without neighbors.
inline Solved solveJet(const JetCore& core, const LocalFrame& local, Neighborhood& around) {
    if (!core.stretch.empty()) {
        // In the chart the lattice is stretched, and segments between neighbors with it.
        const float l = local.stretch.largest();
        around.all.far2 *= l * l;
    }
    // Neighbors far to the left and right say little about g, and fits would swing.
    if (!core.stencil.empty()) around.all.pull = 0.1f;
    std::uint32_t source = 0;
    const Jet jet = updatePerSource(around, source);
    return fromChart(core, local, jet, source);
}

}  // namespace igeo
