/// The color of points in a picture. Internal.
#pragma once

#include <igeo/march/field.h>
#include <igeo/results/detail/legend.h>
#include <igeo/results/detail/raster.h>

namespace igeo {

/// A visible point; index space.
struct Spot {
    Vec3d p, normal;  ///< the surface's normal, toward the eye or away from it
    double distance = kInfinity;
    double occluded = 0;  ///< share of ambient light that is blocked, 0 to 1
    double slope = 0;     ///< change of the distance between neighboring samples; 0: a sharp line
};

class Shader {
public:
    /// @param isolineHalf  half the width of isolines, voxels
    Shader(const Field& field, const ArrivalReader& reader, const Scale& scale, double isolineHalf,
           const Frame& frame);

    /// The distances at visible points of S; +infinity beyond an early stop.
    void setDistances(std::vector<Spot>& spots) const;
    /// A distance at p; +infinity beyond an early stop.
    double known(const Vec3d& p, double distance) const {
        return field_.stoppedEarly && distance > lastKnown(p) ? kInfinity : distance;
    }
    /// @param dir  of the ray, unit
    Vec3d color(const Spot& spot, const Vec3d& dir) const;

private:
    double lastKnown(const Vec3d& p) const;
    double weightAt(const Vec3d& p) const {
        return field_.metric->weighted() ? field_.metric->at(cellAt(*field_.band, p)) : 1.0;
    }
    Vec3d lit(const Vec3d& c, const Vec3d& n, const Vec3d& dir, double occluded) const;

    const Field& field_;
    const ArrivalReader& reader_;
    const Scale& scale_;
    double isolineHalf_;
    Vec3d key_, fill_;
};

/// Blends two colors; `share` is that of the first.
inline Vec3d mixed(double share, const Vec3d& a, const Vec3d& b) {
    return share * a + (1 - share) * b;
}

}  // namespace igeo
