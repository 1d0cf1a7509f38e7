/// A region with an exact signed distance.
#pragma once

#include <igeo/geodesic_solver.h>
#include <igeo/metric/obstacles.h>

#include <cmath>
#include <memory>

namespace igeo::test {

/// The cap of the unit sphere up to an angle from +z, as a signed seed.
inline Seeds signedCap(const Surface& surface, double angle) {
    const auto cap = std::make_shared<ObstacleSet>(surface.transform());
    cap->addSphere({0, 0, 1}, 2 * std::sin(angle / 2));
    Seeds seeds;
    seeds.regions.push_back(cap);
    seeds.isSigned = true;
    return seeds;
}

}  // namespace igeo::test
