/// The color of points in a picture. Internal.
#pragma once

#include <igeo/base/detail/registers.h>
#include <igeo/march/field.h>
#include <igeo/results/detail/film.h>
#include <igeo/results/detail/legend.h>
#include <igeo/results/detail/raster.h>

#include <algorithm>
#include <array>
#include <memory>
#include <vector>

namespace igeo {

/// Visible points, in camera coordinates: the first of all, the second of all, and so on, up to
/// full registers of eight.
struct Spots {
    const float *towardX, *towardY;  ///< the ray (Frame::toward)
    const float* depth;              ///< how far along it; +infinity: none
    const float *nx, *ny, *nz;       ///< unit normal, on either side of the surface
    float* distance;                 ///< +infinity: unreached
    const float* open;               ///< share of ambient light that is not blocked, 0 to 1
    const float* slope;  ///< change of the distance between neighboring samples; 0: a sharp line
    std::size_t size;

    bool any(std::size_t k) const { return depth[k] < std::numeric_limits<float>::infinity(); }
    Vec3f normal(std::size_t k) const { return {nx[k], ny[k], nz[k]}; }
    Vec3f place(std::size_t k) const { return depth[k] * Vec3f{towardX[k], towardY[k], 1}; }
};

/// Spots one by one.
class SpotList {
public:
    explicit SpotList(std::size_t capacity)
        : stride_((capacity + 7) / 8 * 8), numbers_(new float[kNumbers * stride_]) {
        std::fill_n(&numbers_[2 * stride_], stride_, std::numeric_limits<float>::infinity());
    }
    std::size_t size() const { return size_; }
    void add(const std::array<float, 9>& spot) {
        for (std::size_t k = 0; k < kNumbers; ++k) numbers_[k * stride_ + size_] = spot[k];
        ++size_;
    }
    Spots spots() {
        auto of = [&](std::size_t k) { return &numbers_[k * stride_]; };
        return {of(0), of(1), of(2), of(3), of(4), of(5), of(6), of(7), of(8), size_};
    }

private:
    static constexpr std::size_t kNumbers = 9;
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
    bool knowsAll() const { return !field_.stoppedEarly; }
    /// A distance at a camera point; +infinity beyond an early stop.
    float known(const Vec3f& place, float distance) const {
        return field_.stoppedEarly && double(distance) > lastKnown(place)
                   ? std::numeric_limits<float>::infinity()
                   : distance;
    }
    const Field& field() const { return field_; }
    /// @param colors  one per spot; left as it is where there is none
    void color(const Spots& spots, Rgba* colors) const;

private:
    using Four = Registers<4>::Vector;
    Registers<4>::Integers stepsOf(const Four& distance) const;
    Four lined(const Four& color, const Spots& spots, std::size_t k, std::size_t& level) const;
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
    /// For equal steps from the least to the largest distance.
    struct Step {
        Four color;          ///< without alpha
        double fromIsoline;  ///< the least distance to a level
    };
    std::vector<Step> steps_;
};

}  // namespace igeo
