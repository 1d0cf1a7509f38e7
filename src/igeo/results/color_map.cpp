#include <igeo/results/color_map.h>

#include <igeo/base/error.h>

#include <numbers>

namespace igeo {

namespace {

/// Lightness, hue in degrees at both ends; chroma at the ends and in the middle.
struct Arc {
    const char* name;
    double light0, light1, hue0, hue1, chroma0, chroma1, chromaMiddle;
};

/// Dark enough for white lines and light enough for black ones at either end, and inside sRGB.
constexpr Arc kArcs[] = {
    {"lagoon", 0.42, 0.93, 285, 105, 0.150, 0.130, 0.105},
    {"sunset", 0.42, 0.90, 285, 455, 0.150, 0.120, 0.145},
    {"ember", 0.38, 0.94, 360, 460, 0.130, 0.100, 0.155},
    {"ice", 0.40, 0.95, 275, 200, 0.140, 0.040, 0.100},
    {"gray", 0.35, 0.95, 0, 0, 0, 0, 0},
};

Vec3d linearFromOklab(double lightness, double a, double b) {
    auto cube = [](double x) { return x * x * x; };
    const double l = cube(lightness + 0.3963377774 * a + 0.2158037573 * b);
    const double m = cube(lightness - 0.1055613458 * a - 0.0638541728 * b);
    const double s = cube(lightness - 0.0894841775 * a - 1.2914855480 * b);
    return {4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s,
            -1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s,
            -0.0041960863 * l - 0.7034186147 * m + 1.7076147010 * s};
}

double clamped(double t) { return t > 0 ? std::min(t, 1.0) : 0.0; }  // NaN: 0

Vec3d colorOn(const Arc& arc, double t) {
    auto mix = [t](double at0, double at1) { return at0 + t * (at1 - at0); };
    const double bulge = arc.chromaMiddle - (arc.chroma0 + arc.chroma1) / 2;
    const double chroma = mix(arc.chroma0, arc.chroma1) + 4 * t * (1 - t) * bulge;
    const double hue = mix(arc.hue0, arc.hue1) * std::numbers::pi / 180;
    const Vec3d c = linearFromOklab(mix(arc.light0, arc.light1), chroma * std::cos(hue),
                                    chroma * std::sin(hue));
    return {clamped(c.x), clamped(c.y), clamped(c.z)};
}

}  // namespace

Vec3d srgbFromLinear(const Vec3d& linear) {
    auto encode = [](double c) {
        c = clamped(c);
        return c <= 0.0031308 ? 12.92 * c : 1.055 * std::pow(c, 1 / 2.4) - 0.055;
    };
    return {encode(linear.x), encode(linear.y), encode(linear.z)};
}

ColorMap::ColorMap(const std::string& name) {
    constexpr int kSteps = 1024;  // linear in between: off by less than half of 1 / 255
    for (const Arc& arc : kArcs)
        if (arc.name == name)
            for (int k = 0; k <= kSteps; ++k) table_.push_back(colorOn(arc, double(k) / kSteps));
    if (!table_.empty()) return;
    std::string known;
    for (const std::string& n : names()) known += (known.empty() ? "" : ", ") + n;
    throw Error(Error::Kind::InvalidArgument, "there is no color map '" + name + "'",
                "choose one of " + known);
}

Vec3d ColorMap::operator()(double t) const {
    const double at = clamped(t) * double(table_.size() - 1);
    const auto k = std::min(std::size_t(at), table_.size() - 2);
    const double s = at - double(k);
    return (1 - s) * table_[k] + s * table_[k + 1];
}

std::vector<std::string> ColorMap::names() {
    std::vector<std::string> all;
    for (const Arc& arc : kArcs) all.push_back(arc.name);
    return all;
}

}  // namespace igeo
