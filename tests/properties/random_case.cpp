#include "random_case.h"

#include <igeo/march/godunov.h>
#include <igeo/march/jet.h>
#include <igeo/surface/level_set_band.h>
#include <support/errors.h>
#include <support/march_cases.h>

#include <algorithm>
#include <cmath>

namespace igeo::test {
namespace {

/// The band of purposes of RandomCase::random that the case itself uses.
enum : unsigned { kPlace, kSeeds };

openvdb::FloatGrid::Ptr randomPsi(unsigned number, double blend) {
    Random random(number * 16 + kPlace);
    const double dx = random.between(0.7, 1.1), angle = random.between(0, 360);
    const openvdb::Vec3d axis = random.direction(), aside = random.direction();
    const auto transform = rotatedTransform(dx, axis, angle, 30 * aside);
    // Units last: psi is as good a distance in any of them.
    const double unit = std::pow(10.0, random.between(-2, 4));
    return inUnits(*randomLevelSet(number, blend, *transform), unit);
}

/// Foot points of the core that are connected with a point on the outer surface: there may be
/// cavities.
std::vector<SurfacePoint> randomSeeds(Random random, const Band& band) {
    const openvdb::Vec3d far = random.direction();
    const Vec3d from = 1000.0 * Vec3d{far.x(), far.y(), far.z()};
    const Field field = marchJet(band, {}, {nearestSurfacePoint(band, from)});
    std::vector<NodeIndex> nodes;
    for (NodeIndex i = 0; i < band.size(); ++i)
        if (band.inCore(i) && field.distance[i] < kInfinity) nodes.push_back(i);
    std::vector<SurfacePoint> seeds;
    while (seeds.size() < 3) {
        const NodeIndex i = nodes[std::size_t(random.between(0, double(nodes.size())))];
        seeds.push_back(nearestSurfacePoint(band, band.footPoint(i)));
    }
    return seeds;
}

bool sheetsMeet(const Band& band) {
    for (NodeIndex i = 0; i < band.size(); ++i)
        if (band.facing[i] && band.inCore(i)) return true;
    return false;
}

}  // namespace

Band bandOf(const LevelSet& levelSet) { return bandFromLevelSet(levelSet, std::sqrt(3.0)); }

RandomCase::RandomCase(unsigned aNumber)
    : number(aNumber),
      // As wide as creases have to be to be seen on the grid, or none.
      psi(randomPsi(number, number % 2 ? 5 : 0)),
      levelSet(checkedLevelSet(psi->deepCopy())),
      band(bandOf(levelSet)),
      sharp(number % 2 == 0 || sheetsMeet(band)),
      seeds(randomSeeds(random(kSeeds), band)) {
    GodunovOptions first;
    first.order = 1;
    for (const SurfacePoint& s : seeds) {
        single.push_back(marchJet(band, {}, {s}));
        godunov.push_back(marchGodunov(band, {}, {s}, first));
    }
    all = marchJet(band, {}, seeds);
    allGodunov = marchGodunov(band, {}, seeds, first);
    for (const Field* field : fields()) {
        marched.keepWorst(checkField(*field, Nodes::Marched));
        everywhere.keepWorst(checkField(*field, Nodes::All));
        paths.keepWorst(checkPaths(*field));
    }
}

double RandomCase::least(const std::vector<Field>& fields, NodeIndex i) const {
    double d = kInfinity;
    for (const Field& f : fields) d = std::min(d, f.distance[i]);
    return d;
}

}  // namespace igeo::test
