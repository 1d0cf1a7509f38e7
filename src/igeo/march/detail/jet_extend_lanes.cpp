#include <igeo/march/detail/jet_extend_lanes.h>

// Loops over all lanes, which compilers turn into vector instructions.
namespace igeo::jet {

namespace {

IGEO_INLINE void findCellsHere(FootLanes& feet, bool fromPsi, CellPoints& points) {
    constexpr std::uint32_t kEdge = LeafNumbers<2>::kEdge, kMargin = 2, kLast = kEdge - 2;
    auto place = [](float foot, std::int32_t low) { return foot - float(low); };
    if (fromPsi)
        for (std::size_t k = 0; k < Lanes::kNodes; ++k) {
            feet.x[k] = -feet.psi[k] * points.nx[k];
            feet.y[k] = -feet.psi[k] * points.ny[k];
            feet.z[k] = -feet.psi[k] * points.nz[k];
        }
    for (std::size_t k = 0; k < Lanes::kNodes; ++k) {
        const Ijk low{floorToInt(feet.x[k]), floorToInt(feet.y[k]), floorToInt(feet.z[k])};
        points.x[k] = place(feet.x[k], low.x);
        points.y[k] = place(feet.y[k], low.y);
        points.z[k] = place(feet.z[k], low.z);
        const Ijk step = stepOf(feet.offset[k]);
        auto inBlock = [](std::int32_t voxel, std::int32_t lower) {
            return std::uint32_t(voxel) + std::uint32_t(lower) + kMargin;
        };
        const std::uint32_t x = inBlock(step.x, low.x), y = inBlock(step.y, low.y),
                            z = inBlock(step.z, low.z);
        const bool outside = (x > kLast) | (y > kLast) | (z > kLast);
        feet.cell[k] = std::int32_t((x * kEdge + y) * kEdge + z) | -std::int32_t(outside);
    }
}

/// As JetBuckets::startOf has it.
IGEO_INLINE double startOf(const CoreJets& jets, std::uint32_t bucket) {
    return jets.buckets.leastStart + (double(std::int32_t(bucket)) - 1.0) * jets.buckets.width;
}

IGEO_INLINE void raiseToBound(const CoreJets& jets, FootLanes& feet) {
    const StraightLines::Line line = jets.seeds.lines.only();
    const double cost = jets.seeds.lines.leastCost();
    for (std::size_t k = 0; k < Lanes::kNodes; ++k) {
        const Ijk step = stepOf(feet.offset[k]);
        const Vec3d off{double(feet.originX[k] + step.x) + double(feet.x[k]) - line.from.x,
                        double(feet.originY[k] + step.y) + double(feet.y[k]) - line.from.y,
                        double(feet.originZ[k] + step.z) + double(feet.z[k]) - line.from.z};
        const double bound = line.start + cost * length(off);
        feet.value[k] = feet.value[k] < bound ? bound : feet.value[k];
    }
}

IGEO_INLINE void findValuesHere(const CoreJets& jets, const JetCorners& corners,
                                const CarriedJets& carried, const Lanes& weight, FootLanes& feet) {
    const double largestInDisc = jets.seeds.largestInDisc;
    for (std::size_t k = 0; k < Lanes::kNodes; ++k) {
        const double value = startOf(jets, corners.bucket[k]) + double(weight[k] * carried.u[k]);
        const bool beyondDisc = value > largestInDisc + kDiscMargin * double(weight[k]);
        feet.plain[k] = corners.smooth[k] & -(carried.spreads[k] & std::int32_t(beyondDisc) &
                                              std::int32_t(corners.count[k] > 0));
        feet.value[k] = value;
    }
    raiseToBound(jets, feet);
}

IGEO_INLINE void findCoreValuesHere(const CoreJets& jets, const LiftedJet* lifted, NodeIndex first,
                                    FootLanes& feet) {
    const auto last = NodeIndex(jets.state.size() - 1);
    alignas(32) FootLanes::PerLane<std::uint32_t> bucket;
    Lanes rest;
    for (std::size_t k = 0; k < Lanes::kNodes; ++k) {
        const NodeIndex i = std::min(first + NodeIndex(k), last);
        feet.setFoot(k, jets.core->nodes[i].foot);
        bucket[k] = jets.state[i].bucket, rest[k] = lifted[i].rest;
    }
    for (std::size_t k = 0; k < Lanes::kNodes; ++k)
        feet.value[k] = startOf(jets, bucket[k]) + double(rest[k]);
    raiseToBound(jets, feet);
}

/// Lays the nodes of a box out in the chart of a foot point.
template <int Width>
class BoxLayout {
    using V = typename Registers<Width>::Vector;
    using Integers = typename Registers<Width>::Integers;
    using Vectors = VectorLanes<Width>;

public:
    IGEO_INLINE BoxLayout(const JetNode* nodes, const LiftedJet* lifted, const Vec3f& foot,
                          const Ijk& middle, const LocalFrame& local, BoxLanes& box)
        : nodes_(nodes),
          lifted_(lifted),
          foot_(same(foot)),
          middle_(same(Vec3f(middle))),
          n_(same(local.frame.normal())),
          t1_(same(local.frame.axis(0))),
          t2_(same(local.frame.axis(1))),
          weight_(float(local.weight)),
          box_(box) {}

    IGEO_INLINE void layOut() const {
        // What lies beyond the last one is laid out as well.
        for (std::size_t k = box_.count; k % Width; ++k) box_.node[k] = 0, box_.step[k] = 0;
        box_.onSheet = {};
        for (std::size_t k = 0; k < box_.count; k += Width)
            box_.onSheet[k / 64] |= std::uint64_t(bitsOf<Width>(layOut(k))) << k % 64;
        if (const std::size_t last = box_.count / 64; last < box_.onSheet.size())
            box_.onSheet[last] &= (std::uint64_t(1) << box_.count % 64) - 1;
    }

private:
    /// @return flags: BoxLanes::onSheet
    IGEO_INLINE Integers layOut(std::size_t k) const {
        // Further off than a cell's diagonal it may be another surface.
        constexpr float kNear2 = 3;
        V footAndX[4], rest[4];
        loadFours<Width>(nodes_, sizeof(JetNode), &box_.node[k], footAndX);
        loadFours<Width>(&nodes_->normal.y, sizeof(JetNode), &box_.node[k], rest);
        const Vectors foot{footAndX[0], footAndX[1], footAndX[2]},
            normal{footAndX[3], rest[0], rest[1]};
        const Integers code = loadAs<Integers>(&box_.step[k]);
        const Vectors step = middle_ + Vectors{part(code >> 6), part(code >> 3), part(code)},
                      chord = foot_ - foot - step;
        const V cosine = dot(n_, normal), rise = dot(n_, chord), riseOther = dot(normal, chord);
        storeLanes(chord.x, &box_.x[k]), storeLanes(chord.y, &box_.y[k]);
        storeLanes(chord.z, &box_.z[k]), storeLanes(cosine, &box_.cosine[k]);
        unfold(k, chord * meanWeight(rest[2]), normal);
        if (lifted_) turn(k, normal, cosine);
        const Integers stacked = ((rise > 1) & (riseOther > 1)) | ((rise < -1) & (riseOther < -1));
        return (cosine >= Band::kOtherSheet) & (dot(chord, chord) <= kNear2) & ~stacked;
    }
    /// As TangentFrame::unfold has it over smooth parts.
    IGEO_INLINE void unfold(std::size_t k, const Vectors& chord, const Vectors& normal) const {
        const V inX = dot(chord, t1_), inY = dot(chord, t2_), in2 = inX * inX + inY * inY,
                rise = dot(n_, chord), x = rise * rise / in2, c2 = in2 + rise * rise,
                bend = rise - dot(normal, chord), kc2 = bend * bend / c2;
        V roots = 1 + x;
        takeRoots<Width>(roots);
        const V stretch = x < 0.02f ? 1 + x * (0.5f - 0.125f * x) : roots,
                longer = stretch * (1 + kc2 * (1.0f / 24 + kc2 * (3.0f / 640))),
                s = in2 > 1e-12f ? longer : V{} + 1;
        storeLanes(s * inX, &box_.ax[k]), storeLanes(s * inY, &box_.ay[k]);
    }
    /// The gradients turned along with the planes, as flattened() has it.
    IGEO_INLINE void turn(std::size_t k, const Vectors& normal, const V& cosine) const {
        V g[4];
        loadFours<Width>(lifted_, sizeof(LiftedJet), &box_.node[k], g);
        const Vectors gradient{g[0], g[1], g[2]};
        const V turn = dot(gradient, n_) / (1 + cosine);
        storeLanes(dot(gradient, t1_) - turn * dot(normal, t1_), &box_.gx[k]);
        storeLanes(dot(gradient, t2_) - turn * dot(normal, t2_), &box_.gy[k]);
    }
    IGEO_INLINE V meanWeight(const V& other) const {
        return other == weight_ ? V{} + 1 : (1 + other / weight_) / 2;
    }
    IGEO_INLINE static Vectors same(const Vec3f& v) { return {V{} + v.x, V{} + v.y, V{} + v.z}; }
    /// Of a step in bits.
    IGEO_INLINE static V part(const Integers& code) {
        return __builtin_convertvector((code & 7) - 2, V);
    }

    const JetNode* nodes_;
    const LiftedJet* lifted_;  ///< null: left out
    Vectors foot_, middle_, n_, t1_, t2_;
    float weight_;
    BoxLanes& box_;
};

void layOutByFour(const JetNode* nodes, const LiftedJet* lifted, const Vec3f& foot,
                  const Ijk& middle, const LocalFrame& local, BoxLanes& box) {
    BoxLayout<4>(nodes, lifted, foot, middle, local, box).layOut();
}
void findCellsByFour(FootLanes& feet, bool fromPsi, CellPoints& points) {
    findCellsHere(feet, fromPsi, points);
}
void findValuesByFour(const CoreJets& jets, const JetCorners& corners, const CarriedJets& carried,
                      const Lanes& weight, FootLanes& feet) {
    findValuesHere(jets, corners, carried, weight, feet);
}
void findCoreValuesByFour(const CoreJets& jets, const LiftedJet* lifted, NodeIndex first,
                          FootLanes& feet) {
    findCoreValuesHere(jets, lifted, first, feet);
}
#ifdef IGEO_AVX2
IGEO_AVX2 void findCoreValuesByEight(const CoreJets& jets, const LiftedJet* lifted, NodeIndex first,
                                     FootLanes& feet) {
    findCoreValuesHere(jets, lifted, first, feet);
}
IGEO_AVX2 void layOutByEight(const JetNode* nodes, const LiftedJet* lifted, const Vec3f& foot,
                             const Ijk& middle, const LocalFrame& local, BoxLanes& box) {
    BoxLayout<8>(nodes, lifted, foot, middle, local, box).layOut();
}
IGEO_AVX2 void findCellsByEight(FootLanes& feet, bool fromPsi, CellPoints& points) {
    findCellsHere(feet, fromPsi, points);
}
IGEO_AVX2 void findValuesByEight(const CoreJets& jets, const JetCorners& corners,
                                 const CarriedJets& carried, const Lanes& weight, FootLanes& feet) {
    findValuesHere(jets, corners, carried, weight, feet);
}
#endif

}  // namespace

void findCells(FootLanes& feet, bool fromPsi, CellPoints& points) {
#ifdef IGEO_AVX2
    if (eightAtATime()) return findCellsByEight(feet, fromPsi, points);
#endif
    findCellsByFour(feet, fromPsi, points);
}

void findValues(const CoreJets& jets, const JetCorners& corners, const CarriedJets& carried,
                const Lanes& weight, FootLanes& feet) {
#ifdef IGEO_AVX2
    if (eightAtATime()) return findValuesByEight(jets, corners, carried, weight, feet);
#endif
    findValuesByFour(jets, corners, carried, weight, feet);
}

void findCoreValues(const CoreJets& jets, const LiftedJets& lifted, NodeIndex first,
                    FootLanes& feet) {
#ifdef IGEO_AVX2
    if (eightAtATime()) return findCoreValuesByEight(jets, lifted.data(), first, feet);
#endif
    findCoreValuesByFour(jets, lifted.data(), first, feet);
}

void layOut(const JetCore& core, const LiftedJets& lifted, const Vec3f& foot, const Ijk& middle,
            const LocalFrame& local, BoxLanes& box) {
    const LiftedJet* const from = lifted.empty() ? nullptr : lifted.data();
#ifdef IGEO_AVX2
    if (eightAtATime()) return layOutByEight(core.nodes.data(), from, foot, middle, local, box);
#endif
    layOutByFour(core.nodes.data(), from, foot, middle, local, box);
}

}  // namespace igeo::jet
