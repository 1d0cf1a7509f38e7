/// The color of points in a picture. Internal.
#pragma once

#include <igeo/march/field.h>
#include <igeo/results/detail/legend.h>
#include <igeo/results/detail/raster.h>

#include <memory>
#include <vector>

namespace igeo {

/// Visible points, in camera coordinates: the first of all, the second of all, and so on.
struct Spots {
    float *towardX, *towardY, *depth;  ///< the ray (Frame::toward), and how far along it
    float *nx, *ny, *nz;               ///< unit normal, on either side of the surface
    float* distance;                   ///< +infinity: unreached
    float* open;                       ///< share of ambient light that is not blocked, 0 to 1
    float* slope;  ///< change of the distance between neighboring samples; 0: a sharp line

    explicit Spots(std::size_t capacity)
        : stride_((capacity + 7) / 8 * 8), numbers_(new float[9 * stride_]) {
        float* next = numbers_.get();
        for (float** of : {&towardX, &towardY, &depth, &nx, &ny, &nz, &distance, &open, &slope})
            *of = next, next += stride_;
    }
    std::size_t size() const { return size_; }
    void add(const Vec3f& ray, float itsDepth, const Vec3f& n, float itsDistance, float itsOpen = 1,
             float itsSlope = 0) {
        const std::size_t k = size_++;
        towardX[k] = ray.x, towardY[k] = ray.y, depth[k] = itsDepth;
        nx[k] = n.x, ny[k] = n.y, nz[k] = n.z;
        distance[k] = itsDistance, open[k] = itsOpen, slope[k] = itsSlope;
    }
    Vec3f normal(std::size_t k) const { return {nx[k], ny[k], nz[k]}; }
    Vec3f place(std::size_t k) const { return depth[k] * Vec3f{towardX[k], towardY[k], 1}; }

    /// Gives values to the rest of a register of eight.
    void fillRegister() {
        const std::size_t n = size_;
        while (size_ % 8) add({0, 0, 1}, 1, {0, 0, 1}, 0);
        size_ = n;
    }

private:
    std::size_t stride_, size_ = 0;
    std::unique_ptr<float[]> numbers_;
};

class Shader {
public:
    /// @param isolineHalf  half the width of isolines, voxels
    /// @param tolerance    of distances, voxels
    Shader(const Field& field, const ArrivalReader& reader, const Scale& scale, double isolineHalf,
           const Frame& frame, double tolerance);

    /// The distances at points of S, voxels times weight; +infinity: unreached.
    /// @param normals   of S, roughly; index space
    /// @param isSmooth  as ArrivalReader::read has it
    std::vector<float> read(const std::vector<Vec3d>& points, const std::vector<Vec3f>& normals,
                            std::vector<std::uint8_t>& isSmooth) const;
    /// A distance at a camera point; +infinity beyond an early stop.
    float known(const Vec3f& place, float distance) const {
        return field_.stoppedEarly && double(distance) > lastKnown(place)
                   ? std::numeric_limits<float>::infinity()
                   : distance;
    }
    const Field& field() const { return field_; }
    /// @param colors  one per spot, in linear light
    void color(Spots& spots, std::vector<Vec3f>& colors) const;

private:
    Vec3f colorOf(float distance) const {
        const float at = float(scale_.share(double(distance))) * float(colors_.size() - 1);
        return colors_[std::size_t(std::clamp(at, 0.0f, float(colors_.size() - 1)) + 0.5f)];
    }
    double lastKnown(const Vec3f& place) const;
    double weightAt(const Vec3f& place) const {
        return field_.metric->weighted()
                   ? field_.metric->at(cellAt(*field_.band, frame_.inSpace(Vec3d(place))))
                   : 1.0;
    }

    const Field& field_;
    const ArrivalReader& reader_;
    const Scale& scale_;
    double isolineHalf_;
    const Frame& frame_;
    double tolerance_;
    std::vector<Vec3f> colors_;  ///< for equal steps from the least to the largest distance
};

}  // namespace igeo
