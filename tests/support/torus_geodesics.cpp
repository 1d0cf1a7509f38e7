#include "torus_geodesics.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace igeo::test {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr int kDirections = 256;    // before more are put in where neighbors part
constexpr double kFanSteps = 8;     // per tube radius, enough for starting values
constexpr double kExactSteps = 96;  // per tube radius; Runge-Kutta's error is then below 1e-9
constexpr int kMaxDepth = 24;       // halvings of the angle between directions

/// The angle in (-pi, pi].
double wrap(double angle) { return std::remainder(angle, 2 * M_PI); }

}  // namespace

TorusGeodesics::TorusGeodesics(const openvdb::Vec3d& center, double majorRadius, double minorRadius,
                               const openvdb::Vec3d& seed)
    : center_(center),
      majorRadius_(majorRadius),
      minorRadius_(minorRadius),
      step_(minorRadius / kFanSteps),
      // half of the inner circle, and from both points around the tube to it
      maxLength_(M_PI * (majorRadius + minorRadius)),
      seed_(anglesOf(seed)) {
    for (int i = 0; i < kDirections; ++i) {
        const double direction = 2 * M_PI * i / kDirections;
        traceBetween(trace(direction), direction + 2 * M_PI / kDirections, 0);
    }
    std::size_t count = 0;
    for (const Ray& ray : fan_) {
        firstGap_.push_back(count);
        count += ray.states.size();
    }
    firstGap_.push_back(count);
}

double TorusGeodesics::distance(const openvdb::Vec3d& p) const {
    const Angles target = anglesOf(p);
    const double eastward = axisDistance(seed_.v) * wrap(target.u - seed_.u);
    const double upward = minorRadius_ * wrap(target.v - seed_.v);
    const double plane = std::hypot(eastward, upward);
    if (plane == 0) return 0;
    double best = kInfinity;
    if (plane < 4 * step_) best = refine(std::atan2(upward, eastward), plane, target);

    std::vector<double> gaps;
    gaps.reserve(firstGap_.back());
    for (const Ray& ray : fan_)
        for (const State& state : ray.states) gaps.push_back(gap(state, target));
    for (std::size_t i = 0; i < fan_.size(); ++i) {
        const Ray& ray = fan_[i];
        for (std::size_t k = 1; k < ray.states.size(); ++k) {
            const double length = static_cast<double>(k) * step_;
            if (length > best + 2 * step_) break;
            if (gaps[firstGap_[i] + k] < 3 * step_ && isNearest(i, k, gaps))
                best = std::min(best, refine(ray.direction, length, target));
        }
    }
    return best;
}

TorusGeodesics::Angles TorusGeodesics::anglesOf(const openvdb::Vec3d& p) const {
    const openvdb::Vec3d q = p - center_;
    return {std::atan2(q.y(), q.x()), std::atan2(q.z(), std::hypot(q.x(), q.y()) - majorRadius_)};
}

double TorusGeodesics::axisDistance(double v) const {
    return majorRadius_ + minorRadius_ * std::cos(v);
}

TorusGeodesics::State TorusGeodesics::start(double direction) const {
    return {seed_.u, seed_.v, std::sin(direction) / minorRadius_, 0, 1};
}

double TorusGeodesics::clairaut(double direction) const {
    return axisDistance(seed_.v) * std::cos(direction);
}

TorusGeodesics::State TorusGeodesics::derivative(const State& s, double clairaut) const {
    const double cosV = std::cos(s.v), d = majorRadius_ + minorRadius_ * cosV;
    const double du = clairaut / (d * d);
    const double curvature = cosV / (minorRadius_ * d);
    return {du, s.dv, -d * std::sin(s.v) * du * du / minorRadius_, s.dj, -curvature * s.j};
}

/// One step of the classical Runge-Kutta method.
TorusGeodesics::State TorusGeodesics::step(const State& s, double clairaut, double length) const {
    const auto moved = [](const State& a, double h, const State& b) {
        return State{a.u + h * b.u, a.v + h * b.v, a.dv + h * b.dv, a.j + h * b.j, a.dj + h * b.dj};
    };
    const State k1 = derivative(s, clairaut);
    const State k2 = derivative(moved(s, length / 2, k1), clairaut);
    const State k3 = derivative(moved(s, length / 2, k2), clairaut);
    const State k4 = derivative(moved(s, length, k3), clairaut);
    State end = moved(s, length / 6, k1);
    end = moved(end, length / 3, k2);
    end = moved(end, length / 3, k3);
    return moved(end, length / 6, k4);
}

TorusGeodesics::State TorusGeodesics::shoot(double direction, double length) const {
    const double constant = clairaut(direction);
    const int count = 1 + static_cast<int>(kExactSteps * std::abs(length) / minorRadius_);
    State state = start(direction);
    for (int i = 0; i < count; ++i) state = step(state, constant, length / count);
    return state;
}

TorusGeodesics::Ray TorusGeodesics::trace(double direction) const {
    Ray ray{direction, {start(direction)}};
    const double constant = clairaut(direction);
    int beyond = 0;  // a few steps more: starting values for queries next to the end
    while (beyond < 3) {
        ray.states.push_back(step(ray.states.back(), constant, step_));
        const double length = static_cast<double>(ray.states.size() - 1) * step_;
        if (isPastCut(ray.states.back(), length)) ++beyond;
    }
    return ray;
}

/// Whether a geodesic of this length surely is no shortest one: it has passed its conjugate point
/// or the meridian opposite to the seed (a plane of symmetry), or a simple path is shorter.
bool TorusGeodesics::isPastCut(const State& s, double length) const {
    const double turn = std::abs(s.u - seed_.u);
    if (s.j <= 0 || turn > M_PI || length > maxLength_) return true;
    double shortest = kInfinity;  // along a meridian, the circle v = level, and a meridian
    for (const double level : {seed_.v, s.v, M_PI}) {
        const double climb = std::abs(wrap(level - seed_.v)) + std::abs(wrap(s.v - level));
        shortest = std::min(shortest, minorRadius_ * climb + axisDistance(level) * turn);
    }
    return length > shortest * (1 + 1e-9);
}

/// Appends `first` and rays up to, without, `lastDirection`, neighbors at most two steps apart.
void TorusGeodesics::traceBetween(const Ray& first, double lastDirection, int depth) {
    double spread = 0;
    for (const State& state : first.states) spread = std::max(spread, std::abs(state.j));
    const Ray last = trace(lastDirection);
    for (const State& state : last.states) spread = std::max(spread, std::abs(state.j));
    if (spread * (lastDirection - first.direction) <= 2 * step_ || depth == kMaxDepth) {
        fan_.push_back(first);
        return;
    }
    const double middle = 0.5 * (first.direction + lastDirection);
    traceBetween(first, middle, depth + 1);
    traceBetween(trace(middle), lastDirection, depth + 1);
}

/// Length of the straight line in the plane of (d u, minorRadius v), good for near points.
double TorusGeodesics::gap(const State& s, const Angles& target) const {
    return std::hypot(axisDistance(target.v) * wrap(target.u - s.u),
                      minorRadius_ * wrap(target.v - s.v));
}

/// Whether no neighbor in the fan, along the ray or on the next rays, is nearer to the query.
bool TorusGeodesics::isNearest(std::size_t ray, std::size_t at,
                               const std::vector<double>& gaps) const {
    const double here = gaps[firstGap_[ray] + at];
    for (const std::size_t side : {fan_.size() - 1, std::size_t{0}, std::size_t{1}}) {
        const std::size_t other = (ray + side) % fan_.size();
        const std::size_t end = std::min(at + 2, fan_[other].states.size());
        for (std::size_t k = at - 1; k < end; ++k)
            if (gaps[firstGap_[other] + k] < here) return false;
    }
    return true;
}

/// Length of the geodesic through the target near the given one; infinity if there is none.
double TorusGeodesics::refine(double direction, double length, const Angles& target) const {
    const double tolerance = 1e-12 * majorRadius_;
    double miss = kInfinity;
    for (int round = 0; round < 40; ++round) {
        const State end = shoot(direction, length);
        const double d = axisDistance(end.v);
        const double eastward = d * wrap(target.u - end.u);
        const double upward = minorRadius_ * wrap(target.v - end.v);
        // unit tangent (east, up) of the geodesic at its end; it misses by `ahead` and `aside`
        const double east = clairaut(direction) / d, up = minorRadius_ * end.dv;
        const double ahead = eastward * east + upward * up;
        const double aside = upward * east - eastward * up;
        miss = std::hypot(ahead, aside);
        if (miss < tolerance) return length + ahead;
        // Steps stay below the fan's spacing, so that a small j cannot throw the search away.
        const double limit = 2 * step_;
        const double turn = std::abs(end.j) > 1e-14 ? aside / end.j : 0.0;
        const double maxTurn = limit / std::max(std::abs(end.j), 0.1 * minorRadius_);
        direction += std::clamp(turn, -maxTurn, maxTurn);
        length += std::clamp(ahead, -limit, limit);
        if (length <= 0 || length > maxLength_ + 4 * step_) return kInfinity;
    }
    // At a conjugate point Newton's method converges slowly; the length is stationary there.
    return miss < 1e-7 * majorRadius_ ? length : kInfinity;
}

openvdb::Vec3d walkOnTorus(const openvdb::Vec3d& center, double majorRadius, double minorRadius,
                           const openvdb::Vec3d& p, const openvdb::Vec3d& direction,
                           double length) {
    using State = openvdb::Vec4d;  // u, v, u', v'
    const openvdb::Vec3d q = p - center;
    const double u = std::atan2(q.y(), q.x());
    const double v = std::atan2(q.z(), std::hypot(q.x(), q.y()) - majorRadius);
    const openvdb::Vec3d east(-std::sin(u), std::cos(u), 0);
    const openvdb::Vec3d up(-std::sin(v) * std::cos(u), -std::sin(v) * std::sin(u), std::cos(v));
    const double speed = std::hypot(direction.dot(east), direction.dot(up));
    State s(u, v, direction.dot(east) / (speed * (majorRadius + minorRadius * std::cos(v))),
            direction.dot(up) / (speed * minorRadius));
    const auto change = [&](const State& at) {
        const double d = majorRadius + minorRadius * std::cos(at[1]), sine = std::sin(at[1]);
        return State(at[2], at[3], 2 * minorRadius * sine / d * at[2] * at[3],
                     -d * sine / minorRadius * at[2] * at[2]);
    };
    const int count = 1 + int(kExactSteps * length / minorRadius);
    const double h = length / count;
    for (int i = 0; i < count; ++i) {
        const State k1 = change(s), k2 = change(s + h / 2 * k1), k3 = change(s + h / 2 * k2),
                    k4 = change(s + h * k3);
        s += h / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
    }
    const double d = majorRadius + minorRadius * std::cos(s[1]);
    return center +
           openvdb::Vec3d(d * std::cos(s[0]), d * std::sin(s[0]), minorRadius * std::sin(s[1]));
}

}  // namespace igeo::test
