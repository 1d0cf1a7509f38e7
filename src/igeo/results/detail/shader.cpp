#include <igeo/results/detail/shader.h>

#include <igeo/base/detail/registers.h>

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
void lightByFour(const Spots& spots, Light& light) {
    const LightLanes<4> lanes;
    for (std::size_t k = 0; k < spots.size(); k += 4) lanes.shine(spots, k, light);
}
#ifdef IGEO_AVX2
IGEO_AVX2 void lightByEight(const Spots& spots, Light& light) {
    const LightLanes<8> lanes;
    for (std::size_t k = 0; k < spots.size(); k += 8) lanes.shine(spots, k, light);
}
#endif

Light lightOf(Spots& spots) {
    spots.fillRegister();
    Light light(spots.size());
#ifdef IGEO_AVX2
    (eightAtATime() ? lightByEight : lightByFour)(spots, light);
#else
    lightByFour(spots, light);
#endif
    return light;
}

}  // namespace

Shader::Shader(const Field& field, const ArrivalReader& reader, const Scale& scale,
               double isolineHalf, const Frame& frame, double tolerance)
    : field_(field),
      reader_(reader),
      scale_(scale),
      isolineHalf_(isolineHalf),
      frame_(frame),
      tolerance_(tolerance) {
    constexpr int kColors = 1 << 13;
    for (int k = 0; k <= kColors; ++k) colors_.emplace_back(scale.colors(double(k) / kColors));
    for (std::size_t k = 1; k < scale.levels.size(); ++k)
        isolineHalf_ = std::min(isolineHalf_, 0.15 * (scale.levels[k] - scale.levels[k - 1]));
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

void Shader::color(Spots& spots, std::vector<Vec3f>& colors) const {
    const std::size_t n = spots.size();
    const Light light = lightOf(spots);
    colors.resize(n);
    std::size_t level = 0;
    for (std::size_t k = 0; k < n; ++k) {
        Vec3f c(kUnreached);
        if (const float d = spots.distance[k]; d < float(kInfinity)) {
            c = colorOf(d);
            const double slope = double(spots.slope[k]), off = scale_.fromIsoline(double(d), level),
                         half = isolineHalf_ * weightAt(spots.place(k));
            if (off < half + slope / 2) {
                const auto share = float(coverage(off, half, slope));
                c = share * Vec3f(Scale::lineOn(Vec3d(c))) + (1 - share) * c;
            }
        }
        const float shine = light.shine[k];
        colors[k] = light.diffuse[k] * c + Vec3f{shine, shine, shine};
    }
}

}  // namespace igeo
