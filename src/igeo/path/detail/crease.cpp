#include <igeo/path/detail/crease.h>

#include <algorithm>
#include <array>
#include <numbers>
#include <optional>

namespace igeo {

namespace {

constexpr double kCreaseStep = 0.5;

/// A sheet at one side of a crease, extended beyond it.
class SheetFit {
public:
    /// @param center  near the crease
    /// @param n       normal of the sheet
    /// @param side    of S on which psi has the kink: -1 inside, 1 outside
    SheetFit(const Band& band, const Vec3d& center, const Vec3d& n, int side);

    bool valid() const { return valid_; }
    Vec3d normal(const Vec3d& q) const {
        // Along the sheet the normal of spheres and cylinders is linear; across it, it is not.
        const Vec3d r = q - center_, up = cross(along_[0], along_[1]),
                    linear =
                        constant_ + dot(r, along_[0]) * slope_[0] + dot(r, along_[1]) * slope_[1],
                    along = linear - dot(linear, up) * up;
        return normalized(along + std::sqrt(std::max(1 - dot(along, along), 0.0)) * up);
    }
    /// The height of q above the sheet.
    double height(const Vec3d& q) const {
        const Vec3d n = normal(q);
        double sum = 0;
        for (const Vec3d& foot : feet_) sum += dot(q - foot, 0.5 * (normal(foot) + n));
        return sum / double(feet_.size());
    }
    Local operator()(const Vec3d& q, const Vec3d&) const { return {true, height(q), normal(q)}; }

private:
    /// Keeps the nodes of a plane, if most lie on one: those beside the crease tilt it.
    void keepPlane();
    void fit();
    bool dropOutliers();

    Vec3d center_;
    std::array<Vec3d, 2> along_;
    std::vector<Vec3d> feet_, normals_;
    Vec3d constant_;
    std::array<Vec3d, 2> slope_;
    bool valid_ = false;
};

SheetFit::SheetFit(const Band& band, const Vec3d& center, const Vec3d& n, int side)
    : center_(center) {
    constexpr int kReach = 6;
    constexpr double kRadius = 6, kAlike = 0.9, kNear = 1.3, kSlope = 0.3, kRise = 0.7;
    constexpr std::size_t kFew = 8;
    along_[0] = anyNormalTo(n);
    along_[1] = cross(n, along_[0]);
    const Ijk middle = roundToIjk(center);
    // Another sheet may have the same normal.
    auto isOnSheet = [&](const Vec3d& r) {
        const double far = length(r);
        return far <= kRadius && std::abs(dot(r, n)) <= kSlope * far + kRise;
    };
    for (int x = -kReach; x <= kReach; ++x)
        for (int y = -kReach; y <= kReach; ++y)
            for (int z = -kReach; z <= kReach; ++z) {
                const NodeIndex i = band.nodeAt(middle + Ijk{x, y, z});
                if (i == kNoNode || band.psi[i] * float(side) < 0 ||
                    std::abs(band.psi[i]) > kNear || dot(Vec3d(band.normal[i]), n) < kAlike ||
                    !isOnSheet(band.footPoint(i) - center))
                    continue;
                feet_.push_back(band.footPoint(i));
                normals_.push_back(Vec3d(band.normal[i]));
            }
    if (feet_.size() < kFew) return;
    keepPlane();
    fit();
    while (dropOutliers()) {
        if (feet_.size() < kFew) return;
        fit();
    }
    valid_ = true;
}

void SheetFit::keepPlane() {
    constexpr double kSame = 0.002, kOff = 0.01;  // of normals; voxels
    std::vector<std::size_t> most;
    for (std::size_t k = 0; k < feet_.size(); ++k) {
        std::vector<std::size_t> alike;
        for (std::size_t i = 0; i < feet_.size(); ++i)
            if (length(normals_[i] - normals_[k]) < kSame &&
                std::abs(dot(feet_[i] - feet_[k], normals_[k])) < kOff)
                alike.push_back(i);
        if (alike.size() > most.size()) most = std::move(alike);
    }
    if (2 * most.size() <= feet_.size()) return;
    std::vector<Vec3d> feet, normals;
    for (const std::size_t i : most) feet.push_back(feet_[i]), normals.push_back(normals_[i]);
    feet_ = std::move(feet), normals_ = std::move(normals);
}

/// Least squares, component by component.
void SheetFit::fit() {
    std::array<double, 6> m{};  // of 1, u, v: 11 1u 1v uu uv vv
    std::array<Vec3d, 3> right{};
    for (std::size_t k = 0; k < feet_.size(); ++k) {
        const double u = dot(feet_[k] - center_, along_[0]), v = dot(feet_[k] - center_, along_[1]);
        const std::array<double, 6> more{1, u, v, u * u, u * v, v * v};
        for (std::size_t i = 0; i < 6; ++i) m[i] += more[i];
        right[0] += normals_[k], right[1] += u * normals_[k], right[2] += v * normals_[k];
    }
    // Subtracting the means leaves two equations.
    const double count = m[0], u = m[1] / count, v = m[2] / count;
    const double uu = m[3] - count * u * u, uv = m[4] - count * u * v, vv = m[5] - count * v * v;
    const Vec3d mean = (1 / count) * right[0], a = right[1] - (count * u) * mean,
                b = right[2] - (count * v) * mean;
    const double volume = uu * vv - uv * uv;
    // Foot points on one line do not determine the slope across it.
    slope_ = {};
    if (volume > 0.01 * count * count)
        slope_ = {(1 / volume) * (vv * a - uv * b), (1 / volume) * (uu * b - uv * a)};
    constant_ = mean - u * slope_[0] - v * slope_[1];
}

/// Removes the node with the largest error of the normal, if that is too large: by itself, or
/// beside the errors of most.
bool SheetFit::dropOutliers() {
    constexpr double kOff = 0.05, kTimes = 3, kLeast = 0.002;
    std::vector<double> off;
    for (std::size_t k = 0; k < feet_.size(); ++k)
        off.push_back(length(normals_[k] - normal(feet_[k])));
    std::vector<double> sorted = off;
    const auto middle = sorted.begin() + std::ptrdiff_t(sorted.size() / 2);
    std::nth_element(sorted.begin(), middle, sorted.end());
    double most = std::clamp(kTimes * *middle, kLeast, kOff);
    std::size_t worst = feet_.size();
    for (std::size_t k = 0; k < feet_.size(); ++k)
        if (off[k] > most) most = off[k], worst = k;
    if (worst == feet_.size()) return false;
    feet_.erase(feet_.begin() + std::ptrdiff_t(worst));
    normals_.erase(normals_.begin() + std::ptrdiff_t(worst));
    return true;
}

/// Turns the direction over the line where two sheets meet, at the same angle to it.
void turnOver(const Vec3d& from, const Vec3d& to, int side, Walker& w) {
    const Vec3d edge = normalized(cross(from, to));
    Vec3d away = cross(to, edge);
    if (dot(away, from) * side < 0) away = -away;
    const double along = dot(w.v, edge);
    w.v = along * edge + std::sqrt(std::max(1 - along * along, 0.0)) * away;
    w.n = to;
}

/// The walk from a point before a crease to about a point after it, across the line where the
/// sheets meet.
/// @param end  of the walk as voxels round the crease off, or its last point so far
/// @param length  at which it ends
/// @return nothing where there is no crease, or another sheet comes first
std::optional<std::vector<Walker>> over(const Band& band, const Walker& before, const Vec3d& middle,
                                        const Walker& after, const Walker& end, double length) {
    constexpr double kBeyond = 2.5, kOff = 2.5, kFarthest = 10, kApart = 0.4;
    const int side = dot(after.n, before.v) > 0 ? -1 : 1;
    const SheetFit a(band, middle, before.n, side), b(band, middle, after.n, side);
    if (!a.valid() || !b.valid()) return std::nullopt;
    const double start = b.height(before.p);
    auto isOver = [&](const Walker& w) { return (b.height(w.p) < 0) != (start < 0); };
    std::vector<Walker> walk{before};
    Walker next = before;
    double high = 0;
    while (true) {
        high = std::min(kCreaseStep, length - walk.back().at);
        if (!(high > 0)) {
            // A walk that ends before the crease is there still on S.
            if (igeo::length(walk.back().p - end.p) > kApart) return std::nullopt;
            return walk;
        }
        if (!(next = walk.back()).step(a, high)) return std::nullopt;
        if (isOver(next)) break;
        if (next.at - before.at > kFarthest) return std::nullopt;
        walk.push_back(next);
    }
    double low = 0;
    for (int round = 0; round < 40; ++round) {
        const double half = (low + high) / 2;
        (next = walk.back()).step(a, half);
        (isOver(next) ? high : low) = half;
    }
    (next = walk.back()).step(a, high);
    if (igeo::length(next.p - middle) > kOff) return std::nullopt;
    turnOver(a.normal(next.p), b.normal(next.p), side, next);
    walk.push_back(next);
    for (const double last = std::min(next.at + kBeyond, length); next.at < last;) {
        if (!next.step(b, std::min(kCreaseStep, last - next.at))) return std::nullopt;
        walk.push_back(next);
    }
    return walk;
}

double degrees(const Vec3d& a, const Vec3d& b) {
    return std::atan2(length(cross(a, b)), dot(a, b)) * 180 / std::numbers::pi;
}

}  // namespace

bool CreaseWatch::unfold(std::vector<Walker>& track) {
    constexpr std::size_t kWindow = 6, kClean = 4, kMost = 24;  // steps
    constexpr double kBend = 35, kSettled = 8, kLeast = 25, kMostBend = 150;
    constexpr double kSharp = 0.8;  // of the bend, within the window; rounded edges have less
    const std::size_t last = track.size() - 1;
    if (bend_ == 0) {
        const std::size_t before = std::max(first_ + kWindow, last) - kWindow;
        if (degrees(track[before].n, track[last].n) < kBend) return false;
        bend_ = last;
    }
    // A walk that ends here is continued for a while, to show the other sheet.
    std::vector<Walker> more(track.begin() + std::ptrdiff_t(first_), track.end());
    auto settled = [&] {
        return more.size() > bend_ - first_ + kClean &&
               degrees(more[more.size() - 1 - kClean].n, more.back().n) < kSettled;
    };
    const auto surface = [&](const Vec3d& p, const Vec3d& n) { return localSurface(band_, p, n); };
    while (track.back().at >= length_ && !settled() && more.size() <= bend_ - first_ + kMost) {
        Walker next = more.back();
        if (!next.step(surface, kCreaseStep)) break;
        more.push_back(next);
    }
    if (!settled()) {
        if (last > bend_ + kMost) first_ = last, bend_ = 0;
        return false;
    }
    const Walker after = more.back();
    std::size_t middle = 0;
    while (middle + 1 < more.size() &&
           dot(more[middle].n, more[0].n) > dot(more[middle].n, after.n))
        ++middle;
    const std::size_t from = std::max(middle, kWindow) - kWindow;
    const double bend = degrees(more[from].n, after.n);
    std::optional<std::vector<Walker>> walk;
    if (bend > kLeast && bend < kMostBend)
        walk = over(band_, more[from], more[middle].p, after, track.back(), length_);
    bend_ = 0;
    if (!walk) {
        const std::size_t beyond = std::min(middle + kWindow, more.size() - 1);
        if (degrees(more[from].n, more[beyond].n) > kSharp * bend && bend > kLeast) {
            ++missed_;
            seen_.push_back(more[middle].at);
        }
        first_ = last;
        return false;
    }
    seen_.push_back(more[middle].at);
    track.resize(first_ + from);
    track.insert(track.end(), walk->begin(), walk->end());
    first_ = track.size() - 1 - std::min(kClean, walk->size() - 1);
    return true;
}

std::size_t CreaseWatch::roundedBends(const std::vector<Walker>& track) const {
    // Steps to each side: a sharp bend turns as much within two voxels as within eight.
    constexpr std::size_t kNarrow = 2, kWide = 8;
    constexpr double kLeast = 10, kSpread = 1.25, kNear = 5;
    std::size_t count = missed_;
    for (std::size_t k = kNarrow; k + kNarrow < track.size(); ++k) {
        const double turn = degrees(track[k - kNarrow].n, track[k + kNarrow].n);
        if (turn < kLeast) continue;
        const std::size_t before = std::max(k, kWide) - kWide,
                          after = std::min(k + kWide, track.size() - 1);
        const bool seen = std::any_of(seen_.begin(), seen_.end(), [&](double at) {
            return std::abs(at - track[k].at) < kNear;
        });
        if (seen || degrees(track[before].n, track[after].n) > kSpread * turn) continue;
        ++count;
        k += kWide;
    }
    return count;
}

}  // namespace igeo
