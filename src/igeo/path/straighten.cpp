#include <igeo/path/straighten.h>

#include <igeo/path/detail/curve_on_triangles.h>

#include <algorithm>
#include <array>

namespace igeo {

namespace {

using Curve = std::vector<Vec3d>;

/// A curve on S, relaxed to a shorter one.
class Relaxation {
public:
    /// @param whole  it may move far: if a shift exceeds a voxel all shifts are scaled, because
    ///               clamping each would leave kinks
    Relaxation(const Band& band, const Metric& metric, const Path& path, bool whole);

    /// One round of shifts. @return false where it finds no shorter curve
    bool shorten();
    const Curve& curve() const { return c_; }
    double cost() const { return cost_; }

private:
    double costOf(const Curve& c) const;
    bool blocked(const Vec3d& a, const Vec3d& b) const {
        return metric_.obstacles && metric_.blocked(a, b, surfaceNormal(band_, a));
    }
    /// The curve resampled at equal arc length and projected to S.
    Curve resampled(const Curve& c) const;
    /// Removes vertices closer than half a voxel where no obstacle separates their neighbors, and
    /// splits longer segments. Chords of a resampled curve would cut the corners of obstacles.
    Curve respaced(const Curve& c) const;
    /// How the cost of segment e changes when its vertex `end` moves along across_.
    ///
    /// A metric gives a norm C(step) at every point. Its derivatives follow by polarization: with A
    /// = C(s)^2, E = C(e)^2, B = (C(e + s)^2 - C(e - s)^2) / 4 the length C(e) has the derivatives
    /// B / sqrt(E) and (A - B^2 / E) / sqrt(E) along s.
    struct Variation {
        double slope, bend;  ///< first and second derivative, at a constant metric
        double drift;        ///< first derivative from the change of the metric
    };
    Variation variation(std::size_t end, const Vec3d& e) const;
    /// Newton's equations for the shifts: tridiagonal, -beside | diagonal | -beside = pull.
    struct NewtonSystem {
        std::vector<double> diagonal, beside, pull;
    };
    /// Sets across_.
    NewtonSystem newtonSystem();
    /// Newton's shifts along across_; 0 at the ends and where an obstacle stops a vertex.
    std::vector<double> shifts();
    /// The curve with every vertex shifted.
    /// @return whether it is clear of obstacles; if not, stopped_ marks the vertices that are
    ///         blocked
    bool shifted(const std::vector<double>& shift, double share, Curve& c);
    /// Moves vertices one by one while that makes the curve shorter: all, or those that an obstacle
    /// stopped.
    void moveSingly(bool all);

    const Band& band_;
    const Metric& metric_;
    const bool whole_;
    std::size_t segments_ = 0;
    Curve c_;
    double cost_ = 0;
    std::vector<Vec3d> across_;    ///< unit, along S and across the curve
    std::vector<double> stopped_;  ///< per vertex: the shift that an obstacle blocked, or 0
};

Relaxation::Relaxation(const Band& band, const Metric& metric, const Path& path, bool whole)
    : band_(band),
      metric_(metric),
      whole_(whole),
      segments_(std::size_t(std::max(2.0, std::ceil(2 * path.length)))) {
    for (const PathVertex& v : path.vertices) c_.push_back(v.pIndex);
    c_ = metric_.obstacles ? respaced(c_) : resampled(c_);
    cost_ = costOf(c_);
    stopped_.assign(c_.size(), 0);
}

double Relaxation::costOf(const Curve& c) const {
    double sum = 0;
    for (std::size_t k = 1; k < c.size(); ++k)
        sum += metric_.weighted()
                   ? segmentCost(band_, metric_, c[k - 1], c[k], surfaceNormal(band_, c[k]))
                   : length(c[k] - c[k - 1]);
    return sum;
}

Curve Relaxation::resampled(const Curve& c) const {
    Curve out{c.front()};
    double total = 0;
    for (std::size_t k = 1; k < c.size(); ++k) total += length(c[k] - c[k - 1]);
    const double step = total / double(segments_);
    double start = 0;  // arc length at c[k - 1]
    std::size_t k = 1;
    for (std::size_t i = 1; i < segments_; ++i) {
        const double at = step * double(i);
        double segment = length(c[k] - c[k - 1]);
        while (start + segment < at && k + 1 < c.size()) {
            start += segment;
            ++k;
            segment = length(c[k] - c[k - 1]);
        }
        const double t = segment > 0 ? std::clamp((at - start) / segment, 0.0, 1.0) : 0.0;
        Vec3d p = c[k - 1] + t * (c[k] - c[k - 1]);
        projectToSurface(band_, p);
        out.push_back(p);
    }
    out.push_back(c.back());
    return out;
}

Curve Relaxation::respaced(const Curve& c) const {
    constexpr double kStep = 0.5;
    Curve few{c.front()};
    for (std::size_t k = 1; k < c.size(); ++k) {
        const bool last = k + 1 == c.size();
        if (!last && length(c[k + 1] - few.back()) < 2 * kStep && !blocked(few.back(), c[k + 1]))
            continue;
        few.push_back(c[k]);
    }
    Curve out{c.front()};
    for (std::size_t k = 1; k < few.size(); ++k) {
        const Vec3d &from = few[k - 1], &to = few[k];
        const int segments = int(std::ceil(length(to - from) / kStep));
        for (int segment = 1; segment < segments; ++segment) {
            Vec3d p = from + (double(segment) / segments) * (to - from);
            if (projectToSurface(band_, p) && !blocked(out.back(), p) && !blocked(p, to))
                out.push_back(p);
        }
        out.push_back(to);
    }
    return out;
}

Relaxation::Variation Relaxation::variation(std::size_t end, const Vec3d& e) const {
    // Half a voxel, as the metric is linear between voxels.
    constexpr double kProbe = 0.5;
    const Vec3d& s = across_[end];
    if (!metric_.weighted()) {
        const double e2 = dot(e, e), es = dot(e, s);
        return {es / std::sqrt(e2), (1 - es * es / e2) / std::sqrt(e2), 0};
    }
    const Vec3d normal = surfaceNormal(band_, c_[end]);
    const SurfaceCell here(band_, metric_, c_[end], normal);
    auto squared = [&](const Vec3d& v) {
        const double c = metric_.stepCost(here, v);
        return c * c;
    };
    const double a = squared(s), ee = squared(e), b = (squared(e + s) - squared(e - s)) / 4;
    auto costAt = [&](double t) {
        return metric_.stepCost(SurfaceCell(band_, metric_, c_[end] + t * s, normal), e);
    };
    return {b / std::sqrt(ee), (a - b * b / ee) / std::sqrt(ee),
            (costAt(kProbe) - costAt(-kProbe)) / (2 * kProbe) / 2};
}

Relaxation::NewtonSystem Relaxation::newtonSystem() {
    const std::size_t n = c_.size();
    NewtonSystem system{std::vector<double>(n, 0.0), std::vector<double>(n, 0.0),
                        std::vector<double>(n, 0.0)};
    across_.assign(n, {});
    for (std::size_t k = 1; k + 1 < n; ++k)
        across_[k] = normalized(cross(surfaceNormal(band_, c_[k]), c_[k + 1] - c_[k - 1]));
    for (std::size_t k = 0; k + 1 < n; ++k) {
        const Vec3d e = c_[k + 1] - c_[k];
        if (!(dot(e, e) > 0)) continue;
        std::array<double, 2> bend{};
        for (const std::size_t end : {k, k + 1}) {
            if (across_[end] == Vec3d{}) continue;
            const double sign = end == k ? -1 : 1;
            const Variation v = variation(end, e);
            system.pull[end] -= sign * v.slope + v.drift;
            system.diagonal[end] += v.bend;
            bend[end - k] = v.bend;
        }
        // At corners the two differ, and only the geometric mean keeps the system definite.
        system.beside[k] =
            whole_ ? std::sqrt(std::max(bend[0] * bend[1], 0.0)) : (bend[0] + bend[1]) / 2;
    }
    return system;
}

std::vector<double> Relaxation::shifts() {
    const std::size_t n = c_.size();
    std::vector<double> shift(n, 0.0);
    auto [diagonal, beside, pull] = newtonSystem();
    // The Thomas algorithm; a fixed vertex keeps shift 0.
    for (std::size_t k = 1; k + 1 < n; ++k) {
        // Also fixed: a vertex pulled against the obstacle that stopped it.
        if (!(diagonal[k] > 0) || across_[k] == Vec3d{} || stopped_[k] * pull[k] > 0) {
            diagonal[k] = 1, pull[k] = 0, beside[k] = 0;
            if (k > 0) beside[k - 1] = 0;
            continue;
        }
        stopped_[k] = 0;
        if (k == 1 || !(beside[k - 1] > 0)) continue;
        const double m = beside[k - 1] / diagonal[k - 1];
        diagonal[k] -= m * beside[k - 1];
        pull[k] += m * pull[k - 1];
    }
    for (std::size_t k = n - 2; k > 0; --k)
        shift[k] = (pull[k] + beside[k] * shift[k + 1]) / diagonal[k];
    if (!whole_) return shift;
    double most = 1;
    for (const double s : shift) most = std::max(most, std::abs(s));
    for (double& s : shift) s /= most;
    return shift;
}

bool Relaxation::shifted(const std::vector<double>& shift, double share, Curve& c) {
    c = c_;
    bool free = true;
    for (std::size_t k = 1; k < c.size(); ++k) {
        if (shift[k] != 0) {
            // At most a voxel at a time: the linearization is valid no further.
            Vec3d p = c_[k] + share * std::clamp(shift[k], -1.0, 1.0) * across_[k];
            if (projectToSurface(band_, p)) c[k] = p;
        }
        if ((shift[k - 1] == 0 && shift[k] == 0) || !blocked(c[k - 1], c[k])) continue;
        for (const std::size_t end : {k - 1, k})
            if (shift[end] != 0) stopped_[end] = shift[end];
        free = false;
    }
    return free;
}

void Relaxation::moveSingly(bool all) {
    for (std::size_t k = 1; k + 1 < c_.size(); ++k) {
        if (!all && stopped_[k] == 0) continue;
        // To the chord of its neighbors, or as close to it as obstacles allow.
        const Vec3d &a = c_[k - 1], &b = c_[k + 1];
        const double whole = dot(a + 0.5 * (b - a) - c_[k], across_[k]);
        const double before = costOf({a, c_[k], b});
        for (double s = std::clamp(whole, -1.0, 1.0); std::abs(s) > 0.01; s /= 2) {
            Vec3d p = c_[k] + s * across_[k];
            if (!projectToSurface(band_, p) || blocked(a, p) || blocked(p, b) ||
                !(costOf({a, p, b}) < before))
                continue;
            c_[k] = p;
            break;
        }
    }
    cost_ = costOf(c_);
}

bool Relaxation::shorten() {
    constexpr int kTries = 20;
    const double before = cost_;
    // Newton's full step, or a part of it where the metric changes within it; without the vertices
    // that obstacles stop, which are found one after another.
    double share = 1;
    for (int tries = 0; tries < kTries && share > 0.1; ++tries) {
        Curve c;
        if (!shifted(shifts(), share, c)) continue;
        if (!metric_.obstacles) c = resampled(c);
        if (const double cost = costOf(c); cost < cost_) {
            c_ = std::move(c);
            cost_ = cost;
            break;
        }
        share /= 2;
    }
    // At a sharp corner of the curve Newton's equation finds no shift.
    if (metric_.obstacles) moveSingly(/*all=*/cost_ == before);
    return cost_ < before;
}

/// How far a curve may move.
enum class Reach { Near, Whole };

Curve relaxed(const Field& field, const Path& path, Reach reach, Progress& progress) {
    constexpr int kRounds = 100, kManyRounds = 4000;
    constexpr double kSettled = 1e-7;
    const bool whole = reach == Reach::Whole;
    Relaxation curve(*field.band, *field.metric, path, whole);
    for (int round = 0; round < (whole ? kManyRounds : kRounds); ++round) {
        progress.throwIfCancelled();
        const double before = curve.cost();
        if (!curve.shorten() || before - curve.cost() < kSettled * before) break;
    }
    return curve.curve();
}

/// A path made shorter with its ends fixed, and measured.
/// @param lengths  per vertex: the weighted length up to it
Path shortened(const Field& field, const Path& path, Reach reach, Progress& progress,
               std::vector<double>& lengths) {
    const SurfaceTriangles* const triangles = field.band->triangles.get();
    const bool exact = hasExactCurves(field);
    Path shorter = path;
    shorter.vertices.clear();
    for (const Vec3d& p :
         exact ? shortestOnTriangles(*triangles, path, progress, reach == Reach::Whole)
               : relaxed(field, path, reach, progress))
        shorter.vertices.push_back({p, 0, 0});
    if (triangles && !exact) layOnTriangles(field, shorter);
    lengths = measure(field, shorter);
    return shorter;
}

/// Removes the vertices at which a path turns by more than a right angle: where it comes back along
/// itself Newton's equation has no sideways direction.
void cutNeedles(Path& path) {
    constexpr double kRightAngle = 0.7;  // chord over both sides
    std::vector<PathVertex> kept;
    for (const PathVertex& v : path.vertices) {
        while (kept.size() > 1) {
            const Vec3d &a = kept[kept.size() - 2].pIndex, &b = kept.back().pIndex;
            if (length(v.pIndex - a) >= kRightAngle * (length(b - a) + length(v.pIndex - b))) break;
            kept.pop_back();
        }
        kept.push_back(v);
    }
    path.vertices = std::move(kept);
}

/// Rotates a closed path so that it starts at its middle.
void turnToMiddle(Path& path) {
    auto& v = path.vertices;
    v.pop_back();
    std::rotate(v.begin(), v.begin() + std::ptrdiff_t(v.size() / 2), v.end());
    v.push_back(v.front());
}

}  // namespace

bool straightenWhole(const Field& field, Path& path, bool closed, Progress& progress) {
    constexpr int kMostTurns = 400;
    constexpr double kPoint = 2;  // voxels
    const double kSettled = field.band->triangles ? 1e-12 : 1e-7;
    std::vector<double> lengths;
    double before = kInfinity;
    for (int turn = 0, settled = 0; turn < kMostTurns && settled < 2; ++turn) {
        if (!field.band->triangles && !field.metric->obstacles) cutNeedles(path);
        path = shortened(field, path, Reach::Whole, progress, lengths);
        if (closed && path.length < kPoint) return false;
        // A closed curve starts at two places in turn, and must settle at both.
        settled = before - path.weightedLength < kSettled * before ? settled + 1 : 0;
        before = path.weightedLength;
        if (!closed) break;
        turnToMiddle(path);
    }
    if (closed) lengths = measure(field, path);
    path.distance = 0;
    for (std::size_t k = 0; k < lengths.size(); ++k) path.vertices[k].distance = lengths[k];
    return true;
}

Path straightened(const Field& field, const Path& path, Progress& progress) {
    std::vector<double> lengths;
    return shortened(field, path, Reach::Near, progress, lengths);
}

void straighten(const Field& field, Path& path, Progress& progress) {
    if (path.status != PathStatus::Reached) return;
    std::vector<double> lengths;
    Path shorter = path;
    if (path.vertices.size() > 2) shorter = shortened(field, path, Reach::Near, progress, lengths);
    if (shorter.weightedLength < path.weightedLength)
        path = std::move(shorter);
    else
        lengths = measure(field, path);
    const double start = field.seeds[path.seed].start;
    for (std::size_t k = 0; k < lengths.size(); ++k)
        path.vertices[k].distance = start + (path.weightedLength - lengths[k]);
}

}  // namespace igeo
