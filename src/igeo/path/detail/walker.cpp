#include <igeo/path/detail/walker.h>

#include <array>

namespace igeo {

Local localSurface(const Band& band, const Vec3d& p, const Vec3d& sheetNormal) {
    BandCell cell = cellAt(band, p);
    Local s;
    double present = 0, weight = 0;
    for (std::size_t k = 0; k < 8; ++k)
        if (cell.node[k] != kNoNode) present += cell.weight[k];
    const Vec3d n = dropFacingCorners(band, cell, sheetNormal);
    std::array<double, 8> height{};
    Vec3d gradient;
    for (std::size_t k = 0; k < 8; ++k) {
        const NodeIndex i = cell.node[k];
        if (i == kNoNode) continue;
        const Vec3d mean = 0.5 * (Vec3d(band.normal[i]) + n);
        height[k] = dot(p - band.footPoint(i), mean);
        weight += cell.weight[k];
        s.height += cell.weight[k] * height[k];
        gradient += cell.weight[k] * mean;
    }
    s.valid = present > 0.5 && weight > 0;
    if (!s.valid) return s;
    s.height /= weight;
    gradient *= 1 / weight;
    // The derivative of the weights. That of n, in the mean of all p - f, is of fourth order and
    // left out.
    const Vec3d t = cell.t;
    for (std::size_t k = 0; k < 8; ++k) {
        if (cell.node[k] == kNoNode) continue;
        const double wx = k >> 2 ? t.x : 1 - t.x, wy = k >> 1 & 1 ? t.y : 1 - t.y,
                     wz = k & 1 ? t.z : 1 - t.z, h = height[k] - s.height;
        gradient.x += (k >> 2 ? h : -h) * wy * wz;
        gradient.y += (k >> 1 & 1 ? h : -h) * wx * wz;
        gradient.z += (k & 1 ? h : -h) * wx * wy;
    }
    s.normal = normalized(gradient);
    return s;
}

}  // namespace igeo
