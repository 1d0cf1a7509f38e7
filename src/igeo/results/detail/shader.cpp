#include <igeo/results/detail/shader.h>

#include <igeo/base/detail/four_doubles.h>

#include <algorithm>
#include <cmath>

namespace igeo {

namespace {

/// The share of a sample of size `width` that a line covers, at distance `off` from its middle.
double coverage(double off, double half, double width) {
    if (!(width > 0)) return off < half ? 1 : 0;
    const double from = std::max(off - width / 2, -half), to = std::min(off + width / 2, half);
    return std::clamp((to - from) / width, 0.0, 1.0);
}

/// Light on spots.
struct Light {
    std::unique_ptr<float[]> diffuse;  ///< a factor of colors
    std::unique_ptr<float[]> shine;    ///< white

    explicit Light(std::size_t spots)
        : diffuse(new float[spots + 7]), shine(new float[spots + 7]) {}
};

/// Studio light: a key light from the upper left, wrapped around for soft edges, a fill light from
/// the right, and ambient light so that nothing is black.
template <int Width>
class LightLanes {
    using V = typename Registers<Width>::Vector;
    using Vectors = VectorLanes<Width>;

    IGEO_INLINE static V positive(const V& v) { return v > 0 ? v : V{}; }
    IGEO_INLINE static Vectors unit(const Vectors& v) {
        V len = dot(v, v);
        takeRoots<Width>(len);
        return v * (1 / len);
    }
    IGEO_INLINE static Vectors everywhere(const Vec3f& v) {
        return {V{} + v.x, V{} + v.y, V{} + v.z};
    }

public:
    LightLanes()
        : key_(normalized(Vec3d{-0.55, 0.75, -0.75})), fill_(normalized(Vec3d{0.9, 0.1, -0.5})) {}

    IGEO_INLINE void shine(const Spots& spots, std::size_t k, Light& light) const {
        const Vectors key = everywhere(key_), fill = everywhere(fill_),
                      dir = unit({loadLanes<Width>(&spots.towardX[k]),
                                  loadLanes<Width>(&spots.towardY[k]), V{} + 1});
        Vectors n{loadLanes<Width>(&spots.nx[k]), loadLanes<Width>(&spots.ny[k]),
                  loadLanes<Width>(&spots.nz[k])};
        const V away = dot(n, dir), one = V{} + 1;
        n = n * (away > 0 ? -one : one);
        const V wrapped = positive((dot(n, key) + 0.35f) * float(1 / 1.35)),
                filled = positive(dot(n, fill)), grazing = positive(1 - absolute(away)),
                rim = grazing * grazing * grazing,
                open = 0.2f + 0.8f * loadLanes<Width>(&spots.open[k]);
        const V diffuse =
            (0.42f + 0.62f * wrapped * wrapped + 0.14f * filled) * (1 - 0.3f * rim) * open;
        V shine = positive(dot(n, unit(key - dir)));
        shine *= shine, shine *= shine * shine, shine *= shine, shine *= shine;  // to the 24th
        storeLanes(diffuse, &light.diffuse[k]);
        storeLanes(0.05f * open * shine, &light.shine[k]);
    }

private:
    Vec3f key_, fill_;
};
template <int Width>
IGEO_INLINE void lightAll(const Spots& spots, Light& light) {
    const LightLanes<Width> lanes;
    for (std::size_t k = 0; k < spots.size; k += Width)
        if (bitsOf<Width>(loadLanes<Width>(&spots.depth[k]) <
                          std::numeric_limits<float>::infinity()))
            lanes.shine(spots, k, light);
}
void lightByFour(const Spots& spots, Light& light) { lightAll<4>(spots, light); }
#ifdef IGEO_AVX2
IGEO_AVX2 void lightByEight(const Spots& spots, Light& light) { lightAll<8>(spots, light); }
#endif

Light lightOf(const Spots& spots) {
    Light light(spots.size);
#ifdef IGEO_AVX2
    (eightAtATime() ? lightByEight : lightByFour)(spots, light);
#else
    lightByFour(spots, light);
#endif
    return light;
}

/// Voxels: what no picture shows, and what readers of the core alone may be off by.
constexpr double kLeastTolerance = 0.01;

}  // namespace

Shader::Shader(const Field& field, const ArrivalReader& reader, const Scale& scale,
               double isolineHalf, const Frame& frame, double tolerance)
    : field_(field),
      reader_(reader),
      scale_(scale),
      isolineHalf_(isolineHalf),
      frame_(frame),
      tolerance_(std::max(tolerance, kLeastTolerance)) {
    for (std::size_t k = 1; k < scale.levels.size(); ++k)
        isolineHalf_ = std::min(isolineHalf_, 0.15 * (scale.levels[k] - scale.levels[k - 1]));
    constexpr int kSteps = 1 << 13;
    std::size_t level = 0;
    for (int k = 0; k <= kSteps; ++k) {
        const double share = double(k) / kSteps;
        const Vec3f c(scale.colors(share));
        // A step has the distances up to a half of it away, the first and the last all others.
        const double off = k > 0 && k < kSteps ? scale.fromIsoline(scale.atShare(share), level) : 0;
        steps_.push_back({Four{c.x, c.y, c.z, 0}, off - 0.6 * (scale.high - scale.low) / kSteps});
    }
}

std::vector<float> Shader::read(const std::vector<Vec3d>& points, const std::vector<Vec3f>& normals,
                                std::vector<std::uint8_t>& isSmooth) const {
    std::vector<Arrival> arrivals(points.size());
    isSmooth.resize(points.size());
    reader_.read(points, normals, arrivals.data(), tolerance_, isSmooth.data());
    std::vector<float> distances;
    for (const Arrival& a : arrivals) distances.push_back(float(a.distance));
    return distances;
}

/// The distance at which an early stop ends the colors, so that they end along a level line and not
/// cell by cell: jets reach beyond the last node, and means of voxels are too low where some are
/// missing.
double Shader::lastKnown(const Vec3f& place) const {
    return field_.maxDistance - (field_.atFootPoints ? 0 : 2 * weightAt(place));
}

/// The numbers of steps of color.
Registers<4>::Integers Shader::stepsOf(const Four& distance) const {
    const auto last = float(steps_.size() - 1);
    const double low = scale_.low, range = scale_.high - low;
    const Four share =
                   range > 0
                       ? __builtin_convertvector(
                             (__builtin_convertvector(distance, FourDoubles) - low) / range, Four)
                       : Four{},
               at = share * last, positive = at > 0 ? at : Four{};
    return __builtin_convertvector((positive < last ? positive : Four{} + last) + 0.5f,
                                   Registers<4>::Integers);
}

/// The color of a reached spot, with its part of an isoline.
Shader::Four Shader::lined(const Four& color, const Spots& spots, std::size_t k,
                           std::size_t& level) const {
    const double slope = double(spots.slope[k]),
                 off = scale_.fromIsoline(double(spots.distance[k]), level),
                 half = isolineHalf_ * weightAt(spots.place(k));
    if (!(off < half + slope / 2)) return color;
    const auto share = float(coverage(off, half, slope));
    const Vec3f line(Scale::lineOn({double(color[0]), double(color[1]), double(color[2])}));
    return share * Four{line.x, line.y, line.z, 0} + (1 - share) * color;
}

void Shader::color(const Spots& spots, Rgba* colors) const {
    const Light light = lightOf(spots);
    const Vec3f gray(kUnreached);
    const bool weighted = field_.metric->weighted();
    std::size_t level = 0;
    for (std::size_t first = 0; first < spots.size; first += 4) {
        if (!bitsOf<4>(loadLanes<4>(&spots.depth[first]) < FourSamples::kFar)) continue;
        const auto steps = stepsOf(loadLanes<4>(&spots.distance[first]));
        for (std::size_t k = first; k < first + 4; ++k) {
            if (!spots.any(k)) continue;
            Four c{gray.x, gray.y, gray.z, 0};
            if (spots.distance[k] < float(kInfinity)) {
                const Step& step = steps_[std::size_t(steps[k - first])];
                c = step.color;
                if (weighted || step.fromIsoline < isolineHalf_ + double(spots.slope[k]) / 2)
                    c = lined(c, spots, k, level);
            }
            const float shine = light.shine[k];
            storeLanes(light.diffuse[k] * c + Four{shine, shine, shine, 1}, &colors[k].r);
        }
    }
}

}  // namespace igeo
