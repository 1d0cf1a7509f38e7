#include "errors.h"

#include <igeo/base/parallel.h>
#include <igeo/surface/level_set_check.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace igeo::test {

Errors errorsOnSurface(const Distance& distance, const ExactDistance& exact, std::size_t stride) {
    const Band& band = distance.band();
    const Field& field = distance.field();
    std::vector<NodeIndex> near;
    for (std::size_t i = 0; i < band.size(); ++i)
        if (std::abs(band.psi[i]) < 1) near.push_back(NodeIndex(i));
    const std::size_t count = near.empty() ? 0 : (near.size() + stride - 1) / stride;
    std::vector<double> computed(count), expected(count);
    parallelFor(count, 64, [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) {
            const Vec3d foot = band.footPoint(near[k * stride]);
            // A jet's value is that of the foot point; a voxel's has to be interpolated there.
            computed[k] =
                band.transform.dx * (!field.atFootPoints ? sampleDistance(field, foot)
                                                         : field.distance[near[k * stride]]);
            expected[k] = exact(worldOf(band, foot));
        }
    });
    Errors e;
    double largest = 0;
    std::vector<double> sizes;
    for (std::size_t k = 0; k < count; ++k) {
        if (std::isnan(expected[k])) continue;
        if (!std::isfinite(computed[k])) {
            ++e.unreached;
            continue;
        }
        largest = std::max(largest, expected[k]);
        e.bias += computed[k] - expected[k];
        sizes.push_back(std::abs(computed[k] - expected[k]));
        e.mean += sizes.back();
    }
    e.samples = sizes.size();
    if (sizes.empty()) return e;
    std::sort(sizes.begin(), sizes.end());
    const double percent = 100 / largest;
    e.mean *= percent / double(e.samples);
    e.bias *= percent / double(e.samples);
    e.max = percent * sizes.back();
    e.p99 = percent * sizes[std::size_t(0.99 * double(sizes.size() - 1))];
    return e;
}

double fittedRate(const std::vector<double>& dx, const std::vector<double>& error) {
    double mx = 0, my = 0, xx = 0, xy = 0;
    const double n = double(dx.size());
    for (std::size_t k = 0; k < dx.size(); ++k)
        mx += std::log(dx[k]) / n, my += std::log(error[k]) / n;
    for (std::size_t k = 0; k < dx.size(); ++k) {
        const double x = std::log(dx[k]) - mx;
        xx += x * x;
        xy += x * (std::log(error[k]) - my);
    }
    return xy / xx;
}

LevelSet checkedLevelSet(const openvdb::FloatGrid::Ptr& grid) {
    LoadedGrid loaded;
    loaded.grid = grid;
    loaded.file = "test";
    loaded.name = grid->getName();
    loaded.isLevelSetClass = grid->getGridClass() == openvdb::GRID_LEVEL_SET;
    return checkLevelSet(std::move(loaded));
}

SurfacePoint pointOn(const Band& band, const openvdb::Vec3d& pWorld) {
    return nearestSurfacePoint(band, band.transform.indexFromWorld(fromVdb(pWorld)));
}

openvdb::Vec3d worldOf(const Band& band, const Vec3d& pIndex) {
    const Vec3d p = band.transform.worldFromIndex(pIndex);
    return {p.x, p.y, p.z};
}

openvdb::Vec3d seedOf(const Distance& distance) {
    return worldOf(distance.band(), distance.seeds().at(0).pIndex);
}

openvdb::Vec3d genericDirection(int k) {
    if (k == 0) return openvdb::Vec3d(0.314106, 0.52711, 0.789615).unit();
    std::mt19937 random(static_cast<unsigned>(k));
    std::normal_distribution<double> normal;
    openvdb::Vec3d v;
    for (int a = 0; a < 3; ++a) v[a] = normal(random);
    return v.unit();
}

}  // namespace igeo::test
