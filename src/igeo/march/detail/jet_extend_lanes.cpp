#include <igeo/march/detail/jet_extend_lanes.h>

// Loops over all lanes, which compilers turn into vector instructions.
namespace igeo::jet {

namespace {

IGEO_INLINE void findCellsHere(FootLanes& feet, CellPoints& points) {
    constexpr std::uint32_t kEdge = LeafNumbers<2>::kEdge, kMargin = 2, kLast = kEdge - 2;
    auto place = [](float foot, std::int32_t low) { return foot - float(low); };
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

IGEO_INLINE void findValuesHere(const CoreJets& jets, const JetCorners& corners,
                                const CarriedJets& carried, const Lanes& weight, FootLanes& feet) {
    const StraightLines::Line line = jets.seeds.lines.only();
    const double leastStart = jets.buckets.leastStart, width = jets.buckets.width,
                 cost = jets.seeds.lines.leastCost(), largestInDisc = jets.seeds.largestInDisc;
    for (std::size_t k = 0; k < Lanes::kNodes; ++k) {
        const double start = leastStart + (double(std::int32_t(corners.bucket[k])) - 1.0) * width;
        const double value = start + double(weight[k] * carried.u[k]);
        const bool beyondDisc = value > largestInDisc + kDiscMargin * double(weight[k]);
        feet.plain[k] = corners.smooth[k] & -(carried.spreads[k] & std::int32_t(beyondDisc) &
                                              std::int32_t(corners.count[k] > 0));
        const Ijk step = stepOf(feet.offset[k]);
        const Vec3d off{double(feet.originX[k] + step.x) + double(feet.x[k]) - line.from.x,
                        double(feet.originY[k] + step.y) + double(feet.y[k]) - line.from.y,
                        double(feet.originZ[k] + step.z) + double(feet.z[k]) - line.from.z};
        const double bound = line.start + cost * length(off);
        feet.value[k] = value < bound ? bound : value;
    }
}

void findCellsByFour(FootLanes& feet, CellPoints& points) { findCellsHere(feet, points); }
void findValuesByFour(const CoreJets& jets, const JetCorners& corners, const CarriedJets& carried,
                      const Lanes& weight, FootLanes& feet) {
    findValuesHere(jets, corners, carried, weight, feet);
}
#ifdef IGEO_AVX2
IGEO_AVX2 void findCellsByEight(FootLanes& feet, CellPoints& points) {
    findCellsHere(feet, points);
}
IGEO_AVX2 void findValuesByEight(const CoreJets& jets, const JetCorners& corners,
                                 const CarriedJets& carried, const Lanes& weight, FootLanes& feet) {
    findValuesHere(jets, corners, carried, weight, feet);
}
#endif

}  // namespace

void findCells(FootLanes& feet, CellPoints& points) {
#ifdef IGEO_AVX2
    if (eightAtATime()) return findCellsByEight(feet, points);
#endif
    findCellsByFour(feet, points);
}

void findValues(const CoreJets& jets, const JetCorners& corners, const CarriedJets& carried,
                const Lanes& weight, FootLanes& feet) {
#ifdef IGEO_AVX2
    if (eightAtATime()) return findValuesByEight(jets, corners, carried, weight, feet);
#endif
    findValuesByFour(jets, corners, carried, weight, feet);
}

}  // namespace igeo::jet
