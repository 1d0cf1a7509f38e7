#include <igeo/path/straighten.h>

#include <algorithm>

namespace igeo {

namespace {

using Curve = std::vector<Vec3d>;

Vec3d normalAt(const Band& band, const Vec3d& p) {
    const PsiSample psi = samplePsi(band, p);
    return psi.valid ? normalized(psi.gradient) : Vec3d{};
}

/// A curve on S that gets shorter.
class Relaxation {
public:
    Relaxation(const Band& band, const Metric& metric, const Path& path);

    /// One round of shifts. @return false where it finds no shorter curve
    bool shorten();
    const Curve& curve() const { return c_; }
    double cost() const { return cost_; }

private:
    double costOf(const Curve& c) const;
    bool blocked(const Vec3d& a, const Vec3d& b) const {
        return metric_.obstacles && metric_.blocked(a, b, normalAt(band_, a));
    }
    /// The curve at equal steps of its arc length, back on S.
    Curve resampled(const Curve& c) const;
    /// Without vertices closer than half a voxel where nothing is in the way, and with more on
    /// longer segments: chords of a resampled curve would cut the corners of obstacles.
    Curve respaced(const Curve& c) const;
    /// Newton's shifts along side_; 0 at the ends and where an obstacle holds a vertex.
    std::vector<double> shifts();
    /// The curve with every vertex shifted.
    /// @return whether it is clear of obstacles; if not, the vertices that are not are stopped_
    bool shifted(const std::vector<double>& shift, double share, Curve& c);
    /// Moves vertices one by one as long as that makes the curve shorter: those that an obstacle
    /// stopped, or all.
    void moveSingly(bool all);

    const Band& band_;
    const Metric& metric_;
    std::size_t pieces_ = 0;
    Curve c_;
    double cost_ = 0;
    std::vector<Vec3d> side_;      ///< unit, along S and across the curve
    std::vector<double> stopped_;  ///< per vertex: the shift an obstacle did not allow, or 0
};

Relaxation::Relaxation(const Band& band, const Metric& metric, const Path& path)
    : band_(band),
      metric_(metric),
      pieces_(std::size_t(std::max(2.0, std::ceil(2 * path.length)))) {
    for (const PathVertex& v : path.vertices) c_.push_back(v.pIndex);
    c_ = metric_.obstacles ? respaced(c_) : resampled(c_);
    cost_ = costOf(c_);
    stopped_.assign(c_.size(), 0);
}

double Relaxation::costOf(const Curve& c) const {
    double sum = 0;
    for (std::size_t k = 1; k < c.size(); ++k)
        sum += metric_.weighted() ? wayCost(band_, metric_, c[k - 1], c[k], normalAt(band_, c[k]))
                                  : length(c[k] - c[k - 1]);
    return sum;
}

Curve Relaxation::resampled(const Curve& c) const {
    Curve out{c.front()};
    double total = 0;
    for (std::size_t k = 1; k < c.size(); ++k) total += length(c[k] - c[k - 1]);
    const double step = total / double(pieces_);
    double start = 0;  // arc length at c[k - 1]
    std::size_t k = 1;
    for (std::size_t i = 1; i < pieces_; ++i) {
        const double at = step * double(i);
        double piece = length(c[k] - c[k - 1]);
        while (start + piece < at && k + 1 < c.size()) {
            start += piece;
            ++k;
            piece = length(c[k] - c[k - 1]);
        }
        const double t = piece > 0 ? std::clamp((at - start) / piece, 0.0, 1.0) : 0.0;
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
        const int pieces = int(std::ceil(length(to - from) / kStep));
        for (int piece = 1; piece < pieces; ++piece) {
            Vec3d p = from + (double(piece) / pieces) * (to - from);
            if (projectToSurface(band_, p) && !blocked(out.back(), p) && !blocked(p, to))
                out.push_back(p);
        }
        out.push_back(to);
    }
    return out;
}

std::vector<double> Relaxation::shifts() {
    // Half a voxel, as the metric is linear between voxels.
    constexpr double kProbe = 0.5;
    const std::size_t n = c_.size();
    std::vector<double> shift(n, 0.0), diagonal(n, 0.0), beside(n, 0.0), pull(n, 0.0);
    side_.assign(n, {});
    for (std::size_t k = 1; k + 1 < n; ++k)
        side_[k] = normalized(cross(normalAt(band_, c_[k]), c_[k + 1] - c_[k - 1]));
    // Length of segment k = (c[k], c[k + 1]) and its variations. A metric gives a norm C(step) at
    // every point; all that is needed of it follows by polarization: with A = C(s)^2, E = C(e)^2,
    // B = (C(e + s)^2 - C(e - s)^2) / 4 the length C(e) has the derivatives B / sqrt(E) and
    // (A - B^2 / E) / sqrt(E) along s.
    for (std::size_t k = 0; k + 1 < n; ++k) {
        const Vec3d e = c_[k + 1] - c_[k];
        const double e2 = dot(e, e);
        if (!(e2 > 0)) continue;
        for (const std::size_t end : {k, k + 1}) {
            const Vec3d& s = side_[end];
            if (s == Vec3d{}) continue;
            const double sign = end == k ? -1 : 1;
            double slope = dot(e, s) / std::sqrt(e2),
                   bend = (1 - dot(e, s) * dot(e, s) / e2) / std::sqrt(e2), drift = 0;
            if (metric_.weighted()) {
                const Vec3d normal = normalAt(band_, c_[end]);
                const SurfaceCell here(band_, metric_, c_[end], normal);
                auto squared = [&](const Vec3d& v) {
                    const double c = metric_.stepCost(here, v);
                    return c * c;
                };
                const double a = squared(s), ee = squared(e),
                             b = (squared(e + s) - squared(e - s)) / 4;
                slope = b / std::sqrt(ee);
                bend = (a - b * b / ee) / std::sqrt(ee);
                auto costAt = [&](double t) {
                    return metric_.stepCost(SurfaceCell(band_, metric_, c_[end] + t * s, normal),
                                            e);
                };
                drift = (costAt(kProbe) - costAt(-kProbe)) / (2 * kProbe) / 2;
            }
            pull[end] -= sign * slope + drift;
            diagonal[end] += bend;
            beside[k] += bend / 2;
        }
    }
    auto fixed = [&](std::size_t k) {
        // Held while it is still drawn where an obstacle does not let it.
        return !(diagonal[k] > 0) || side_[k] == Vec3d{} || stopped_[k] * pull[k] > 0;
    };
    // The Thomas algorithm; a fixed vertex keeps shift 0.
    for (std::size_t k = 1; k + 1 < n; ++k) {
        if (fixed(k)) {
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
    for (std::size_t k = n - 2; k > 0; --k) {
        shift[k] = (pull[k] + beside[k] * shift[k + 1]) / diagonal[k];
    }
    return shift;
}

bool Relaxation::shifted(const std::vector<double>& shift, double share, Curve& c) {
    c = c_;
    bool free = true;
    for (std::size_t k = 1; k < c.size(); ++k) {
        if (shift[k] != 0) {
            // A voxel at a time: the linear picture holds no further.
            Vec3d p = c_[k] + share * std::clamp(shift[k], -1.0, 1.0) * side_[k];
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
        // Onto the chord of its neighbors, or as near as there is room.
        const Vec3d &a = c_[k - 1], &b = c_[k + 1];
        const double whole = dot(a + 0.5 * (b - a) - c_[k], side_[k]);
        const double before = costOf({a, c_[k], b});
        for (double s = std::clamp(whole, -1.0, 1.0); std::abs(s) > 0.01; s /= 2) {
            Vec3d p = c_[k] + s * side_[k];
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
    // Newton's full step, or less where the metric changes within it; without the vertices that
    // obstacles stop, which are found on the way.
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
    // Where the curve has a sharp corner Newton's equation does not see the way.
    if (metric_.obstacles) moveSingly(/*all=*/cost_ == before);
    return cost_ < before;
}

}  // namespace

void straighten(const Band& band, const Field& field, Path& path) {
    if (path.status != PathStatus::Reached || path.vertices.size() < 3) return;
    constexpr int kRounds = 40;
    constexpr double kSettled = 1e-7;
    Relaxation curve(band, *field.metric, path);
    for (int round = 0; round < kRounds; ++round) {
        const double before = curve.cost();
        if (!curve.shorten() || before - curve.cost() < kSettled * before) break;
    }
    if (curve.cost() >= path.weightedLength) return;
    path.vertices.clear();
    path.weightedLength = path.length = 0;
    std::vector<double> lengths;
    for (std::size_t k = 0; k < curve.curve().size(); ++k) {
        const Vec3d& p = curve.curve()[k];
        if (k) {
            const Vec3d& last = curve.curve()[k - 1];
            path.length += length(p - last);
            path.weightedLength += wayCost(band, *field.metric, last, p, normalAt(band, p));
        }
        lengths.push_back(path.weightedLength);
        path.vertices.push_back({p, path.length, 0});
    }
    const double start = field.seeds[path.seed].start;
    for (std::size_t k = 0; k < lengths.size(); ++k)
        path.vertices[k].distance = start + (path.weightedLength - lengths[k]);
}

}  // namespace igeo
