/// Axis-aligned bounding boxes.
#pragma once

#include <igeo/base/types.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace igeo {

/// Empty, with low above high, until it holds a point.
struct Box {
    Vec3d low{kInfinity, kInfinity, kInfinity}, high = -low;

    Box() = default;
    explicit Box(const std::vector<Vec3d>& points) {
        for (const Vec3d& p : points) include(p);
    }
    void include(const Vec3d& p) {
        for (int a = 0; a < 3; ++a)
            low[a] = std::min(low[a], p[a]), high[a] = std::max(high[a], p[a]);
    }
    bool contains(const Vec3d& p) const {
        return low.x <= p.x && p.x <= high.x && low.y <= p.y && p.y <= high.y && low.z <= p.z &&
               p.z <= high.z;
    }
    Vec3d size() const { return high - low; }
    double longestSide() const { return std::max({size().x, size().y, size().z}); }
    /// The largest |coordinate|.
    double farthest() const {
        double most = 0;
        for (int a = 0; a < 3; ++a) most = std::max({most, std::abs(low[a]), std::abs(high[a])});
        return most;
    }
};

}  // namespace igeo
