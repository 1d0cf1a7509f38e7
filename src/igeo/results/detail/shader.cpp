#include <igeo/results/detail/shader.h>

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

}  // namespace

Shader::Shader(const Field& field, const ArrivalReader& reader, const Scale& scale,
               double isolineHalf, const Frame& frame)
    : field_(field),
      reader_(reader),
      scale_(scale),
      isolineHalf_(isolineHalf),
      key_(normalized(-0.55 * frame.right + 0.75 * frame.up + 0.75 * frame.back)),
      fill_(normalized(0.9 * frame.right + 0.1 * frame.up + 0.5 * frame.back)) {
    for (std::size_t k = 1; k < scale.levels.size(); ++k)
        isolineHalf_ = std::min(isolineHalf_, 0.15 * (scale.levels[k] - scale.levels[k - 1]));
}

void Shader::setDistances(std::vector<Spot>& spots) const {
    std::vector<Vec3d> points;
    std::vector<Vec3f> normals;
    for (const Spot& spot : spots) points.push_back(spot.p), normals.emplace_back(spot.normal);
    std::vector<Arrival> arrivals(spots.size());
    reader_.read(points, normals, arrivals.data());
    for (std::size_t k = 0; k < spots.size(); ++k)
        spots[k].distance = known(spots[k].p, arrivals[k].distance);
}

/// The distance at which an early stop ends the colors, so that they end along a level line and not
/// cell by cell: jets reach beyond the last node, and means of voxels are too low where some are
/// missing.
double Shader::lastKnown(const Vec3d& p) const {
    return field_.maxDistance - (field_.atFootPoints ? 0 : 2 * weightAt(p));
}

Vec3d Shader::color(const Spot& spot, const Vec3d& dir) const {
    const bool reached = spot.distance < kInfinity;
    const Vec3d n = dot(spot.normal, dir) > 0 ? -spot.normal : spot.normal;
    Vec3d c = reached ? scale_.color(spot.distance) : kUnreached;
    if (reached && !scale_.levels.empty()) {
        const double off = scale_.fromIsoline(spot.distance);
        const double half = isolineHalf_ * weightAt(spot.p);
        c = mixed(coverage(off, half, spot.slope), Scale::lineOn(c), c);
    }
    return lit(c, n, dir, spot.occluded);
}

/// Studio light: a key light from the upper left, wrapped around for soft edges, a fill light from
/// the right, and ambient light so that nothing is black.
Vec3d Shader::lit(const Vec3d& c, const Vec3d& n, const Vec3d& dir, double occluded) const {
    const double wrapped = std::max(0.0, (dot(n, key_) + 0.35) / 1.35);
    const double filled = std::max(0.0, dot(n, fill_));
    const double grazing = 1 - std::clamp(-dot(n, dir), 0.0, 1.0);
    const double rim = grazing * grazing * grazing, open = 1 - 0.8 * occluded;
    const double diffuse =
        (0.42 + 0.62 * wrapped * wrapped + 0.14 * filled) * (1 - 0.3 * rim) * open;
    double shine = std::max(0.0, dot(n, normalized(key_ - dir)));
    shine *= shine, shine *= shine * shine, shine *= shine, shine *= shine;  // to the 24th
    return diffuse * c + 0.05 * open * shine * kWhite;
}

}  // namespace igeo
