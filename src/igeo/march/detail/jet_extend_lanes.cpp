#include <igeo/base/detail/registers.h>
#include <igeo/march/detail/jet_extend_lanes.h>

// Loops over all lanes, which compilers turn into vector instructions.
namespace igeo::jet {

namespace {

IGEO_INLINE void findCellsHere(const Ijk& origin, FootLanes& feet, CellPoints& points) {
    constexpr std::uint32_t kEdge = LeafNumbers<2>::kEdge, kMargin = 2, kLast = kEdge - 2;
    auto place = [](float foot, std::int32_t low) { return foot - float(low); };
    for (std::size_t k = 0; k < Lanes::kNodes; ++k) {
        const Ijk low{floorToInt(feet.x[k]), floorToInt(feet.y[k]), floorToInt(feet.z[k])};
        points.x[k] = place(feet.x[k], low.x);
        points.y[k] = place(feet.y[k], low.y);
        points.z[k] = place(feet.z[k], low.z);
        // Unsigned: nodes of a group without numbers may lie far apart.
        auto inBlock = [](std::int32_t voxel, std::int32_t lower, std::int32_t from) {
            return std::uint32_t(voxel) + std::uint32_t(lower) + kMargin - std::uint32_t(from);
        };
        const std::uint32_t x = inBlock(feet.voxelX[k], low.x, origin.x),
                            y = inBlock(feet.voxelY[k], low.y, origin.y),
                            z = inBlock(feet.voxelZ[k], low.z, origin.z);
        const bool outside = (x > kLast) | (y > kLast) | (z > kLast);
        feet.cell[k] = std::int32_t((x * kEdge + y) * kEdge + z) | -std::int32_t(outside);
    }
}

IGEO_INLINE void findValuesHere(const CoreJets& jets, const JetCorners& corners,
                                const CarriedJets& carried, const Lanes& weight, FootLanes& feet) {
    const StraightLines::Line line = jets.seeds.lines.only();
    const double leastStart = jets.buckets.leastStart, width = jets.buckets.width,
                 cost = jets.seeds.lines.leastCost();
    for (std::size_t k = 0; k < Lanes::kNodes; ++k) {
        const double start = leastStart + (double(std::int32_t(corners.bucket[k])) - 1.0) * width;
        feet.value[k] = start + double(weight[k] * carried.u[k]);
        const Vec3d off{double(feet.voxelX[k]) + double(feet.x[k]) - line.from.x,
                        double(feet.voxelY[k]) + double(feet.y[k]) - line.from.y,
                        double(feet.voxelZ[k]) + double(feet.z[k]) - line.from.z};
        feet.bound[k] = line.start + cost * length(off);
    }
}

void findCellsByFour(const Ijk& origin, FootLanes& feet, CellPoints& points) {
    findCellsHere(origin, feet, points);
}
void findValuesByFour(const CoreJets& jets, const JetCorners& corners, const CarriedJets& carried,
                      const Lanes& weight, FootLanes& feet) {
    findValuesHere(jets, corners, carried, weight, feet);
}
#ifdef IGEO_AVX2
IGEO_AVX2 void findCellsByEight(const Ijk& origin, FootLanes& feet, CellPoints& points) {
    findCellsHere(origin, feet, points);
}
IGEO_AVX2 void findValuesByEight(const CoreJets& jets, const JetCorners& corners,
                                 const CarriedJets& carried, const Lanes& weight, FootLanes& feet) {
    findValuesHere(jets, corners, carried, weight, feet);
}
#endif

}  // namespace

void findCells(const Ijk& origin, FootLanes& feet, CellPoints& points) {
#ifdef IGEO_AVX2
    if (eightAtATime()) return findCellsByEight(origin, feet, points);
#endif
    findCellsByFour(origin, feet, points);
}

void findValues(const CoreJets& jets, const JetCorners& corners, const CarriedJets& carried,
                const Lanes& weight, FootLanes& feet) {
#ifdef IGEO_AVX2
    if (eightAtATime()) return findValuesByEight(jets, corners, carried, weight, feet);
#endif
    findValuesByFour(jets, corners, carried, weight, feet);
}

}  // namespace igeo::jet
