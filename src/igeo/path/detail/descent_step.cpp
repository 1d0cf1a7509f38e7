#include <igeo/path/detail/descent_step.h>

#include <igeo/band/detail/chord.h>
#include <igeo/band/tangent_frame.h>

#include <algorithm>
#include <cmath>

namespace igeo {

namespace {

/// The direction of -G^-1 grad_S d (-grad_S d where the metric is isotropic), unit, blended from
/// the corners of the cell; false where it vanishes.
bool downAt(const Field& field, const Vec3d& sheetNormal, const Vec3d& p, Vec3d& v) {
    const SurfaceCell cell(*field.band, *field.metric, p, sheetNormal);
    const Vec3d g = gradientOfFirst(field, p, cell);
    const double len = length(g);
    if (!(len > 0)) return false;
    if (!field.metric->anisotropic()) {
        v = -(1 / len) * g;
        return true;
    }
    const TangentFrame frame{Vec3f(cell.normal)};
    const Stretch stretch = field.metric->inPlane(frame, cell).stretch;
    v = -normalized(Vec3d(frame.lift(stretch.vectorBack(stretch.covector(frame.flat(Vec3f(g)))))));
    return true;
}

/// A step along the rim of an obstacle: in the free direction closest to v.
bool slideAlongRim(const Field& field, const Vec3d& sheetNormal, Vec3d& p, const Vec3d& v,
                   double step) {
    constexpr double kStep = 0.5, kCoarse = 0.15, kWidest = 2, kFine = 0.005;  // voxels, radians
    const Vec3d across = cross(sheetNormal, v);
    Vec3d q;
    auto isFree = [&](double angle) {
        q = p + std::min(step, kStep) * (std::cos(angle) * v + std::sin(angle) * across);
        return projectToSurface(*field.band, q, sheetNormal) &&
               !field.metric->blocked(p, q, sheetNormal);
    };
    for (double angle = kCoarse; angle < kWidest; angle += kCoarse)
        for (const double turn : {1.0, -1.0}) {
            if (!isFree(turn * angle)) continue;
            double blocked = angle - kCoarse, free = angle;
            while (free - blocked > kFine) {
                const double middle = (free + blocked) / 2;
                (isFree(turn * middle) ? free : blocked) = middle;
            }
            isFree(turn * free);
            p = q;
            return true;
        }
    return false;
}

}  // namespace

bool stepDown(const Field& field, const StepLimits& limits, const Vec3d& sheetNormal, Vec3d& p,
              double& step) {
    const Band& band = *field.band;
    Vec3d k1, k2, k3, k4;
    if (!downAt(field, sheetNormal, p, k1)) return false;
    for (; step >= limits.least; step /= 2) {
        if (!downAt(field, sheetNormal, p + (step / 2) * k1, k2) ||
            !downAt(field, sheetNormal, p + (3 * step / 4) * k2, k3))
            continue;
        Vec3d q = p + step * ((2.0 / 9) * k1 + (1.0 / 3) * k2 + (4.0 / 9) * k3);
        if (!downAt(field, sheetNormal, q, k4)) continue;
        const double error =
            step * length((-5.0 / 72) * k1 + (1.0 / 12) * k2 + (1.0 / 9) * k3 - (1.0 / 8) * k4);
        const double ratio = error / limits.error;
        if (ratio > 1) continue;
        const Vec3d free = q;
        if (!projectToSurface(band, q, sheetNormal) || length(q - free) > step) continue;
        if (band.triangles && !followsSurface(band, p, q)) continue;
        if (field.metric->blocked(p, q, sheetNormal))
            return slideAlongRim(field, sheetNormal, p, k1, step);
        p = q;
        // Third-order local error: the step that just meets the tolerance, with a margin.
        const double growth = ratio > 0 ? 0.9 * std::cbrt(1 / ratio) : 2.0;
        step = std::min(step * std::clamp(growth, 0.5, 2.0), limits.most);
        return true;
    }
    // Beside an obstacle every step may have a stage inside it, where no node has a gradient.
    step = limits.most / 2;
    Vec3d ahead = p + step * k1;
    projectToSurface(band, ahead, sheetNormal);
    return field.metric->blocked(p, ahead, sheetNormal) &&
           slideAlongRim(field, sheetNormal, p, k1, step);
}

}  // namespace igeo
