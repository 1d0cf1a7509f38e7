#include <igeo/surface/detail/points_around.h>
#include <igeo/surface/detail/sheet_edges.h>
#include <igeo/surface/point_surface.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <tuple>

// Positions on the surface of a cloud.
namespace igeo {

namespace {

double squareOf(double x) { return x * x; }
double squareOf(const Vec3d& v) { return dot(v, v); }

}  // namespace

PointSurface::Blend PointSurface::blend(const Vec3d& y, const Vec3d& n,
                                        const std::vector<Index>& neighbors) const {
    double sum = 0, value = 0;
    Vec3d sumSlope{}, slope{};
    for (const Index j : neighbors) {
        const Patch& patch = patches_[j];
        const Vec3d d = y - patch.at;
        const double left = 1 - dot(d, d) / patch.reach2;
        if (!(left > 0) || !(dot(patch.normal, n) > patch.leastCosine)) continue;
        const double w = left * left * left;
        const Vec3d dw = (-6 * left * left / patch.reach2) * d;
        const Vec3d bent = patch.fit.bend(d);
        const double f = patch.fit.value + dot(patch.fit.gradient + bent, d);
        sum += w;
        value += w * f;
        sumSlope += dw;
        slope += w * (patch.fit.gradient + 2.0 * bent) + f * dw;
    }
    if (!(sum > 0)) return {};
    value /= sum;
    return {sum, value, (slope - value * sumSlope) * (1 / sum)};
}

bool PointSurface::within(const Vec3d& y, const Vec3d& n,
                          const std::vector<Index>& neighbors) const {
    // Directions in the tangent plane. Points in all eight octants decide without angles.
    const QuadricFit plane(n, 1);
    std::vector<double> angles;
    for (const bool exact : {false, true}) {
        unsigned octants = 0;
        for (const Index j : neighbors) {
            const Vec3d d = points_[j] - y;
            if (dot(d, d) >= squareOf(points_.reach(j)) || !sameSheet(j, n)) continue;
            const auto [u, v] = plane.flat(d);
            octants |= 1u << (4 * (u < 0) + 2 * (v < 0) + (std::abs(u) < std::abs(v)));
            if (exact) angles.push_back(std::atan2(v, u));
        }
        if (octants == 0xff) return true;
    }
    if (angles.size() < 3) return false;
    std::sort(angles.begin(), angles.end());
    double gap = angles.front() + 2 * std::numbers::pi - angles.back();
    for (std::size_t k = 1; k < angles.size(); ++k) gap = std::max(gap, angles[k] - angles[k - 1]);
    // The outermost points are themselves on the surface.
    return gap <= std::numbers::pi * (1 + 1e-6);
}

Vec3d PointSurface::onRim(const Vec3d& y, const Vec3d& n,
                          const std::vector<Index>& neighbors) const {
    const Vec3d s = anyNormalTo(n), t = cross(n, s);
    std::vector<Vec2d> points;
    for (const Index j : neighbors) {
        const Vec3d d = points_[j] - y;
        if (dot(d, d) < squareOf(points_.reach(j)) && sameSheet(j, n))
            points.push_back({dot(s, d), dot(t, d)});
    }
    // The corners of the hull, counterclockwise: first its lower side, then its upper one.
    std::vector<Vec2d> hull;
    const auto add = [&](std::size_t first, const Vec2d& p) {
        const auto turnsRight = [&] {
            const Vec2d &a = hull[hull.size() - 2], &b = hull.back();
            return cross(b - a, p - b) <= 0;
        };
        while (hull.size() >= first + 2 && turnsRight()) hull.pop_back();
        hull.push_back(p);
    };
    std::sort(points.begin(), points.end(), [](const Vec2d& a, const Vec2d& b) {
        return std::tie(a.x, a.y) < std::tie(b.x, b.y);
    });
    for (const Vec2d& p : points) add(0, p);
    const std::size_t lower = hull.empty() ? 0 : hull.size() - 1;
    for (std::size_t k = points.size(); k-- > 0;) add(lower, points[k]);
    double least = kInfinity;
    Vec2d nearest;
    for (std::size_t k = 1; k < hull.size(); ++k) {
        const Vec2d &a = hull[k - 1], along = hull[k] - a;
        const double size = dot(along, along),
                     at = size > 0 ? std::clamp(-dot(a, along) / size, 0.0, 1.0) : 0;
        const Vec2d p = a + at * along;
        if (dot(p, p) < least) least = dot(p, p), nearest = p;
    }
    return y + nearest.x * s + nearest.y * t;
}

double PointSurface::roughDistance(const Vec3d& x, Index nearest) const {
    return std::abs(patches_[nearest].fit.at(x - patches_[nearest].at));
}

bool PointSurface::mayProject(const Vec3d& middle, double radius, Index nearest,
                              double farthest) const {
    const Quadric& f = patches_[nearest].fit;
    const Vec3d slope = f.gradientAt(middle - patches_[nearest].at);
    const double bend = std::sqrt(squareOf(f.diagonal) + 2 * squareOf(f.mixed));
    const double change = radius * (length(slope) + bend * radius);
    return roughDistance(middle, nearest) <= (roughLimit(nearest, farthest) + change) * (1 + 1e-9);
}

double PointSurface::roughLimit(Index nearest, double farthest) const {
    return 1.25 * farthest + spacing_[nearest] / 4;
}

PointSurface::Index PointSurface::nearestSheet(const std::vector<PointTree::Found>& neighbors,
                                               const Vec3d& x) const {
    // Between two sheets the nearest point may be on the farther one, opposite a gap of the nearer.
    const Index first = neighbors.front().point;
    Index best = first;
    double least = roughDistance(x, first);
    for (const PointTree::Found& f : neighbors) {
        if (sameSheet(f.point, normals_[first])) continue;
        const double rough = roughDistance(x, f.point);
        if (rough < least) least = rough, best = f.point;
    }
    return best;
}

PointSurface::Foot PointSurface::project(const Vec3d& x, double farthest) const {
    PointsAround around(points_);
    around.moveTo(x, 0, reachOfProject(points_.nearest(x).point, farthest));
    return project(x, farthest, around);
}

double PointSurface::reachOfProject(Index nearest, double farthest) const {
    return roughLimit(nearest, farthest) + spacing_[nearest] / 2;
}

bool PointSurface::onLayer(std::size_t j, const Vec3d& y, const Vec3d& n) const {
    constexpr double kAlike = 0.8, kAbove = 0.6;  // cosine; spacings
    const Patch& patch = patches_[j];
    return dot(patch.normal, n) < kAlike ||
           std::abs(patch.fit.at(y - patch.at)) < kAbove * spacing_[j];
}

PointSurface::OnSheet PointSurface::ontoSheet(const Vec3d& x, Index nearest, double farthest,
                                              PointsAround& around,
                                              std::vector<Index>& neighbors) const {
    // Each step goes to F = 0 along grad F, and along the surface until x is straight above. The
    // remaining error is that before times psi times the curvature. Wherever the iteration ends, F
    // = 0 to second order in `flat`.
    constexpr int kSteps = 12;
    const double spacing = spacing_[nearest], flat = 1e-4 * spacing, straight = 2e-3 * spacing;
    const Vec3d d = x - points_[nearest];
    const Quadric& first = patches_[nearest].fit;
    if (roughDistance(x, nearest) > roughLimit(nearest, farthest)) return {};
    Vec3d n = normalized(first.gradientAt(d));
    Vec3d y = x - first.at(d) * n;

    const double margin = spacing / 2;
    const Vec3d middle = y;
    const auto gather = [&] {
        neighbors.clear();
        around.forReaching(y, margin, [&](Index j) {
            if (!layered_[nearest] || onLayer(j, y, n)) neighbors.push_back(j);
        });
    };
    gather();
    for (int step = 0;; ++step) {
        // Too far from the start: gather the points again here.
        if (squareOf(y - middle) > margin * margin && step < kSteps / 2) gather();
        const Blend f = blend(y, n, neighbors);
        const double slope = length(f.gradient);
        if (!(f.weight > 0) || !(slope > 0.1)) return {};
        n = f.gradient * (1 / slope);
        y -= (f.value / slope) * n;
        const Vec3d aside = tangential(x - y, n);
        if (step == kSteps ||
            (squareOf(aside) < straight * straight && std::abs(f.value) < flat * slope))
            return {true, y, n, nearest};
        y += aside;
    }
}

PointSurface::EndOfSheet PointSurface::endOf(const OnSheet& on,
                                             const std::vector<Index>& neighbors) const {
    constexpr double kNear = 2, kOpposite = -0.97;  // spacings; cosine
    const double near = kNear * spacing_[on.nearest];
    EndOfSheet end;
    if (std::none_of(neighbors.begin(), neighbors.end(), [&](Index j) {
            return atEdge_[j] & kAtEdge && squareOf(points_[j] - on.at) < near * near;
        }))
        return end;
    double least = kInfinity;
    for (const Index j : neighbors)
        if (const double far2 = squareOf(points_[j] - on.at);
            far2 < least && !sameSheet(j, on.normal))
            least = far2, end.point = j;
    if (!(least < kInfinity)) return end;
    const Patch& other = patches_[end.point];
    const Vec3d slope = other.fit.gradientAt(on.at - other.at);
    const double value = other.fit.at(on.at - other.at),
                 along = length(tangential(slope, on.normal));
    if (!(std::abs(value) < near * along) || dot(on.normal, normalized(slope)) < kOpposite)
        return end;
    for (const Index j : neighbors)
        if (sameSheet(j, on.normal)) end.side += other.fit.at(points_[j] - other.at);
    end.found = true;
    end.beyond = (end.side < 0 ? value : -value) / along;
    return end;
}

bool PointSurface::reaches(const OnSheet& on, const EndOfSheet& end,
                           const std::vector<Index>& neighbors) const {
    // The last points of a sheet are up to a spacing from its edge.
    if (end.found && end.beyond > -spacing_[on.nearest]) return end.beyond <= 0;
    return within(on.at, on.normal, neighbors);
}

PointSurface::Foot PointSurface::ontoEdge(const Vec3d& x, double farthest, const OnSheet& on,
                                          const EndOfSheet& end,
                                          const std::vector<Index>& neighbors) const {
    // Each step goes straight to where both sheets meet, and along the edge until x is straight
    // above.
    constexpr int kSteps = 12;
    constexpr double kLeastSine2 = 0.03;
    const double spacing = spacing_[on.nearest], flat = 1e-4 * spacing;
    Vec3d y = on.at, a = on.normal, b = normals_[end.point], along;
    for (int step = 0; step < kSteps; ++step) {
        const Blend f = blend(y, a, neighbors), g = blend(y, b, neighbors);
        if (!(f.weight > 0) || !(g.weight > 0)) return {};
        const double ff = squareOf(f.gradient), gg = squareOf(g.gradient),
                     fg = dot(f.gradient, g.gradient), det = ff * gg - fg * fg;
        if (!(det > kLeastSine2 * ff * gg)) return {};
        a = normalized(f.gradient), b = normalized(g.gradient);
        along = normalized(cross(a, b));
        y -= ((gg * f.value - fg * g.value) / det) * f.gradient +
             ((ff * g.value - fg * f.value) / det) * g.gradient;
        const double slide = dot(x - y, along);
        y += slide * along;
        if (std::abs(f.value) + std::abs(g.value) + std::abs(slide) < flat) break;
    }
    // The edge ends where the points of its sheets end.
    bool before = false, after = false;
    for (const Index j : neighbors) {
        const double s = dot(points_[j] - y, along);
        before |= s <= 0, after |= s >= 0;
    }
    const double far = length(x - y);
    if (!before || !after || !(far < farthest)) return {};
    // Both sheets lie below each other: x is above them.
    const double psi = end.side < 0 ? far : -far;
    const Vec3d n = far > flat ? (1 / psi) * (x - y) : normalized(a + b);
    return {true, y, n, psi, true};
}

PointSurface::Foot PointSurface::project(const Vec3d& x, double farthest, PointsAround& around,
                                         double beyond) const {
    thread_local std::vector<Index> neighbors, others;
    const auto footOn = [&](const OnSheet& on) {
        const double psi = dot(x - on.at, on.normal);
        return std::abs(psi) < farthest ? Foot{true, on.at, on.normal, psi} : Foot{};
    };
    const OnSheet on =
        ontoSheet(x, nearestSheet(around.nearest(x), x), farthest, around, neighbors);
    if (!on.found) return {};
    const Foot foot = footOn(on);
    const EndOfSheet end = endOf(on, neighbors);
    if (!(end.beyond > 0)) {
        if (!foot.valid || reaches(on, end, neighbors)) return foot;
        const Vec3d rim = onRim(on.at, on.normal, neighbors);
        return length(rim - on.at) < beyond ? Foot{true, rim, on.normal, foot.psi} : Foot{};
    }
    const OnSheet other = ontoSheet(x, end.point, farthest, around, others);
    if (other.found && reaches(other, endOf(other, others), others)) return footOn(other);
    return ontoEdge(x, farthest, on, end, neighbors);
}

}  // namespace igeo
