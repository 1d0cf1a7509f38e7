#include "analytic_band.h"

#include <cmath>
#include <map>
#include <tuple>

namespace igeo::test {

Band bandOfVoxels(const std::vector<Ijk>& voxels) {
    std::map<std::tuple<int, int, int>, BandLeaf> leaves;
    for (const Ijk& v : voxels) {
        const Ijk origin{v.x & ~7, v.y & ~7, v.z & ~7};
        BandLeaf& leaf = leaves[{origin.x, origin.y, origin.z}];
        leaf.origin = origin;
        leaf.band.insert(Band::offsetOf(v.x, v.y, v.z));
    }
    Band band;
    for (const auto& entry : leaves) band.leaves.push_back(entry.second);
    band.buildTopology();
    return band;
}

Band analyticBand(const std::function<double(const Vec3d&)>& psi,
                  const std::function<Vec3d(const Vec3d&)>& normal, const Ijk& low, const Ijk& high,
                  double h) {
    std::vector<Ijk> voxels;
    for (int x = low.x; x <= high.x; ++x)
        for (int y = low.y; y <= high.y; ++y)
            for (int z = low.z; z <= high.z; ++z)
                if (std::abs(psi(Vec3d(x, y, z))) < h) voxels.push_back({x, y, z});
    Band band = bandOfVoxels(voxels);
    band.h = h;
    for (std::size_t k = 0; k < band.size(); ++k) {
        const Vec3d p(band.ijk(NodeIndex(k)));
        const Vec3d n = normal(p);
        band.psi[k] = float(psi(p));
        band.normal[k] = Vec3f(n);
        band.foot[k] = Vec3f(-psi(p) * n);
    }
    for (std::size_t k = 0; k < band.size(); ++k) band.markFacing(NodeIndex(k));
    band.numberCore();
    return band;
}

Band planeBand(const Vec3d& normal, double offset, const Ijk& low, const Ijk& high, double h) {
    const Vec3d n = normalized(normal);
    return analyticBand([=](const Vec3d& p) { return dot(n, p) - offset; },
                        [=](const Vec3d&) { return n; }, low, high, h);
}

Band sphereBand(const Vec3d& center, double radius, double h) {
    const double reach = radius + h + 1;
    const Vec3d corner(reach, reach, reach);
    return analyticBand([=](const Vec3d& p) { return length(p - center) - radius; },
                        [=](const Vec3d& p) { return normalized(p - center); },
                        floorToIjk(center - corner), roundToIjk(center + corner), h);
}

}  // namespace igeo::test
