/// Paths, seed curves and seeds in a picture. Internal.
#pragma once

#include <igeo/march/field.h>
#include <igeo/path/trace.h>
#include <igeo/results/detail/drawn_surface.h>
#include <igeo/results/detail/raster.h>

#include <vector>

namespace igeo {

/// A segment of a path or of a seed curve, with the normal of its sheet; index space.
struct MarkedSegment {
    Vec3d a, b, normal;
};
std::vector<MarkedSegment> markedSegments(const std::vector<Path>& paths,
                                          const std::vector<SurfacePoint>& seeds,
                                          const DrawnSurface& surface);

/// A seed, or the end of a path: a disc facing the camera.
struct Dot {
    Vec3d center;   ///< index space
    double radius;  ///< voxels
    bool seed;      ///< white with a dark ring, else dark with a white one
    bool hidden;    ///< behind the surface
};
std::vector<Dot> dots(const Field& field, const std::vector<Path>& paths,
                      const DrawnSurface& surface, const Vec3d& eye, double seedRadius);

/// The least distance from pixels to the lines of a picture; pixels.
class Strokes {
public:
    /// @param reach  largest distance that is stored
    Strokes(int width, int height, double reach);

    void add(const std::array<double, 2>& a, const std::array<double, 2>& b);
    bool empty() const { return distance_.empty(); }
    /// +infinity beyond the reach.
    double at(int x, int y) const {
        return distance_[std::size_t(y) * std::size_t(width_) + std::size_t(x)];
    }

private:
    int width_, height_;
    double reach_;
    std::vector<float> distance_;  ///< empty without lines
};

}  // namespace igeo
