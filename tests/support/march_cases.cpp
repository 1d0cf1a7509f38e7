#include "march_cases.h"

#include <igeo/march/jet.h>
#include <igeo/surface/band_bounds.h>
#include <support/errors.h>
#include <support/shapes.h>

#include <algorithm>
#include <cmath>

namespace igeo::test {
namespace {

const openvdb::Vec3d kMiddle(3.137, -5.291, 1.413);
constexpr double kMajor = 14, kMinor = 6;

}  // namespace

openvdb::FloatGrid::Ptr torusGrid() { return makeLevelSet(torus(kMiddle, kMajor, kMinor), 1, 4); }

std::vector<Vec3d> torusPoints() {
    std::vector<Vec3d> points;
    for (const auto& [u, v] : {std::pair<double, double>{0.3, 0.7}, {2.9, -1.1}, {-1.7, 2.4}}) {
        const double d = kMajor + kMinor * std::cos(v);
        points.push_back({kMiddle.x() + d * std::cos(u), kMiddle.y() + d * std::sin(u),
                          kMiddle.z() + kMinor * std::sin(v)});
    }
    return points;
}

Band bandOf(const openvdb::FloatGrid::Ptr& grid, double h, int order) {
    LevelSet surface = checkedLevelSet(grid);
    const LevelSetStats& st = surface.stats;
    if (h == 0) h = defaultBandWidth(order, st.largestCurvature, bandBounds(st));
    return bandFromLevelSet(surface, h);
}

Field march(const Band& band, const std::vector<Vec3d>& seeds, int order) {
    std::vector<SurfacePoint> points;
    for (const Vec3d& s : seeds) points.push_back(nearestSurfacePoint(band, s));
    return marchFrom(band, points, order);
}

Field marchFrom(const Band& band, const std::vector<SurfacePoint>& seeds, int order) {
    if (order == kJet) return marchJet(band, {}, seeds);
    GodunovOptions options;
    options.order = order;
    return marchGodunov(band, {}, seeds, options);
}

SurfacePoint dyadicSeed(const Band& band, const Vec3d& p) {
    SurfacePoint seed = nearestSurfacePoint(band, p);
    for (int a = 0; a < 3; ++a)
        seed.pIndex[a] = std::round(std::ldexp(seed.pIndex[a], 20)) / (1 << 20);
    return seed;
}

SurfacePoint shifted(SurfacePoint seed, const Band& from, const Band& to, const Ijk& by) {
    seed.pIndex += Vec3d(by);
    seed.node = to.nodeAt(from.ijk(seed.node) + by);
    return seed;
}

openvdb::FloatGrid::Ptr mapVoxels(const openvdb::FloatGrid& grid,
                                  const std::function<Ijk(const Ijk&)>& map) {
    auto mapped = openvdb::FloatGrid::create(grid.background());
    mapped->setTransform(grid.transform().copy());
    mapped->setGridClass(grid.getGridClass());
    mapped->setName(grid.getName());
    for (auto it = grid.cbeginValueOn(); it; ++it) {
        const Ijk v = map({it.getCoord().x(), it.getCoord().y(), it.getCoord().z()});
        mapped->tree().setValueOn({v.x, v.y, v.z}, *it);
    }
    return mapped;
}

std::vector<Turn> allTurns() {
    std::vector<Turn> turns;
    std::array<int, 3> axis{0, 1, 2};
    do
        for (int signs = 0; signs < 8; ++signs)
            turns.push_back({axis, {signs & 1 ? -1 : 1, signs & 2 ? -1 : 1, signs & 4 ? -1 : 1}});
    while (std::next_permutation(axis.begin(), axis.end()));
    return turns;
}

openvdb::FloatGrid::Ptr inUnits(const openvdb::FloatGrid& grid, double factor) {
    auto result = grid.deepCopy();
    for (auto it = result->beginValueAll(); it; ++it) it.setValue(float(*it * factor));
    openvdb::math::Transform::Ptr transform = grid.transform().copy();
    transform->postScale(factor);
    result->setTransform(transform);
    return result;
}

double worstDifference(const Field& a, const Field& b, const std::function<Ijk(const Ijk&)>& map,
                       double scale) {
    if (a.reached != b.reached) return kInfinity;
    double worst = 0;
    for (std::size_t k = 0; k < a.distance.size(); ++k) {
        const double dA = a.distance[k] / scale;
        const NodeIndex j = b.band->nodeAt(map(a.band->ijk(NodeIndex(k))));
        if (j == kNoNode) return kInfinity;
        if (dA == b.distance[j]) continue;
        worst = std::max(worst, std::abs(dA - b.distance[j]));
    }
    return worst / b.maxDistance;
}

double worstDifference(const Field& a, const Field& b) {
    if (a.distance.size() != b.distance.size()) return kInfinity;
    double worst = 0;
    for (std::size_t k = 0; k < a.distance.size(); ++k)
        if (a.distance[k] != b.distance[k])
            worst = std::max(worst, std::abs(a.distance[k] - b.distance[k]));
    return worst / b.maxDistance;
}

}  // namespace igeo::test
