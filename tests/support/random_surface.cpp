#include "random_surface.h"

#include <openvdb/tools/FastSweeping.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace igeo::test {
namespace {

using openvdb::Vec3d;

Shape capsule(const Vec3d& half, double radius) {
    const auto sdf = [=](const Vec3d& p) {
        const double t = std::min(std::max(p.dot(half) / half.lengthSqr(), -1.0), 1.0);
        return (p - t * half).length() - radius;
    };
    return {"capsule", sdf, {}, true, nullptr};
}

/// A part about the origin, at most 20 units from its middle to its furthest point.
Shape randomPart(Random& random, double blend) {
    const int kind = int(random.between(0, 4));
    const double size = random.between(6, 11);
    const double a = random.between(0, 1), b = random.between(0, 1);
    const Vec3d along = random.direction();
    switch (kind) {
        case 0:
            return sphere(Vec3d(0.0), size);
        case 1:
            return torus(Vec3d(0.0), size, size * (0.3 + 0.2 * a));
        case 2:
            return capsule(size * along, size * (0.3 + 0.3 * a));
        default:
            const Vec3d half = size * Vec3d(1, 0.4 + 0.6 * a, 0.4 + 0.6 * b);
            if (blend == 0) return box(Vec3d(0.0), half);
            return roundedBox(Vec3d(0.0), half, std::min({blend / 2, half.y(), half.z()}));
    }
}

/// Turns a shape about the origin and moves it to `center`.
SignedDistance placed(const SignedDistance& sdf, const Vec3d& axis, double angle,
                      const Vec3d& center) {
    const auto place = rotatedTransform(1, axis, angle, center);
    return [=](const Vec3d& p) { return sdf(place->worldToIndex(p)); };
}

/// The lesser of both; where they differ by less than `width`, smoothly below both. Its
/// gradient is a mean of theirs, so no longer than they are.
double blendedLeast(double a, double b, double width) {
    const double overlap = std::max(width - std::abs(a - b), 0.0);
    return std::min(a, b) - (width > 0 ? overlap * overlap / (4 * width) : 0);
}

}  // namespace

Vec3d Random::direction() {
    const double z = between(-1, 1), angle = between(0, 2 * M_PI), r = std::sqrt(1 - z * z);
    return {r * std::cos(angle), r * std::sin(angle), z};
}

Shape randomUnion(unsigned seed, double blend) {
    Random random(seed);
    std::vector<SignedDistance> parts;
    const int count = int(random.between(3, 7));
    Vec3d middle = random.direction();
    openvdb::BBoxd bounds(middle, middle);
    for (int k = 0; k < count; ++k) {
        const Shape part = randomPart(random, blend);
        const Vec3d axis = random.direction();
        const double angle = random.between(0, 360);
        parts.push_back(placed(part.sdf, axis, angle, middle));
        bounds.expand(openvdb::BBoxd(middle - Vec3d(24.0), middle + Vec3d(24.0)));
        const double step = random.between(4, 11);
        middle += step * random.direction();
    }
    const auto sdf = [=](const Vec3d& p) {
        double least = parts[0](p);
        for (std::size_t k = 1; k < parts.size(); ++k)
            least = blendedLeast(least, parts[k](p), blend);
        return least;
    };
    return {"random_union", sdf, bounds, true, nullptr};
}

openvdb::FloatGrid::Ptr randomLevelSet(unsigned seed, double blend,
                                       const openvdb::math::Transform& transform) {
    const auto grid = makeLevelSet(randomUnion(seed, blend), transform, 4);
    return openvdb::tools::sdfToSdf(*grid);
}

}  // namespace igeo::test
