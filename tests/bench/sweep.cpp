#include "sweep.h"

#include <openvdb/tools/FastSweeping.h>

namespace igeo::test {
namespace {

// maskSdf extends a signed distance from its zero crossing: distances less the radius of a ball
// that holds it.
constexpr double kZero = 1.5;

openvdb::Coord coordOf(const Band& band, NodeIndex i) {
    const Ijk v = band.ijk(i);
    return {v.x, v.y, v.z};
}

}  // namespace

Sweep::Sweep(const Band& band, const SurfacePoint& seed, double startRadius)
    : band_(band), seed_(seed), startRadius_(startRadius), start_(float(startRadius)) {
    auto start = start_.getAccessor();
    auto mask = mask_.getAccessor();
    for (NodeIndex i = 0; i < band.size(); ++i) {
        mask.setValueOn(coordOf(band, i), true);
        const double r = length(Vec3d(band.ijk(i)) - seed.pIndex);
        if (r <= startRadius) start.setValueOn(coordOf(band, i), float(r - kZero));
    }
}

void Sweep::run(int iterations) {
    swept_.setTree(openvdb::tools::maskSdf(start_, mask_, false, iterations)->treePtr());
}

Field Sweep::field() const {
    Field field;
    field.band = &band_;
    field.scheme = "maskSdf";
    field.seeds = {seed_};
    field.startRadius = startRadius_;
    const auto swept = swept_.getConstAccessor();
    for (NodeIndex i = 0; i < band_.size(); ++i)
        field.distance.push_back(double(swept.getValue(coordOf(band_, i))) + kZero);
    field.summarize();
    return field;
}

}  // namespace igeo::test
